#include "binary_tree.hpp"

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <vector>

#include "layout.hpp"
#include "raylab/core/check.hpp"
#include "raylab/core/parallel.hpp"
#include "reinsertion.hpp"
#include "vertex_set.hpp"

namespace raylab::bvh {

namespace {

/// Below this depth splits follow the surface area heuristic; from there on they halve the number of primitives,
/// which bounds the depth on any input.
constexpr int kHeuristicDepth = 44;
static_assert(kHeuristicDepth + 32 < kMaxDepth);

/// Subtrees of fewer primitives are built by one thread.
constexpr std::uint32_t kParallelGrain = 4096;
constexpr std::size_t kChunk = 16384;

constexpr int kMostBins = 32;

__m128 load(const vec3& v) { return _mm_load_ps(&v.x); }  // of a Primitive or BinaryNode: 16 bytes, aligned

struct Box {
  __m128 lower = _mm_set1_ps(kInfinity);
  __m128 upper = _mm_set1_ps(-kInfinity);

  void extend(__m128 point) {
    lower = _mm_min_ps(lower, point);
    upper = _mm_max_ps(upper, point);
  }
  void extend(const Box& box) {
    lower = _mm_min_ps(lower, box.lower);
    upper = _mm_max_ps(upper, box.upper);
  }
  void extend(const Primitive& p) {
    lower = _mm_min_ps(lower, load(p.lower));
    upper = _mm_max_ps(upper, load(p.upper));
  }
};

/// Half the area of a box whose sides are multiplied by `scale`; not a number if it is empty.
float scaled_area(const Box& box, __m128 scale) {
  alignas(16) float d[4];
  _mm_store_ps(d, _mm_mul_ps(_mm_sub_ps(box.upper, box.lower), scale));
  return d[0] * (d[1] + d[2]) + d[1] * d[2];
}

/// Twice the centre.
__m128 center(const Primitive& p) { return _mm_add_ps(load(p.lower), load(p.upper)); }

/// Cost of testing n primitives that one leaf or several hold.
float leaf_cost(std::uint32_t n) { return static_cast<float>((n + 7) / 8); }

/// A range of primitives with what the next split needs to know of it.
struct Range {
  std::uint32_t begin, end;
  Box bounds;
  Box centers;  ///< of the doubled centres

  std::uint32_t size() const { return end - begin; }
};

/// Maps centres to bins, the same way for counting and for partitioning.
struct Binning {
  int bins;
  __m128 origin, scale, last;

  Binning(const Range& range, int count) : bins(count), origin(range.centers.lower) {
    last = _mm_set1_ps(static_cast<float>(bins - 1));
    const __m128 extent = _mm_sub_ps(range.centers.upper, range.centers.lower);
    scale = _mm_div_ps(_mm_set1_ps(0.9999f * static_cast<float>(bins)), extent);
  }

  /// Whether the centres differ along the axis, by enough to compute with.
  bool usable(int axis) const {
    alignas(16) float s[4];
    _mm_store_ps(s, scale);
    return s[axis] < kInfinity;
  }

  __m128i operator()(const Primitive& p) const {
    const __m128 bin = _mm_mul_ps(_mm_sub_ps(center(p), origin), scale);
    return _mm_cvttps_epi32(_mm_min_ps(_mm_max_ps(bin, _mm_setzero_ps()), last));
  }
};

struct Split {
  int axis = -1;  ///< none found
  int bin = 0;    ///< bins below this one go left
  float cost = kInfinity;
};

class Builder {
 public:
  Builder(const Geometry& geometry, BvhQuality quality, BinaryTree& tree)
      : geometry_(geometry), bins_(quality == BvhQuality::fast ? 16 : kMostBins), tree_(tree) {}

  void run() {
    collect();
    const auto count = static_cast<std::uint32_t>(tree_.primitives.size());
    if (count == 0) return;
    RAYLAB_CHECK(tree_.primitives.size() <= kLargestRefIndex);
    tree_.nodes = HugeArray<BinaryNode>(2 * static_cast<std::size_t>(count) - 1);  // touched only where used
    Range all{0, count, {}, {}};
    for (const Primitive& p : tree_.primitives) {
      all.bounds.extend(p);
      all.centers.extend(center(p));
    }
    build(0, all, 1);
    tree_.nodes.shrink(next_node_);
  }

 private:
  /// Bounds that no ray misses that the triangle test lets hit. Where the test is off, it is by the rounding of
  /// coordinates relative to the origin of the ray, so by a few units in the last place of the distance, which
  /// the box test allows for, and of the size of the triangle.
  static void grow(Primitive& p, float size) {
    for (int axis = 0; axis < 3; ++axis) {
      p.lower[axis] -= size * 0x1p-21f + std::abs(p.lower[axis]) * 0x1p-23f;
      p.upper[axis] += size * 0x1p-21f + std::abs(p.upper[axis]) * 0x1p-23f;
    }
  }

