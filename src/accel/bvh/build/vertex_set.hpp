#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "../layout/layout.hpp"
#include "raylab/geometry/geometry.hpp"

namespace raylab::bvh {

/// The different positions of a few triangles, numbered in the order in which they come. Vertices of equal
/// position are one, also where a file has one for each triangle.
class VertexSet {
 public:
  static constexpr std::size_t kMost = 3 * kBlockSize;

  /// The number of a mesh's vertex, which is added if its position is new.
  std::size_t add(std::uint32_t mesh_index, const TriangleMesh& mesh, std::uint32_t vertex) {
    const std::uint64_t key = static_cast<std::uint64_t>(mesh_index) << 32 | vertex;
    const auto known_keys = keys_.begin() + static_cast<std::ptrdiff_t>(key_count_);
    const auto key_at = static_cast<std::size_t>(std::find(keys_.begin(), known_keys, key) - keys_.begin());
    if (key_at < key_count_) return number_[key_at];
    const vec3 position = mesh.positions[vertex];
    const auto known = positions_.begin() + static_cast<std::ptrdiff_t>(size_);
    const auto at = static_cast<std::size_t>(std::find(positions_.begin(), known, position) - positions_.begin());
    if (at == size_) positions_[size_++] = position;
    keys_[key_count_] = key;
    number_[key_count_++] = at;
    return at;
  }

  std::size_t size() const { return size_; }
  const vec3& position(std::size_t number) const { return positions_[number]; }

 private:
  std::array<std::uint64_t, kMost> keys_;  ///< which vertices were asked for
  std::array<std::size_t, kMost> number_;  ///< theirs
  std::array<vec3, kMost> positions_;
  std::size_t key_count_ = 0, size_ = 0;
};

}  // namespace raylab::bvh
