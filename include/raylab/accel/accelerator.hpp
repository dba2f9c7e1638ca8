#pragma once
// The query contract every accelerator fulfils, and how one is chosen by name.
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"
#include "raylab/geometry/intersect.hpp"

namespace raylab {

/// What building an accelerator took and gave.
struct BuildReport {
  double seconds = 0.0;              ///< wall clock
  std::size_t bytes = 0;             ///< held by the accelerator, the scene's own arrays not counted
  std::size_t primitives = 0;        ///< valid primitives that can be hit
  std::size_t invalid_primitives = 0;  ///< left out: see is_valid_triangle, is_valid_sphere
  std::size_t nodes = 0;             ///< inner nodes; 0 where unknown or none
  int depth = 0;                     ///< of the deepest leaf, the root being 1; 0 where unknown
  double sah_cost = 0.0;  ///< expected cost of a random ray, node and primitive tests counting 1; 0 where unknown
  std::string isa;        ///< instruction set the traversal uses, such as "sse4.2" or "avx2"
};

/// Finds what a ray hits. Constructed means built. Queries may run on many threads at once and allocate
/// nothing. A ray has a finite origin, any finite non-zero direction, and 0 <= t_min; its interval may be empty.
/// Invalid primitives behave as if absent. Threads that query have FlushDenormals set, as in parallel_for:
/// denormals count as zero, in the ray as in t.
/// The geometry given at construction is viewed, not copied: it must outlive the accelerator, unchanged.
class Accelerator {
 public:
  virtual ~Accelerator() = default;

  /// Closest hit with t_min < t < t_max, or nothing.
  virtual std::optional<Hit> intersect(const Ray& ray) const noexcept = 0;

  /// Whether anything is hit with t_min < t < t_max.
  virtual bool occluded(const Ray& ray) const noexcept = 0;

  virtual const BuildReport& build_report() const noexcept = 0;
};

/// How much building time `bvh` may spend on a better tree. So far `best` builds the tree of `balanced`.
enum class BvhQuality { fast, balanced, best };

/// Instruction sets that `bvh` is compiled for, from the oldest to the newest.
enum class Isa { sse42, avx2, avx512 };

/// Choices for those accelerators that offer them.
struct AcceleratorOptions {
  std::optional<Intersector> intersector;  ///< absent: the accelerator's own default
  int threads = 0;                         ///< for building; 0: all
  std::optional<BvhQuality> quality;       ///< absent: balanced; `bvh` only
  std::optional<Isa> isa;                  ///< absent: the newest the processor has; `bvh` only
};

using AcceleratorFactory = std::function<std::unique_ptr<Accelerator>(const Geometry&, const AcceleratorOptions&)>;

/// One accelerator that can be chosen by name.
struct AcceleratorEntry {
  std::string name;
  std::string description;  ///< one line
  AcceleratorFactory make;
};

/// The accelerators there are, built-in ones first, in a fixed order.
std::span<const AcceleratorEntry> accelerators();

/// Builds the accelerator of that name. Throws Error (usage) for an unknown name, naming those there are, and
/// for an option the accelerator does not take.
std::unique_ptr<Accelerator> make_accelerator(std::string_view name, const Geometry& geometry,
                                              const AcceleratorOptions& options = {});

/// Adds an accelerator of one's own: a namespace-scope object in its source file is all it takes.
///   static const raylab::RegisterAccelerator registered{{"mine", "what it is", make_mine}};
/// Throws Error (usage) when the name is taken.
struct RegisterAccelerator {
  explicit RegisterAccelerator(AcceleratorEntry entry);
};

std::string_view intersector_name(Intersector intersector);
/// Throws Error (usage) for an unknown name.
Intersector parse_intersector(std::string_view name);
std::string_view quality_name(BvhQuality quality);
/// Throws Error (usage) for an unknown name.
BvhQuality parse_quality(std::string_view name);
std::string_view isa_name(Isa isa);
/// Throws Error (usage) for an unknown name.
Isa parse_isa(std::string_view name);

}  // namespace raylab