  void collect() {
    struct Chunk {
      std::uint32_t geometry;
      std::size_t first, count;
      std::size_t target;
      std::size_t valid = 0;
    };
    std::vector<Chunk> chunks;
    std::size_t total = 0;
    for (std::uint32_t g = 0; g <= geometry_.sphere_geometry(); ++g) {
      const std::size_t size =
          geometry_.is_sphere(g) ? geometry_.spheres.size() : geometry_.meshes[g].triangles.size();
      for (std::size_t first = 0; first < size; first += kChunk) {
        const std::size_t count = std::min(kChunk, size - first);
        chunks.push_back({g, first, count, total});
        total += count;
      }
    }
    tree_.primitives = HugeArray<Primitive>(total);
    HugeArray<Primitive>& primitives = tree_.primitives;
    parallel_for(chunks.size(), [&](std::size_t c) {
      Chunk& chunk = chunks[c];
      Primitive* out = primitives.data() + chunk.target;
      for (std::size_t i = chunk.first; i < chunk.first + chunk.count; ++i) {
        if (make_primitive({chunk.geometry, static_cast<std::uint32_t>(i)}, *out)) ++out;
      }
      chunk.valid = static_cast<std::size_t>(out - primitives.data()) - chunk.target;
    });
    std::size_t valid = 0;
    for (const Chunk& chunk : chunks) {
      if (valid != chunk.target) {
        std::copy_n(primitives.begin() + chunk.target, chunk.valid, primitives.begin() + valid);
      }
      valid += chunk.valid;
    }
    primitives.shrink(valid);
  }

  bool make_primitive(const PrimitiveId& id, Primitive& out) const {
    out.geometry = id.geometry;
    out.primitive = id.primitive;
    if (geometry_.is_sphere(id.geometry)) {
      const Sphere& sphere = geometry_.spheres[id.primitive];
      if (!is_valid_sphere(sphere)) return false;
      const Bounds b = sphere_bounds(sphere);
      out.lower = b.lower;
      out.upper = b.upper;
      grow(out, 0.0f);
      return true;
    }
    const TriangleMesh& mesh = geometry_.meshes[id.geometry];
    if (!is_valid_triangle(mesh, id.primitive)) return false;
    const Bounds b = triangle_bounds(triangle_corners(mesh, id.primitive));
    out.lower = b.lower;
    out.upper = b.upper;
    grow(out, max_component(b.diagonal()));
    return true;
  }

  /// What leaf the primitives can be: a sphere alone, or triangles that share their vertices or hardly do.
  /// Triangles in between are parted, into two smaller blocks instead of one that is larger than both.
  std::optional<RefKind> leaf_kind(const Range& range) const {
    if (range.size() > kBlockSize) return std::nullopt;
    VertexSet vertices;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Primitive& p = tree_.primitives[i];
      if (geometry_.is_sphere(p.geometry)) {
        if (range.size() == 1) return RefKind::sphere;
        return std::nullopt;
      }
      const TriangleMesh& mesh = geometry_.meshes[p.geometry];
      const uvec3& corners = mesh.triangles[p.primitive];
      for (int c = 0; c < 3; ++c) vertices.add(p.geometry, mesh, corners[c]);
    }
    if (vertices.size() > 2 * kBlockSize) return RefKind::separate;
    if (vertices.size() > kBlockSize) return std::nullopt;
    return RefKind::triangles;
  }

  void build(std::uint32_t node_index, const Range& range, int depth) {
    BinaryNode& node = tree_.nodes[node_index];
    _mm_store_ps(&node.lower.x, range.bounds.lower);
    _mm_store_ps(&node.upper.x, range.bounds.upper);
    if (const auto kind = leaf_kind(range)) {
      node.first = range.begin;
      node.count = static_cast<std::uint16_t>(range.size());
      node.kind = *kind;
      std::sort(tree_.primitives.begin() + range.begin, tree_.primitives.begin() + range.end,
                [](const Primitive& a, const Primitive& b) {
                  return a.geometry != b.geometry ? a.geometry < b.geometry : a.primitive < b.primitive;
                });
      return;
    }
    Range left, right;
    split(range, depth, left, right);
    const std::uint32_t child = next_node_.fetch_add(2, std::memory_order_relaxed);
    node.first = child;
    node.count = 0;
    node.kind = RefKind::node;
    if (range.size() > kParallelGrain) {
      parallel_invoke([&] { build(child, left, depth + 1); }, [&] { build(child + 1, right, depth + 1); });
    } else {
      build(child, left, depth + 1);
      build(child + 1, right, depth + 1);
    }
  }

  void split(const Range& range, int depth, Range& left, Range& right) {
    left = {range.begin, range.begin, {}, {}};
    right = {range.end, range.end, {}, {}};
    if (range.size() <= kBlockSize && split_by_kind(range, left, right)) return;
    if (depth < kHeuristicDepth) {
      const int bins = std::min(bins_, 8 + static_cast<int>(range.size() / 8));
      const Binning binning(range, bins);
      const Split best = find_split(range, binning);
      if (best.axis >= 0) {
        const auto axis = static_cast<std::size_t>(best.axis);
        partition(range, left, right, [&](const Primitive& p) {
          alignas(16) std::array<int, 4> bin;
          _mm_store_si128(reinterpret_cast<__m128i*>(bin.data()), binning(p));
          return bin[axis] < best.bin;
        });
        return;
      }
    }
    split_in_half(range, left, right);
  }

