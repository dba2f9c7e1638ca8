// Exits with 0 when `grid` agrees with testing every primitive.
#include <cstdio>
#include <raylab/measure/agreement_cases.hpp>

int main() {
  const bool passes = raylab::passes_agreement("grid", {}, 1, [](const auto& test, const auto& report) {
    std::printf("%s: %s\n", test.name.c_str(), raylab::to_string(report).c_str());
  });
  return passes ? 0 : 1;
}
