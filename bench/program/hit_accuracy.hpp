#pragma once
// Counts the wrong answers of an accelerator, and gives them as fields of a row.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "raylab/measure/judge.hpp"
#include "raylab/measure/path_rays.hpp"
#include "suite.hpp"

namespace raylab::bench {

struct HitAccuracy {
  HitErrors errors;
  std::size_t wrong = 0;              ///< rays with any error: the kinds overlap
  std::size_t batch_differences = 0;  ///< rays answered otherwise, be it by a bit, in a batch
  std::size_t wrong_batch = 0;        ///< as `wrong`, of rays in batches
};

/// Knows the exact answers for one geometry, which must outlive it.
class HitChecker {
 public:
  explicit HitChecker(const Geometry& geometry);

  /// Checks each accelerator on `count` of the rays, evenly spaced.
  std::vector<HitAccuracy> operator()(std::span<const Accelerator* const> accelerators, const RaySet& set,
                                      std::size_t count, Suite& suite) const;

 private:
  const Geometry& geometry_;
  std::unique_ptr<Accelerator> exact_;
};

void add_fields(Row& row, const HitAccuracy& accuracy);
std::string accuracy_text(const Row& row);

}  // namespace raylab::bench
