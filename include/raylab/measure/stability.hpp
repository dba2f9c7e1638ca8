#pragma once
// The known ways in which ray tracers fail, each as a case: a sweep of the quantity that breaks, and how many of the
// trials fail at each of its values.
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raylab/accel/accelerator.hpp"
#include "raylab/measure/row_schema.hpp"
#include "raylab/render/integrator.hpp"

namespace raylab {

struct StabilityCount {
  std::size_t failures = 0;
  std::size_t trials = 0;
};

/// What a case is tried with. What does not apply to a case is absent.
struct StabilityMethod {
  std::string accel = kDefaultAccelerator;  ///< empty where no rays are traced
  std::optional<Intersector> intersector;
  std::optional<Isa> isa;
  std::optional<BuildQuality> quality;
  std::optional<bool> batch;  ///< whether rays are sent in batches
  std::optional<IntegratorKind> integrator;
  std::optional<RayOffset> ray_offset;

  AcceleratorOptions options() const;
  std::string name() const;
};

/// Fields of a row that name the method.
void add_fields(Row& row, const StabilityMethod& method);

/// What a case can be tried with.
enum class StabilityMethods : std::uint8_t {
  queries,    ///< accelerators with each triangle test, single rays and batches
  batches,    ///< accelerators with each triangle test; the case sends batches itself
  qualities,  ///< build qualities of an accelerator
  offsets,    ///< ways to leave a surface
  renders,    ///< integrators with each way to leave a surface
  paths,      ///< the same but for `book`, which does not find small lamps
  ours,       ///< nothing to choose from
};

/// What the methods are made from. Empty lists: all accelerators but the exact one (of pictures: the default one), all
/// triangle tests, the newest instruction set.
struct StabilityChoice {
  std::vector<std::string> accels;
  std::vector<Intersector> intersectors;
  std::vector<Isa> isas;
};

/// Tries a method, with what all methods share made before.
using StabilityTrial = std::function<StabilityCount(const StabilityMethod&)>;

struct StabilityCase {
  int id;             ///< from 1, in the order in which failures became known
  std::string name;   ///< short, for the command line
  std::string title;  ///< what is tried
  std::string fails;  ///< what counts as a failure
  std::string swept;  ///< the quantity that is swept, with its unit
  StabilityMethods methods;
  std::vector<double> values;  ///< of that quantity, ascending
  /// The least and the largest value up to which the default method is held to fail nowhere.
  double holds_from, holds_to;
  /// A method known to fail somewhere in the sweep, as its name() says; empty where none is.
  std::string naive;
  /// About `count` trials at one of the values, the same for the same seed.
  std::function<StabilityTrial(double value, std::size_t count, std::uint64_t seed)> prepare;
  /// The rate up to which the default method may fail at the values that it is held to.
  double largest_rate = 0.0;
  std::string theme = "";  ///< what it has in common with others, for charts

  bool holds_at(double value) const;
};

/// All cases, by their ids.
std::span<const StabilityCase> stability_cases();

/// The case of that name or number. Throws Error (usage) for an unknown one, naming those there are.
const StabilityCase& find_stability_case(std::string_view name);

/// Methods for such a case.
std::vector<StabilityMethod> stability_methods(const StabilityCase& tried, const StabilityChoice& choice = {});

/// The method that is held to what a case claims: `bvh` as it stands by default, in single rays.
StabilityMethod default_stability_method(const StabilityCase& tried);

}  // namespace raylab
