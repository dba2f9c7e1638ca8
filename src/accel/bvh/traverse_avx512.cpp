#include "simd_avx512.hpp"
#include "trace_group.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelAvx512 = make_kernel<Float8>("avx512");

}  // namespace raylab::bvh
