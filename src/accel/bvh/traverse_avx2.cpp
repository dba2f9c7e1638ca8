#include "simd_avx2.hpp"
#include "traverse_packet.hpp"

namespace raylab::bvh {

constinit const Kernel kKernelAvx2 = make_kernel<Float8>("avx2");

}  // namespace raylab::bvh
