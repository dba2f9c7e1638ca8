#include "raylab/core/isa.hpp"

#include <algorithm>
#include <string>

#include "raylab/core/error.hpp"

namespace raylab {

// A macro, since the compiler takes nothing but a literal for the name.
#define RAYLAB_FEATURE(name) \
  IsaFeature { name, __builtin_cpu_supports(name) != 0 }

std::vector<IsaFeature> isa_features(Isa isa) {
  switch (isa) {
#if defined(__x86_64__)
    case Isa::sse42:
      return {RAYLAB_FEATURE("sse4.2"), RAYLAB_FEATURE("popcnt")};
    case Isa::avx2:
      return {RAYLAB_FEATURE("avx2"), RAYLAB_FEATURE("popcnt"), RAYLAB_FEATURE("bmi")};
    case Isa::avx512:
      return {RAYLAB_FEATURE("avx512f"),  RAYLAB_FEATURE("avx512bw"), RAYLAB_FEATURE("avx512dq"),
              RAYLAB_FEATURE("avx512vl"), RAYLAB_FEATURE("popcnt"),   RAYLAB_FEATURE("bmi")};
#else
    case Isa::neon:  // every 64-bit Arm processor has it
      return {{"neon", true}};
#endif
    default:
      return {};
  }
}

#undef RAYLAB_FEATURE

bool isa_supported(Isa isa) {
  const std::vector<IsaFeature> features = isa_features(isa);
  return !features.empty() && std::ranges::all_of(features, &IsaFeature::present);
}

Isa newest_isa() {
  const auto newest = std::find_if(kCompiledIsas.rbegin(), kCompiledIsas.rend(), isa_supported);
  if (newest == kCompiledIsas.rend()) throw Error(ErrorKind::failure, "processor", "has no SSE4.2");
  return *newest;
}

Isa choose_isa(std::optional<Isa> asked) {
  if (!asked) return newest_isa();
  if (isa_supported(*asked)) return *asked;
  throw Error(ErrorKind::usage, "--isa", "this processor has no " + std::string(isa_name(*asked)));
}

}  // namespace raylab
