#pragma once
// The query contract every accelerator fulfils, and how one is chosen by name.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "raylab/core/isa.hpp"
#include "raylab/core/ray.hpp"
#include "raylab/geometry/geometry.hpp"
#include "raylab/geometry/intersect.hpp"

namespace raylab {

/// What building an accelerator took and gave.
struct BuildReport {
  double seconds = 0.0;                ///< wall clock
  std::size_t bytes = 0;               ///< held by the accelerator, the scene's own arrays not counted
  std::size_t primitives = 0;          ///< valid primitives that can be hit
  std::size_t invalid_primitives = 0;  ///< left out: see is_valid_triangle, is_valid_sphere
  std::size_t nodes = 0;               ///< inner nodes; 0 where unknown or none
  int depth = 0;                       ///< of the deepest leaf, the root being 1; 0 where unknown
  double sah_cost = 0.0;  ///< expected cost of a random ray, node and primitive tests counting 1; 0 where unknown
  std::string isa;        ///< instruction set the traversal uses, such as "sse4.2" or "avx2"
};

/// Rays side by side: one array for each component, `count` long. Each ray is as in Ray.
struct RayBatch {
  std::size_t count;
  const float* origin[3];
  const float* direction[3];
  const float* t_min;
  const float* t_max;

  Ray ray(std::size_t i) const {
    return {{origin[0][i], origin[1][i], origin[2][i]},
            {direction[0][i], direction[1][i], direction[2][i]},
            t_min[i],
            t_max[i]};
  }
};

/// Hits side by side, to be written: `geometry` is kNoHit where there is none, and the rest is then anything.
struct HitBatch {
  float* t;
  float* u;
  float* v;
  std::uint32_t* geometry;
  std::uint32_t* primitive;

  void set(std::size_t i, const std::optional<Hit>& hit) const {
    geometry[i] = kNoHit;
    if (!hit) return;
    t[i] = hit->t;
    u[i] = hit->u;
    v[i] = hit->v;
    geometry[i] = hit->geometry;
    primitive[i] = hit->primitive;
  }
  static constexpr std::uint32_t kNoHit = 0xffffffffu;
};

/// Finds what a ray hits. Constructed means built. Queries may run on many threads at once and allocate
/// nothing. A ray has a finite origin, any finite non-zero direction, and 0 <= t_min; its interval may be empty. One
/// with a NaN or an infinity, but for t_max, or without direction hits nothing. Invalid primitives behave as if
/// absent. Threads that query have FlushDenormals set, as in parallel_for: denormals count as zero, in ray and t.
/// The geometry given at construction is viewed, not copied: it must outlive the accelerator, unchanged.
class Accelerator {
 public:
  virtual ~Accelerator() = default;

  /// Closest hit with t_min < t < t_max, or nothing.
  virtual std::optional<Hit> intersect(const Ray& ray) const noexcept = 0;

  /// Whether anything is hit with t_min < t < t_max.
  virtual bool occluded(const Ray& ray) const noexcept = 0;

  /// The same for many rays at once; answers equal those of single rays to the bit where the accelerator's
  /// capabilities say so (batch_equals_single), and are as good elsewhere. Rays that lie side by side should be
  /// alike: an accelerator may trace them together. What does not override these asks for one ray after the other.
  virtual void intersect_batch(const RayBatch& rays, const HitBatch& hits) const noexcept;
  /// Writes 1 or 0 for each ray.
  virtual void occluded_batch(const RayBatch& rays, std::uint8_t* occluded) const noexcept;

