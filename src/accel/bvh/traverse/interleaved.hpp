#pragma once
// Many rays side by side, each on its own way.
#include <new>
#include <type_traits>

#include "packet_tests.hpp"

namespace raylab::bvh {
namespace {

/// The subtrees that each ray of a group has yet to visit alone. The counts are stored apart, so that rays with nothing
/// waiting touch few cache lines.
struct Waiting {
  static constexpr int kMost = 16;
  std::uint8_t count[kGroup] = {};
  struct {
    Ref refs[kMost];
    float distances[kMost];  ///< at which the ray enters
  } of[kGroup];

  void add(int ray, Ref ref, float distance) {
    const int at = count[ray]++;
    of[ray].refs[at] = ref;
    of[ray].distances[at] = distance;
  }
};

/// The ray at a place in arrays, with this limit.
inline TraversalRay ray_at(const RayBatch& rays, std::size_t i, float limit) {
  TraversalRay ray;
  Float<4>::of(rays.origin[0][i], rays.origin[1][i], rays.origin[2][i], rays.t_min[i]).store(ray.origin);
  Float<4>::of(rays.direction[0][i], rays.direction[1][i], rays.direction[2][i], limit).store(ray.direction);
  return ray;
}

/// Where an InterleavedRay keeps what is yet to be visited. Nearly all do with this much; it is small, so that those of
/// many rays stay in the nearest cache and seldom share the lower bits of their addresses, on which a processor
/// compares loads with earlier stores.
struct ShallowStack {
  static constexpr int kSize = 32;
  alignas(64) float distances[kSize];
  alignas(64) Ref refs[kSize];
};

/// Made before the traversal that refers to it.
struct OwnedRay {
  TraversalRay owned_ray;
};

/// A ray that takes turns with others.
template <bool any_hit>
class alignas(64) InterleavedRay : OwnedRay, public RayTraversal<Intersector::watertight, any_hit> {
  using Base = RayTraversal<Intersector::watertight, any_hit>;
  using Base::distances_, Base::refs_, Base::top_;

 public:
  /// What waits is that for ray i.
  InterleavedRay(const TreeView& tree, const TraversalRay& ray, const TraversalHit& best, const Waiting& waiting, int i,
                 ShallowStack& stack, DeepStack& deep)
      : OwnedRay{ray}, Base(owned_ray, best, stack.distances, stack.refs), deep_(deep) {
    for (int k = waiting.count[i]; k-- > 0;) this->add(waiting.of[i].refs[k], waiting.of[i].distances[k]);
    this->go_on(tree);
  }

  void visit_node(const TreeView& tree) {
    if (top_ > highest_top_) [[unlikely]]
      deepen();
    Base::visit_node(tree);
    this->go_on(tree);
  }

 private:
  [[gnu::noinline, gnu::cold]] void deepen() {
    for (int i = 0; i <= top_; ++i) {
      deep_.distances[i] = distances_[i];
      deep_.refs[i] = refs_[i];
    }
    distances_ = deep_.distances;
    refs_ = deep_.refs;
    highest_top_ = kStackSize;
  }

  int highest_top_ = ShallowStack::kSize - 1 - kWidth;  ///< from which a node's children have room
  DeepStack& deep_;
};

/// Rays that are traced at one time.
constexpr int kInterleaved = 32;

/// Traces some rays, kInterleaved of them at a time: start(i, room, stack, deep) constructs the InterleavedRay of ray i
/// in `room`, and end(i, hit) receives its result.
///
/// A single ray mostly waits: for memory in a large tree, for the result of the operation before, and after branches
/// mispredicted on whether a node or a block comes next, or whether a block holds a hit. So the rays are sorted by
/// their next visit: nodes first, then blocks (edges before distances), then spheres.
template <bool any_hit, class Start, class End>
class InterleavedTraversal {
 public:
  InterleavedTraversal(const TreeView& tree, const std::uint8_t* rays, int count, const Start& start, const End& end)
      : tree_(tree), rays_(rays), count_(count), start_(start), end_(end) {
    for (int kind = 0; kind < kKinds; ++kind) begins_[kind] = ends_[kind] = lists_[0][kind];
  }

  [[gnu::noinline]] void run() {
    int under_way = 0;
    while (under_way < kInterleaved && start_next(under_way)) ++under_way;
    while (under_way != 0) {
      visit_nodes(take_list(RefKind::node));
      visit_blocks<SharedBlock>(take_list(RefKind::triangles));
      visit_blocks<SeparateBlock>(take_list(RefKind::separate));
      visit_spheres(take_list(RefKind::sphere));
      for (const std::uint8_t slot : take_list(RefKind::end)) {
        end_(ray_of_[slot], ray_in(slot).best());
        if (!start_next(slot)) --under_way;
      }
    }
  }

