#pragma once
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "raylab/core/vec.hpp"

namespace raylab {

/// Finds points that are equal. They hold no -0, which equals 0 and would not be found. An open hash table, half full
/// at most, of indices into the points.
class PointTable {
 public:
  PointTable(std::vector<vec3>& points, std::size_t expected) : points_(points) { resize(2 * expected); }

  /// Starts to fetch what index_of will look at: most of its time is spent waiting for that.
  void prefetch(const vec3& p) const { __builtin_prefetch(&slots_[slot_of(p)], 1); }

  /// Index of the point, which becomes the last of the points if it is new.
  std::uint32_t index_of(const vec3& p) {
    for (std::size_t at = slot_of(p);; at = (at + 1) & (slots_.size() - 1)) {
      if (slots_[at] == kFree) {
        slots_[at] = static_cast<std::uint32_t>(points_.size());
        points_.push_back(p);
        if (2 * points_.size() > slots_.size()) resize(2 * slots_.size());
        return static_cast<std::uint32_t>(points_.size() - 1);
      }
      if (points_[slots_[at]] == p) return slots_[at];
    }
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffff;

  std::size_t slot_of(const vec3& p) const {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x)}; };
    std::uint64_t hash = (bits(p.x) | bits(p.y) << 32) * 0x9e3779b97f4a7c15u;
    hash = ((hash ^ hash >> 32) + bits(p.z)) * 0xd6e8feb86659fd93u;
    return static_cast<std::size_t>((hash ^ hash >> 32) * 0x9e3779b97f4a7c15u >> shift_);
  }

  void resize(std::size_t least) {
    slots_.assign(std::bit_ceil(std::max<std::size_t>(least, 64)), kFree);
    shift_ = 64 - std::countr_zero(slots_.size());
    for (std::uint32_t i = 0; i < points_.size(); ++i) {
      std::size_t at = slot_of(points_[i]);
      while (slots_[at] != kFree) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = i;
    }
  }

  std::vector<vec3>& points_;
  std::vector<std::uint32_t> slots_;
  int shift_ = 0;
};

}  // namespace raylab
