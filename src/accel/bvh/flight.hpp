#pragma once
// Many rays side by side, each on its own way; as local to the including file as box_test.hpp.
#include <new>
#include <type_traits>

#include "packet_tests.hpp"
#include "traverse.hpp"

namespace raylab::bvh {
namespace {

/// What of a tree the rays of a group are yet to visit, each on its own. The counts lie apart, so that those of rays
/// for which nothing waits take few cache lines.
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
inline KernelRay ray_at(const RayColumns& rays, std::size_t i, float limit) {
  KernelRay ray;
  _mm_store_ps(ray.origin, _mm_setr_ps(rays.origin[0][i], rays.origin[1][i], rays.origin[2][i], rays.t_min[i]));
  _mm_store_ps(ray.direction,
               _mm_setr_ps(rays.direction[0][i], rays.direction[1][i], rays.direction[2][i], limit));
  return ray;
}

/// Where a Flight keeps what is yet to be visited. Nearly all do with the shallow part; it is small, so that those of
/// many flights stay in the nearest cache and seldom share the lower bits of their addresses, on which a processor
/// compares loads with earlier stores.
struct FlightStack {
  static constexpr int kShallow = 32;
  alignas(64) float distances[kShallow];
  alignas(64) Ref refs[kShallow];
};
template <int width>
struct DeepStack {
  alignas(64) float distances[stack_size(width)];
  alignas(64) Ref refs[stack_size(width)];
};

/// A query that is taken forward by one node or block at a time, so that several can go on side by side.
template <class NodeVector, bool any_hit>
class alignas(64) Flight {
 public:
  static constexpr int width = NodeVector::lanes;
  static constexpr Intersector kind = Intersector::watertight;
  using Found = BlockTest<kind>::Found;
  using Deep = DeepStack<width>;

  /// `best` is a hit at the ray's limit, or has no place and -1 for t. What waits is that for ray i.
  Flight(const TreeView& tree, const KernelRay& ray, const KernelHit& best, const Waiting& waiting, int i,
         FlightStack& stack, Deep& deep)
      : ray_(ray),
        box_test_(ray_),
        block_test_(ray_),
        best_(best),
        limit_(ray.limit),
        distances_(stack.distances),
        refs_(stack.refs),
        deep_(deep) {
    distances_[0] = -1.0f;
    refs_[0] = make_ref(RefKind::end, 0);
    for (int k = waiting.count[i]; k-- > 0;) {
      int at = ++top_;
      const float distance = waiting.of[i].distances[k];
      for (; !any_hit && distances_[at - 1] < distance && at > 1; --at) {
        distances_[at] = distances_[at - 1];
        refs_[at] = refs_[at - 1];
      }
      distances_[at] = distance;
      refs_[at] = waiting.of[i].refs[k];
    }
    go_on(tree);
  }
  Flight(const Flight&) = delete;
  Flight& operator=(const Flight&) = delete;

  /// What its next visit is to.
  RefKind next() const { return ref_kind(ref_); }

  /// With any_hit only its place says something: whether there is one.
  const KernelHit& best() const { return best_; }

  void visit_node(const TreeView& tree) {
    const auto& node = at<Node<width>>(tree, ref_);
    NodeVector near, far;
    box_test_(node, NodeVector::splat(limit_), near, far);
    if (top_ > highest_top_) [[unlikely]]
      deepen();
    if constexpr (any_hit) {
      top_ += push_all(near, far, node.child, refs_ + top_ + 1);
    } else {
      top_ += push_all(near, far, node.child, node.order[box_test_.octant()], distances_ + top_ + 1,
                       refs_ + top_ + 1);
    }
    go_on(tree);
  }

