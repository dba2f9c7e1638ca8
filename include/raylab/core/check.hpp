#pragma once
// RAYLAB_CHECK(condition): an invariant of the program itself. Broken, it stops the program with its place,
// in every build type: a wrong picture that looks right is worse than none.

namespace raylab::detail {
[[noreturn]] void check_failed(const char* condition, const char* file, int line) noexcept;
}

#define RAYLAB_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::raylab::detail::check_failed(#condition, __FILE__, __LINE__))