 private:
  using OneRay = InterleavedRay<any_hit>;
  static_assert(std::is_trivially_destructible_v<OneRay>);
  struct Slot {
    alignas(OneRay) unsigned char ray[sizeof(OneRay)];
    ShallowStack stack;
  };
  /// Slots of rays that visit the same kind of thing.
  struct List {
    const std::uint8_t* first;
    const std::uint8_t* last;

    const std::uint8_t* begin() const { return first; }
    const std::uint8_t* end() const { return last; }
    int size() const { return static_cast<int>(last - first); }
  };

  OneRay& ray_in(int slot) { return *std::launder(reinterpret_cast<OneRay*>(slots_[slot].ray)); }

  bool start_next(int slot) {
    if (next_ == count_) return false;
    const int i = rays_[next_++];
    start_(i, slots_[slot].ray, slots_[slot].stack, deep_[slot]);
    ray_of_[slot] = i;
    put(slot);
    return true;
  }

  /// Into the list of what it visits next.
  void put(int slot) { *ends_[static_cast<int>(ray_in(slot).next())]++ = static_cast<std::uint8_t>(slot); }

  /// There are two lists for each kind: while one is gone through, the other fills.
  List take_list(RefKind of) {
    const int kind = static_cast<int>(of);
    const List list{begins_[kind], ends_[kind]};
    begins_[kind] = ends_[kind] = lists_[begins_[kind] == lists_[0][kind] ? 1 : 0][kind];
    return list;
  }

  [[gnu::always_inline]] void visit_nodes(const List& list) {
    for (const std::uint8_t slot : list) {
      ray_in(slot).visit_node(tree_);
      put(slot);
    }
  }

  template <class Block>
  [[gnu::always_inline]] void visit_blocks(const List& list) {
    int met = 0;
    for (const std::uint8_t slot : list) {
      found_[met] = ray_in(slot).template find_inside<Block>(tree_, inside_[met]);
      met_[met] = slot;
      met += found_[met] != 0;
    }
    for (int i = 0; i < met; ++i) ray_in(met_[i]).template decide<Block>(tree_, inside_[i], found_[i]);
    leave(list);
  }

  /// One in each lane of a vector.
  [[gnu::always_inline]] void visit_spheres(const List& list) {
    for (int first = 0; first < list.size(); first += kLanes) {
      const int count = list.size() - first < kLanes ? list.size() - first : kLanes;
      alignas(64) float rays[8][kLanes], spheres[4][kLanes];
      for (int i = 0; i < count; ++i) {
        const OneRay& one = ray_in(list.first[first + i]);
        for (int k = 0; k < 4; ++k) {
          rays[k][i] = one.ray().origin[k];
          rays[4 + k][i] = one.ray().direction[k];
        }
        rays[7][i] = one.limit();
        const float* const sphere = sphere_at(tree_, ref_index(one.ref()));
        for (int k = 0; k < 4; ++k) spheres[k][i] = sphere[k];
      }
      Wide t(0.0f);
      const WideMask hit =
          hit_sphere(first_lanes(static_cast<std::size_t>(count)), load3(rays[0], rays[1], rays[2]),
                     load3(rays[4], rays[5], rays[6]), Vec3<WideDouble>(load3(spheres[0], spheres[1], spheres[2])),
                     WideDouble(Wide::load(spheres[3])), Wide::load(rays[3]), Wide::load(rays[7]), t);
      alignas(64) float distances[kLanes];
      t.store(distances);
      for (std::uint32_t left = hit.bits(); left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        ray_in(list.first[first + i]).take_sphere(tree_, distances[i]);
      }
    }
    leave(list);
  }

  void leave(const List& list) {
    for (const std::uint8_t slot : list) {
      ray_in(slot).go_on(tree_);
      put(slot);
    }
  }

  static constexpr int kKinds = static_cast<int>(RefKind::end) + 1;

  const TreeView& tree_;
  const std::uint8_t* const rays_;
  const int count_;
  const Start& start_;
  const End& end_;
  int next_ = 0;
  std::uint8_t* begins_[kKinds];  ///< of the lists that fill
  std::uint8_t* ends_[kKinds];
  std::uint8_t lists_[2][kKinds][kInterleaved];
  int ray_of_[kInterleaved];
  // For each block with a triangle whose edges a ray passes inside: the ray's slot, those lanes, and their data.
  std::uint8_t met_[kInterleaved];
  std::uint32_t found_[kInterleaved];
  typename OneRay::Found inside_[kInterleaved];
  Slot slots_[kInterleaved];
  DeepStack deep_[kInterleaved];
};

}  // namespace
}  // namespace raylab::bvh
