#pragma once
#include <functional>
#include <optional>

#include "raylab/accel/accelerator.hpp"

namespace raylab::test {

/// Answers with what a function makes of another accelerator's answer.
class ChangedAnswers final : public Accelerator {
 public:
  using Change = std::function<std::optional<Hit>(const Ray&, const std::optional<Hit>&)>;
  ChangedAnswers(const Accelerator& original, Change change, bool occluded_always = false)
      : original_(original), change_(std::move(change)), occluded_always_(occluded_always) {}
  std::optional<Hit> intersect(const Ray& ray) const noexcept override {
    return change_(ray, original_.intersect(ray));
  }
  bool occluded(const Ray& ray) const noexcept override { return occluded_always_ || intersect(ray).has_value(); }
  const BuildReport& build_report() const noexcept override { return original_.build_report(); }

 private:
  const Accelerator& original_;
  Change change_;
  bool occluded_always_;
};

}  // namespace raylab::test
