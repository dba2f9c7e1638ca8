#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "raylab/core/vec.hpp"

namespace raylab {

/// The index array of an attribute (normals or texture coordinates), which stays empty while no face has the attribute
/// or every index equals that of the position.
class CornerIndices {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;  ///< a corner without the attribute

  /// Adds a triangle's indices. `triangles` holds those of its positions, this triangle's own at the end.
  void add(const uvec3& indices, const std::vector<uvec3>& triangles) {
    const uvec3& own = triangles.back();
    if (state_ == State::absent) {
      if (indices == uvec3(kNone)) return;
      state_ = State::shared;
      if (triangles.size() > 1) separate(std::vector<uvec3>(triangles.size() - 1, uvec3(kNone)), triangles);
    }
    if (state_ == State::shared && indices != own) {
      separate(std::vector<uvec3>(triangles.begin(), triangles.end() - 1), triangles);
    }
    if (state_ == State::separate) indices_.push_back(indices);
  }

  bool absent() const { return state_ == State::absent; }

  /// Empty when absent or equal to the positions'.
  std::vector<uvec3>& indices() { return indices_; }

 private:
  enum class State : std::uint8_t { absent, shared, separate };

  void separate(std::vector<uvec3> so_far, const std::vector<uvec3>& triangles) {
    so_far.reserve(triangles.capacity());
    indices_ = std::move(so_far);
    state_ = State::separate;
  }

  State state_ = State::absent;
  std::vector<uvec3> indices_;
};

}  // namespace raylab
