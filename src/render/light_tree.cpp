#include "light_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace raylab {

namespace {

/// Up to so many emitters every way to split them is tried; of more, the middle of the longest side.
constexpr std::size_t kMostTried = 256;

void extend(Bounds& bounds, const TreeEmitter& e) {
  bounds.extend(e.center - vec3(e.radius));
  bounds.extend(e.center + vec3(e.radius));
}

/// A symmetric matrix.
struct Moments {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  dvec3 times(const dvec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

/// An axis and how much of the squared intensity there is across it, in four bytes.
std::uint32_t pack_facing(const dvec3& axis, double all_round) {
  const auto byte = [](double x) { return static_cast<std::uint32_t>(std::lround(127.0 * (x + 1.0))); };
  const auto share = static_cast<std::uint32_t>(std::ceil(255.0 * std::clamp(all_round, 0.0, 1.0) - 1e-9));
  return byte(axis.x) | byte(axis.y) << 8 | byte(axis.z) << 16 | share << 24;
}

}  // namespace

/// What a node holds of a child.
struct LightTree::Cluster {
  vec3 center;
  float radius;
  float strength;
  std::uint32_t facing;
};

LightTree::Cluster LightTree::cluster_of(std::span<const TreeEmitter> emitters) {
  if (emitters.size() == 1) {
    const TreeEmitter& e = emitters[0];
    return {e.center, e.radius, e.strength, pack_facing(dvec3(e.ng), e.ng == vec3(0.0f) ? 1.0 : 0.0)};
  }
  Bounds bounds;
  double strength = 0.0;
  Moments m;  // of the normals, by intensity
  for (const TreeEmitter& e : emitters) {
    extend(bounds, e);
    const double w = e.strength;
    strength += w;
    if (e.ng == vec3(0.0f)) {
      // As many triangles turned every way have a mean square of a third.
      const double each = w / std::sqrt(3.0);
      strength += (std::sqrt(3.0) - 1.0) * w;
      m.xx += each, m.yy += each, m.zz += each;
      continue;
    }
    const dvec3 n(e.ng);
    m.xx += w * n.x * n.x, m.yy += w * n.y * n.y, m.zz += w * n.z * n.z;
    m.xy += w * n.x * n.y, m.xz += w * n.x * n.z, m.yz += w * n.y * n.z;
  }
  const double trace = m.xx + m.yy + m.zz;
  // The axis along which the mean square is largest, by iteration from the largest column.
  dvec3 axis = m.xx >= m.yy && m.xx >= m.zz ? dvec3(1, 0, 0) : m.yy >= m.zz ? dvec3(0, 1, 0) : dvec3(0, 0, 1);
  for (int i = 0; i < 32; ++i) {
    const dvec3 next = m.times(axis);
    const double length = glm::length(next);
    if (!(length > 0.0)) break;
    axis = next / length;
  }
  const double along = trace > 0.0 ? glm::dot(axis, m.times(axis)) / trace : 1.0;
  const double across = 0.5 * (1.0 - along);
  const dvec3 center = 0.5 * (dvec3(bounds.lower) + dvec3(bounds.upper));
  double radius = 0.0;
  for (const TreeEmitter& e : emitters) {
    radius = std::max(radius, glm::length(dvec3(e.center) - center) + static_cast<double>(e.radius));
  }
  return {vec3(center), static_cast<float>(radius), static_cast<float>(strength * std::sqrt(along)),
          pack_facing(axis, across / along)};
}

LightTree::LightTree(std::vector<TreeEmitter> emitters) {
  if (emitters.empty()) return;
  std::uint32_t geometries = 0;
  for (const TreeEmitter& e : emitters) geometries = std::max(geometries, e.geometry + 1);
  std::vector<std::uint32_t> sizes(geometries + 1, 0);
  for (const TreeEmitter& e : emitters) sizes[e.geometry + 1] = std::max(sizes[e.geometry + 1], e.primitive + 1);
  std::inclusive_scan(sizes.begin(), sizes.end(), sizes.begin());
  places_.resize(sizes.back(), kNowhere);
  first_place_ = std::move(sizes);
  ids_.reserve(emitters.size());
  nodes_.resize(1);
  links_.push_back({0, kNowhere});
  build(0, emitters, 0, emitters.size());
  for (const TreeEmitter& e : emitters) ids_.push_back({e.geometry, e.primitive});
  nodes_.shrink_to_fit();
  links_.shrink_to_fit();
}

void LightTree::set_child(std::uint32_t node, std::uint32_t child, std::span<const TreeEmitter> emitters) {
  const Cluster c = cluster_of(emitters);
  LightNode& n = nodes_[node];
  for (int k = 0; k < 3; ++k) n.center[k][child] = c.center[k];
  n.radius[child] = c.radius;
  n.strength[child] = c.strength;
  n.facing[child] = c.facing;
}

void LightTree::build(std::uint32_t node, std::span<TreeEmitter> all, std::size_t begin, std::size_t end) {
  const std::size_t count = end - begin;
  if (count <= LightNode::kWidth) {
    links_[node].first = static_cast<std::uint32_t>(begin) | LightLink::kLeaf;
    for (std::size_t i = 0; i < count; ++i) {
      const TreeEmitter& e = all[begin + i];
      set_child(node, static_cast<std::uint32_t>(i), all.subspan(begin + i, 1));
      places_[first_place_[e.geometry] + e.primitive] = node * LightNode::kWidth + static_cast<std::uint32_t>(i);
    }
    return;
  }
  // Subtrees are full but for one, so that a node is never larger than what it holds.
  std::size_t block = LightNode::kWidth;
  while (block * LightNode::kWidth < count) block *= LightNode::kWidth;
  std::vector<std::size_t> ends;
  split(all.subspan(begin, count), begin, block, ends);
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  links_[node].first = first;
  nodes_.resize(first + ends.size());
  std::size_t from = begin;
  for (std::uint32_t i = 0; i < ends.size(); ++i) {
    set_child(node, i, all.subspan(from, ends[i] - from));
    links_.push_back({0, node * LightNode::kWidth + i});
    from = ends[i];
  }
  from = begin;
  for (std::uint32_t i = 0; i < ends.size(); ++i) {
    build(first + i, all, from, ends[i]);
    from = ends[i];
  }
}

/// Splits emitters, the first of which has index `first`, into blocks; appends where each ends. The cost of two halves
/// is the sum of their strengths times the squares of their sizes.
void LightTree::split(std::span<TreeEmitter> emitters, std::size_t first, std::size_t block,
                      std::vector<std::size_t>& ends) {
  const std::size_t count = emitters.size(), blocks = (count + block - 1) / block;
  if (blocks == 1) {
    ends.push_back(first + count);
    return;
  }
  const auto along = [](int axis) {
    return [axis](const TreeEmitter& a, const TreeEmitter& b) {
      return std::tuple(a.center[axis], a.geometry, a.primitive) < std::tuple(b.center[axis], b.geometry, b.primitive);
    };
  };
  std::size_t left = blocks / 2 * block;
  if (count > kMostTried) {
    Bounds centers;
    for (const TreeEmitter& e : emitters) centers.extend(e.center);
    std::nth_element(emitters.begin(), emitters.begin() + static_cast<std::ptrdiff_t>(left), emitters.end(),
                     along(centers.longest_axis()));
  } else {
    double best = -1.0;
    int best_axis = 0;
    std::vector<double> costs(blocks);
    for (int axis = 0; axis < 3; ++axis) {
      std::sort(emitters.begin(), emitters.end(), along(axis));
      const auto sweep = [&](bool from_left) {
        Bounds bounds;
        double strength = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
          const std::size_t at = from_left ? i : count - 1 - i;
          extend(bounds, emitters[at]);
          strength += static_cast<double>(emitters[at].strength);
          const std::size_t border = from_left ? at + 1 : at;
          if (border % block != 0 || border == 0 || border == count) continue;
          const dvec3 size(bounds.diagonal());
          double& cost = costs[border / block];
          cost = strength * glm::dot(size, size) + (from_left ? 0.0 : cost);
        }
      };
      sweep(true);
      sweep(false);
      for (std::size_t k = 1; k < blocks; ++k) {
        if (best >= 0.0 && !(costs[k] < best)) continue;
        best = costs[k];
        best_axis = axis;
        left = k * block;
      }
    }
    std::sort(emitters.begin(), emitters.end(), along(best_axis));
  }
  split(emitters.first(left), first, block, ends);
  split(emitters.subspan(left), first + left, block, ends);
}

LightTreeView LightTree::view(std::uint64_t end) const {
  return {nodes_.data(), links_.data(), end, end == 0 ? 1.0f : static_cast<float>(static_cast<double>(end) * 0x1p-64)};
}

std::uint32_t LightTree::place(std::uint32_t geometry, std::uint32_t primitive) const {
  if (geometry + 1 >= first_place_.size()) return kNowhere;
  const std::uint32_t index = first_place_[geometry] + primitive;
  return index < first_place_[geometry + 1] ? places_[index] : kNowhere;
}

std::size_t LightTree::bytes() const {
  return nodes_.capacity() * sizeof(LightNode) + links_.capacity() * sizeof(LightLink) +
         ids_.capacity() * sizeof(EmitterId) + (first_place_.capacity() + places_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace raylab
