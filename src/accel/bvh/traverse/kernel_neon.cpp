#include "group.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelNeon = make_kernel("neon");

}  // namespace raylab::bvh