  /// Of triangles: the lanes inside whose edges the ray passes, ...
  template <class Block>
  std::uint32_t find_inside(const TreeView& tree, Found& inside) const {
    return block_test_.find_inside(at<Block>(tree, ref_), inside);
  }
  /// ... and which of those it hits.
  template <class Block>
  void decide(const TreeView& tree, const Found& inside, std::uint32_t found) {
    const Block& block = at<Block>(tree, ref_);
    for (; found != 0; found &= found - 1) {
      KernelHit hit;
      if (!block_test_.template decide_one<any_hit>(block, inside, __builtin_ctz(found), limit_, hit)) continue;
      if (any_hit) return end(hit.place);
      take(hit, tree, best_, limit_);
    }
  }
  const KernelRay& ray() const { return ray_; }
  float limit() const { return limit_; }
  /// Place of the sphere it visits.
  std::uint32_t place() const { return ref_index(ref_); }
  void take_sphere(const TreeView& tree, float t) {
    if (any_hit) return end(place());
    take({t, 0.0f, 0.0f, place()}, tree, best_, limit_);
  }
  /// From a block or a sphere to what is next.
  void go_on(const TreeView& tree) {
    if constexpr (!any_hit) {
      while (distances_[top_] > limit_) --top_;
    }
    ref_ = refs_[top_--];
    prefetch(tree, ref_);
  }

 private:
  /// Nothing more to be visited.
  void end(std::uint32_t place) {
    best_.place = place;
    top_ = 0;
  }
  [[gnu::noinline, gnu::cold]] void deepen() {
    for (int i = 0; i <= top_; ++i) {
      deep_.distances[i] = distances_[i];
      deep_.refs[i] = refs_[i];
    }
    distances_ = deep_.distances;
    refs_ = deep_.refs;
    highest_top_ = stack_size(width);
  }

  KernelRay ray_;
  BoxTest<NodeVector> box_test_;
  BlockTest<kind> block_test_;
  KernelHit best_;
  float limit_;
  Ref ref_;
  int top_ = 0;
  int highest_top_ = FlightStack::kShallow - 1 - width;  ///< from which a node's children have room
  float* distances_;
  Ref* refs_;
  Deep& deep_;
};

/// Rays that are on their ways at one time.
constexpr int kFlights = 32;

/// Takes some rays to the end of their ways, kFlights of them side by side: start(i, room, stack, deep) makes a Flight
/// of ray i in that room, and end(i, hit) is given what it has come to.
///
/// A ray alone mostly waits: for memory in a large tree, for one operation to follow the other, and where the
/// processor has guessed wrong whether a node or a block comes next, or whether a block holds a hit. So the rays are
/// sorted by what comes next for each: all visits to nodes, then all visits to blocks, then all distances.
template <class NodeVector, bool any_hit, class Start, class End>
class Fleet {
 public:
  Fleet(const TreeView& tree, const std::uint8_t* rays, int count, const Start& start, const End& end)
      : tree_(tree), rays_(rays), count_(count), start_(start), end_(end) {
    for (int kind = 0; kind < kKinds; ++kind) begins_[kind] = ends_[kind] = lists_[0][kind];
  }

  [[gnu::noinline]] void run() {
    int flying = 0;
    while (flying < kFlights && start_next(flying)) ++flying;
    while (flying != 0) {
      visit_nodes(take_list(RefKind::node));
      visit_blocks<SharedBlock>(take_list(RefKind::triangles));
      visit_blocks<SeparateBlock>(take_list(RefKind::separate));
      visit_spheres(take_list(RefKind::sphere));
      for (const std::uint8_t slot : take_list(RefKind::end)) {
        end_(ray_of_[slot], flight(slot).best());
        if (!start_next(slot)) --flying;
      }
    }
  }

 private:
  using OneRay = Flight<NodeVector, any_hit>;
  static_assert(std::is_trivially_destructible_v<OneRay>);
  struct Slot {
    alignas(OneRay) unsigned char flight[sizeof(OneRay)];
    FlightStack stack;
  };
  /// Slots of rays that visit the same kind of thing.
  struct List {
    const std::uint8_t* first;
    const std::uint8_t* last;

