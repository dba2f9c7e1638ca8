#pragma once
// The agreement test every accelerator has to pass, one of the user's own included.
#include <functional>
#include <string>
#include <vector>

#include "raylab/accel/accelerator.hpp"
#include "raylab/measure/agreement.hpp"

namespace raylab {

/// Geometry and rays on which any two accelerators should agree.
struct AgreementCase {
  std::string name;
  Geometry geometry;
  std::vector<Ray> rays;
};

/// Well-scaled scenes with 10,000 random rays each, half of them with an interval that may leave out what they are
/// aimed at: triangles, a closed mesh, spheres, both together, boxes along the axes, copies of one triangle, one
/// primitive, none; and some with degenerate and invalid primitives among the good ones.
std::vector<AgreementCase> agreement_cases(std::uint64_t seed);

/// Compares an accelerator with `list` (watertight) on all cases, telling each result; batches with rays
/// one by one too, where its capabilities promise that they are equal. True when they agree on all, and the
/// accelerator's report counts valid and invalid primitives right. Throws Error (usage) for an option it does not take.
bool passes_agreement(const AcceleratorEntry& entry, const AcceleratorOptions& options, std::uint64_t seed,
                      const std::function<void(const AgreementCase&, const AgreementReport&)>& tell);
/// The same by its name. Throws Error (usage) for an unknown one, too.
bool passes_agreement(std::string_view name, const AcceleratorOptions& options, std::uint64_t seed,
                      const std::function<void(const AgreementCase&, const AgreementReport&)>& tell);

}  // namespace raylab
