#include "simd_sse42.hpp"
#include "trace_group.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelSse42 = make_kernel<Float8>("sse4.2");

}  // namespace raylab::bvh
