#pragma once
#include <cstdint>

namespace raylab {

/// Instruction sets that the hot loops are compiled for, from the oldest to the newest. One is chosen at run time, and
/// all give the same results, bit for bit.
enum class Isa : std::uint8_t { sse42, avx2, avx512 };

/// Whether this processor has all that files compiled for the set may use.
bool isa_supported(Isa isa);

/// The newest set that this processor has. Throws Error (failure) where it has none.
Isa newest_isa();

}  // namespace raylab
