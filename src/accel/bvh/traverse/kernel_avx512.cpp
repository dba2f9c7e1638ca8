#include "group.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelAvx512 = make_kernel("avx512");

}  // namespace raylab::bvh