  /// Spheres go right, since a leaf does not mix them with triangles.
  bool split_by_kind(const Range& range, Range& left, Range& right) {
    const auto is_sphere = [&](const Primitive& p) { return geometry_.is_sphere(p.geometry); };
    const auto begin = tree_.primitives.begin() + range.begin;
    const auto end = tree_.primitives.begin() + range.end;
    const auto spheres = std::count_if(begin, end, is_sphere);
    if (spheres == 0 || spheres == end - begin) return false;
    partition(range, left, right, [&](const Primitive& p) { return !is_sphere(p); });
    return true;
  }

  /// Along the axis on which the centres differ most; any half where they do not differ at all.
  void split_in_half(const Range& range, Range& left, Range& right) {
    alignas(16) float extent[4];
    _mm_store_ps(extent, _mm_sub_ps(range.centers.upper, range.centers.lower));
    const int axis = extent[0] >= extent[1] && extent[0] >= extent[2] ? 0 : (extent[1] >= extent[2] ? 1 : 2);
    const auto begin = tree_.primitives.begin() + range.begin;
    const std::uint32_t half = range.size() / 2;
    std::nth_element(begin, begin + half, tree_.primitives.begin() + range.end,
                     [axis](const Primitive& a, const Primitive& b) {
                       const float ca = a.lower[axis] + a.upper[axis];
                       const float cb = b.lower[axis] + b.upper[axis];
                       if (ca != cb) return ca < cb;
                       return a.geometry != b.geometry ? a.geometry < b.geometry : a.primitive < b.primitive;
                     });
    left.end = right.begin = range.begin + half;
    for (Range* part : {&left, &right}) {
      for (std::uint32_t i = part->begin; i < part->end; ++i) add(tree_.primitives[i], *part);
    }
  }

  static void add(const Primitive& p, Range& range) {
    range.bounds.extend(p);
    range.centers.extend(center(p));
  }

  template <class GoesLeft>
  void partition(const Range& range, Range& left, Range& right, const GoesLeft& goes_left) {
    Primitive* i = tree_.primitives.data() + range.begin;
    Primitive* j = tree_.primitives.data() + range.end;
    for (;;) {
      while (i < j && goes_left(*i)) add(*i++, left);
      while (i < j && !goes_left(*(j - 1))) add(*--j, right);
      if (i >= j) break;
      std::swap(*i, *(j - 1));
    }
    left.end = right.begin = static_cast<std::uint32_t>(i - tree_.primitives.data());
  }

  [[gnu::noinline]] Split find_split(const Range& range, const Binning& binning) const {
    Box boxes[3][kMostBins];
    std::uint32_t counts[3][kMostBins] = {};
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Primitive& p = tree_.primitives[i];
      alignas(16) int bin[4];
      _mm_store_si128(reinterpret_cast<__m128i*>(bin), binning(p));
      for (int axis = 0; axis < 3; ++axis) {
        boxes[axis][bin[axis]].extend(p);
        ++counts[axis][bin[axis]];
      }
    }

    alignas(16) float extent[4];
    _mm_store_ps(extent, _mm_sub_ps(range.bounds.upper, range.bounds.lower));
    // Areas relative to the largest side, so that the squares stay in the range of float.
    const __m128 scale = _mm_set1_ps(1.0f / std::max(extent[0], std::max(extent[1], extent[2])));
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!binning.usable(axis)) continue;
      float right_costs[kMostBins];
      Box right;
      std::uint32_t right_count = 0;
      for (int bin = binning.bins - 1; bin > 0; --bin) {
        right.extend(boxes[axis][bin]);
        right_count += counts[axis][bin];
        right_costs[bin] = right_count == 0 ? kInfinity : scaled_area(right, scale) * leaf_cost(right_count);
      }
      Box left;
      std::uint32_t left_count = 0;
      for (int bin = 1; bin < binning.bins; ++bin) {
        left.extend(boxes[axis][bin - 1]);
        left_count += counts[axis][bin - 1];
        if (left_count == 0) continue;
        const float cost = scaled_area(left, scale) * leaf_cost(left_count) + right_costs[bin];
        if (cost < best.cost) best = {axis, bin, cost};
      }
    }
    return best;
  }

  const Geometry& geometry_;
  int bins_;
  BinaryTree& tree_;
  std::atomic<std::uint32_t> next_node_{1};
};

}  // namespace

BinaryTree build_binary_tree(const Geometry& geometry, BvhQuality quality) {
  BinaryTree tree;
  Builder(geometry, quality, tree).run();
  if (quality == BvhQuality::best) reinsert_subtrees(tree);
  return tree;
}

}  // namespace raylab::bvh
