#include "simd_avx2.hpp"
#include "trace_group.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelAvx2 = make_kernel<Float8>("avx2");

}  // namespace raylab::bvh