  virtual const BuildReport& build_report() const noexcept = 0;
};

/// How much building time may be spent on a better tree. Of `bvh`: `fast` splits in the middle of the centres,
/// `balanced` by the surface area heuristic, and `best` also splits the space that primitives share and moves
/// subtrees to where they cost least. Of Embree: its low, medium and high build quality.
enum class BuildQuality { fast, balanced, best };

/// Choices for those accelerators that offer them, see AcceleratorCapabilities.
struct AcceleratorOptions {
  std::optional<Intersector> intersector;  ///< absent: the accelerator's own default
  int threads = 0;                         ///< for building; 0: all; every accelerator takes it
  std::optional<BuildQuality> quality;     ///< absent: balanced
  std::optional<Isa> isa;                  ///< absent: the newest the processor has
  bool compact = false;                    ///< a tree that takes less memory, and more time
};

using AcceleratorFactory = std::function<std::unique_ptr<Accelerator>(const Geometry&, const AcceleratorOptions&)>;

/// What an accelerator takes and is fit for. As it stands by default it says nothing of the options: they are all
/// passed on, for the accelerator to judge.
struct AcceleratorCapabilities {
  bool judges_options = true;      ///< is given options that it is not said to take too, and refuses them itself
  bool takes_intersector = false;  ///< AcceleratorOptions::intersector, each value of it
  bool takes_quality = false;      ///< AcceleratorOptions::quality, each value of it
  bool takes_isa = false;          ///< AcceleratorOptions::isa, as far as the processor has it
  bool takes_compact = false;      ///< AcceleratorOptions::compact
  /// Primitives of the largest scene that it is fit for: beyond, a ray takes thousands of times as long as with
  /// others.
  std::size_t largest_primitives = std::numeric_limits<std::size_t>::max();
  bool is_exact = false;             ///< decides every hit without rounding: others are judged by it; slow
  bool batch_equals_single = true;   ///< batches have the answers of single rays to the bit
  double bytes_per_primitive = 0.0;  ///< BuildReport::bytes, about, of a large scene in the usual quality; 0: unknown
};

/// One accelerator that can be chosen by name.
struct AcceleratorEntry {
  std::string name;
  std::string description;  ///< one line
  AcceleratorFactory make;  ///< does not check the options: make_accelerator does
  AcceleratorCapabilities capabilities = {};
};

/// What is used where none is chosen.
inline constexpr const char* kDefaultAccelerator = "bvh";

/// The accelerators there are, built-in ones first, in a fixed order.
std::span<const AcceleratorEntry> accelerators();

/// The accelerators that there are, as an option's type, which --help and the shells' completions show: {list,rtiow}.
std::string accelerator_choice();

/// The accelerator of that name. Throws Error (usage) for an unknown name, naming those there are.
AcceleratorEntry find_accelerator(std::string_view name);

/// Throws Error (usage) for an option that the accelerator does not take, naming those that do. What one that
/// judges its options for itself refuses is only known when it is built.
void check_options(const AcceleratorEntry& entry, const AcceleratorOptions& options);

/// The options without those that the accelerator does not take.
AcceleratorOptions options_taken(const AcceleratorEntry& entry, AcceleratorOptions options);

/// Builds the accelerator of that name. Throws Error (usage) as find_accelerator and check_options do.
std::unique_ptr<Accelerator> make_accelerator(std::string_view name, const Geometry& geometry,
                                              const AcceleratorOptions& options = {});

/// Adds an accelerator of one's own: a namespace-scope object in its source file is all it takes.
///   static const raylab::RegisterAccelerator registered{{"mine", "what it is", make_mine}};
/// A fourth value says what it is capable of; raylab-bench measures it with each triangle test where it takes one.
/// When the name is taken, it is left out, and the first call of accelerators() or make_accelerator() throws Error
/// (usage).
struct RegisterAccelerator {
  explicit RegisterAccelerator(AcceleratorEntry entry);
};

std::string_view intersector_name(Intersector intersector);
/// Throws Error (usage) for an unknown name.
Intersector parse_intersector(std::string_view name);
std::string_view quality_name(BuildQuality quality);
/// Throws Error (usage) for an unknown name.
BuildQuality parse_quality(std::string_view name);
/// Throws Error (usage) for an unknown name.
Isa parse_isa(std::string_view name);

}  // namespace raylab