    const std::uint8_t* begin() const { return first; }
    const std::uint8_t* end() const { return last; }
    int size() const { return static_cast<int>(last - first); }
  };

  OneRay& flight(int slot) { return *std::launder(reinterpret_cast<OneRay*>(slots_[slot].flight)); }

  bool start_next(int slot) {
    if (next_ == count_) return false;
    const int i = rays_[next_++];
    start_(i, slots_[slot].flight, slots_[slot].stack, deep_[slot]);
    ray_of_[slot] = i;
    put(slot);
    return true;
  }

  /// Into the list of what it visits next.
  void put(int slot) { *ends_[static_cast<int>(flight(slot).next())]++ = static_cast<std::uint8_t>(slot); }

  /// There are two lists for each kind: while one is gone through, the other fills.
  List take_list(RefKind of) {
    const int kind = static_cast<int>(of);
    const List list{begins_[kind], ends_[kind]};
    begins_[kind] = ends_[kind] = lists_[begins_[kind] == lists_[0][kind] ? 1 : 0][kind];
    return list;
  }

  [[gnu::always_inline]] void visit_nodes(const List& list) {
    for (const std::uint8_t slot : list) {
      flight(slot).visit_node(tree_);
      put(slot);
    }
  }

  template <class Block>
  [[gnu::always_inline]] void visit_blocks(const List& list) {
    int met = 0;
    for (const std::uint8_t slot : list) {
      found_[met] = flight(slot).template find_inside<Block>(tree_, inside_[met]);
      met_[met] = slot;
      met += found_[met] != 0;
    }
    for (int i = 0; i < met; ++i) flight(met_[i]).template decide<Block>(tree_, inside_[i], found_[i]);
    leave(list);
  }

  /// One in each lane of a vector.
  [[gnu::always_inline]] void visit_spheres(const List& list) {
    for (int first = 0; first < list.size(); first += kLanes) {
      const int count = list.size() - first < kLanes ? list.size() - first : kLanes;
      alignas(64) float rays[8][kLanes], spheres[4][kLanes];
      for (int i = 0; i < count; ++i) {
        const OneRay& one = flight(list.first[first + i]);
        const KernelRay& ray = one.ray();
        for (int k = 0; k < 3; ++k) {
          rays[k][i] = ray.origin[k];
          rays[3 + k][i] = ray.direction[k];
        }
        rays[6][i] = ray.t_min;
        rays[7][i] = one.limit();
        const float* const sphere = sphere_at(tree_, one.place());
        for (int k = 0; k < 4; ++k) spheres[k][i] = sphere[k];
      }
      const WideDouble sphere[4] = {WideDouble(Wide::load(spheres[0])), WideDouble(Wide::load(spheres[1])),
                                    WideDouble(Wide::load(spheres[2])), WideDouble(Wide::load(spheres[3]))};
      Wide t(0.0f);
      const WideMask hit = sphere_distance(
          first_lanes(static_cast<std::size_t>(count)), WideVec3::load(rays[0], rays[1], rays[2]),
          WideVec3::load(rays[3], rays[4], rays[5]), sphere, Wide::load(rays[6]), Wide::load(rays[7]), t);
      alignas(64) float distances[kLanes];
      t.store(distances);
      for (std::uint32_t left = hit.bits(); left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        flight(list.first[first + i]).take_sphere(tree_, distances[i]);
      }
    }
    leave(list);
  }

  void leave(const List& list) {
    for (const std::uint8_t slot : list) {
      flight(slot).go_on(tree_);
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
  std::uint8_t lists_[2][kKinds][kFlights];
  int ray_of_[kFlights];
  // Of the blocks inside some of whose triangles' edges a ray passes: whose ray, which lanes, and what is known of them.
  std::uint8_t met_[kFlights];
  std::uint32_t found_[kFlights];
  typename OneRay::Found inside_[kFlights];
  Slot slots_[kFlights];
  typename OneRay::Deep deep_[kFlights];
};

}  // namespace
}  // namespace raylab::bvh
