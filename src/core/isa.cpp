#include "raylab/core/isa.hpp"

#include "raylab/core/error.hpp"

namespace raylab {

bool isa_supported(Isa isa) {
  switch (isa) {
    case Isa::sse42:
      return __builtin_cpu_supports("sse4.2") != 0;
    case Isa::avx2:
      return __builtin_cpu_supports("avx2") != 0;
    case Isa::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
             __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  }
  return false;
}

Isa newest_isa() {
  for (const Isa isa : {Isa::avx512, Isa::avx2, Isa::sse42}) {
    if (isa_supported(isa)) return isa;
  }
  throw Error(ErrorKind::failure, "processor", "has no SSE4.2");
}

}  // namespace raylab
