#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace raylab {

/// Instruction sets that the hot loops are compiled for. One is chosen at run time, and all give the same results,
/// bit for bit.
enum class Isa : std::uint8_t { sse42, avx2, avx512, neon };

/// Those compiled for this architecture, from the oldest to the newest.
#if defined(__x86_64__)
inline constexpr std::array kCompiledIsas = {Isa::sse42, Isa::avx2, Isa::avx512};
#elif defined(__aarch64__)
inline constexpr std::array kCompiledIsas = {Isa::neon};
#else
#error "Raylab has vectors for 64-bit x86 and 64-bit Arm"
#endif

/// Its name on the command line.
constexpr std::string_view isa_name(Isa isa) {
  switch (isa) {
    case Isa::sse42:
      return "sse4.2";
    case Isa::avx2:
      return "avx2";
    case Isa::avx512:
      return "avx512";
    case Isa::neon:
      return "neon";
  }
  return "unknown instruction set";
}

/// A feature of processors by the name that the compiler knows it by, and whether this processor has it.
struct IsaFeature {
  std::string_view name;
  bool present;
};

/// All that files compiled for the set may use; empty for a value that names none.
std::vector<IsaFeature> isa_features(Isa isa);

/// Whether this processor has all of isa_features().
bool isa_supported(Isa isa);

/// The newest set that this processor has. Throws Error (failure) where it has none.
Isa newest_isa();

/// The set that is asked for, or the newest where none is. Throws Error (usage) for one that this processor lacks.
Isa choose_isa(std::optional<Isa> asked);

}  // namespace raylab
