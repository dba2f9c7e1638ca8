#include "raylab/render/tile_work.hpp"

#include <algorithm>

namespace raylab {

TileWork::TileWork(const std::vector<std::uint64_t>& samples) {
  for (const std::uint64_t left : samples) {
    tiles_.push_back({left});
    unknown_ += left;
  }
}

void TileWork::add(std::size_t index, std::uint64_t taken, double seconds) {
  Tile& tile = tiles_[index];
  if (tile.seconds > 0.0) {
    left_ -= tile.seconds * static_cast<double>(tile.left);
  } else {
    unknown_ -= tile.left;
  }
  tile.left -= taken;
  tile.seconds = std::max(seconds, 1e-12) / static_cast<double>(taken);
  left_ += tile.seconds * static_cast<double>(tile.left);
  spent_ += std::max(seconds, 1e-12);
  // Tiles that are not known lie around those that were rendered last, and not around the middle of the picture.
  constexpr double kWeight = 1.0 / 32.0;
  recent_ = recent_ > 0.0 ? recent_ + kWeight * (tile.seconds - recent_) : tile.seconds;
}

double TileWork::share() const {
  const double left = std::max(left_, 0.0) + recent_ * static_cast<double>(unknown_);
  return spent_ > 0.0 ? spent_ / (spent_ + left) : 0.0;
}

}  // namespace raylab
