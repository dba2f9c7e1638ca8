#include "group.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelAvx2 = make_kernel("avx2");

}  // namespace raylab::bvh
