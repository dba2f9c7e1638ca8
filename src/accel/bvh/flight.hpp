#pragma once
// Many rays side by side, each on its own way; as local to the including file as ray_tests.hpp.
#include <new>
#include <type_traits>

#include "traverse.hpp"

namespace raylab::bvh {
namespace {

/// What of a tree a ray is yet to visit.
struct Waiting {
  static constexpr int kMost = 16;
  int count = 0;
  Ref refs[kMost];
  float distances[kMost];  ///< at which the ray enters

  void add(Ref ref, float distance) {
    refs[count] = ref;
    distances[count++] = distance;
  }
};

/// The ray at a place in arrays, with this limit.
inline KernelRay ray_at(const RayArrays& rays, std::size_t i, float limit) {
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

  /// `best` is a hit at the ray's limit, or has no place and -1 for t.
  Flight(const TreeView& tree, const KernelRay& ray, const KernelHit& best, const Waiting& waiting,
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
    for (int i = waiting.count; i-- > 0;) {
      int at = ++top_;
      const float distance = waiting.distances[i];
      for (; !any_hit && distances_[at - 1] < distance && at > 1; --at) {
        distances_[at] = distances_[at - 1];
        refs_[at] = refs_[at - 1];
      }
      distances_[at] = distance;
      refs_[at] = waiting.refs[i];
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

  /// Of triangles, in three steps: the lanes inside whose edges the ray passes, ...
  template <class Block>
  std::uint32_t find_inside(const TreeView& tree, Found& inside) const {
    return block_test_.find_inside(at<Block>(tree, ref_), inside);
  }
  /// ... which of those it hits, if there are any, ...
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
  /// ... and on to the next visit.
  void leave_block(const TreeView& tree) { go_on(tree); }

  void visit_sphere(const TreeView& tree) {
    float t;
    const std::uint32_t place = ref_index(ref_);
    if (hit_sphere<kind>(tree.context, place, ray_, limit_, t)) {
      if (any_hit) {
        end(place);
      } else {
        take({t, 0.0f, 0.0f, place}, tree, best_, limit_);
      }
    }
    go_on(tree);
  }

 private:
  void go_on(const TreeView& tree) {
    if constexpr (!any_hit) {
      while (distances_[top_] > limit_) --top_;
    }
    ref_ = refs_[top_--];
    prefetch(tree, ref_);
  }
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

/// Queries side by side.
constexpr int kFlights = 32;

/// Takes `count` rays to the end of their ways, kFlights of them side by side: start(i, slot) makes a Flight of one, or
/// returns false where nothing waits for it, and end(i, flight) is given what has ended.
///
/// A ray alone mostly waits: for memory in a large tree, for one operation to follow the other, and where the
/// processor has guessed wrong whether a node or a block comes next, or whether a block holds a hit. So the rays are
/// sorted by what comes next for each: all visits to nodes, then all visits to blocks, then all distances.
template <class NodeVector, bool any_hit, class Start, class End>
[[gnu::always_inline]] inline void fly(const TreeView& tree, int count, const Start& start_flight,
                                       const End& end_flight) {
  using OneRay = Flight<NodeVector, any_hit>;
  static_assert(std::is_trivially_destructible_v<OneRay>);
  struct Slot {
    alignas(OneRay) unsigned char flight[sizeof(OneRay)];
    FlightStack stack;
  };
  Slot slots[kFlights];
  typename OneRay::Deep deep[kFlights];
  int ray_of[kFlights];
  const auto flight = [&](int s) -> OneRay& { return *std::launder(reinterpret_cast<OneRay*>(slots[s].flight)); };
  // By what they visit next the slots of the rays, twice: while one list is gone through, the other fills.
  constexpr int kinds = static_cast<int>(RefKind::end) + 1;
  std::uint8_t lists[2][kinds][kFlights];
  std::uint8_t* begins[kinds];
  std::uint8_t* ends[kinds];
  for (int kind = 0; kind < kinds; ++kind) begins[kind] = ends[kind] = lists[0][kind];
  const auto put = [&](int s) { *ends[static_cast<int>(flight(s).next())]++ = static_cast<std::uint8_t>(s); };
  struct Visits {
    const std::uint8_t* slots;
    int count;
  };
  const auto take_list = [&](RefKind of) {
    const int kind = static_cast<int>(of);
    const Visits visits{begins[kind], static_cast<int>(ends[kind] - begins[kind])};
    begins[kind] = ends[kind] = lists[begins[kind] == lists[0][kind] ? 1 : 0][kind];
    return visits;
  };
  int next = 0;
  const auto start = [&](int s) {
    while (next < count) {
      const int i = next++;
      if (!start_flight(i, slots[s].flight, slots[s].stack, deep[s])) continue;
      ray_of[s] = i;
      put(s);
      return true;
    }
    return false;
  };
  int flying = 0;
  while (flying < kFlights && start(flying)) ++flying;
  using Found = typename OneRay::Found;
  Found inside[kFlights];
  std::uint32_t lanes[kFlights];
  std::uint8_t met[kFlights];
  const auto visit_blocks = [&](RefKind kind, const auto& find, const auto& decide) {
    const Visits visits = take_list(kind);
    int met_count = 0;
    for (int i = 0; i < visits.count; ++i) {
      const int s = visits.slots[i];
      lanes[met_count] = find(flight(s), inside[met_count]);
      met[met_count] = static_cast<std::uint8_t>(s);
      met_count += lanes[met_count] != 0;
    }
    for (int i = 0; i < met_count; ++i) decide(flight(met[i]), inside[i], lanes[i]);
    for (int i = 0; i < visits.count; ++i) {
      const int s = visits.slots[i];
      flight(s).leave_block(tree);
      put(s);
    }
  };
  const auto visit_each = [&](RefKind kind, const auto& visit) {
    const Visits visits = take_list(kind);
    for (int i = 0; i < visits.count; ++i) {
      const int s = visits.slots[i];
      visit(flight(s));
      put(s);
    }
  };
  while (flying != 0) {
    visit_each(RefKind::node, [&](OneRay& f) { f.visit_node(tree); });
    visit_blocks(
        RefKind::triangles,
        [&](OneRay& f, Found& in) { return f.template find_inside<SharedBlock>(tree, in); },
        [&](OneRay& f, const Found& in, std::uint32_t found) { f.template decide<SharedBlock>(tree, in, found); });
    visit_blocks(
        RefKind::separate,
        [&](OneRay& f, Found& in) { return f.template find_inside<SeparateBlock>(tree, in); },
        [&](OneRay& f, const Found& in, std::uint32_t found) { f.template decide<SeparateBlock>(tree, in, found); });
    visit_each(RefKind::sphere, [&](OneRay& f) { f.visit_sphere(tree); });
    const Visits ended = take_list(RefKind::end);
    for (int i = 0; i < ended.count; ++i) {
      const int s = ended.slots[i];
      end_flight(ray_of[s], flight(s).best());
      if (!start(s)) --flying;
    }
  }
}

}  // namespace
}  // namespace raylab::bvh
