#include "group.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelSse42 = make_kernel("sse4.2");

}  // namespace raylab::bvh
