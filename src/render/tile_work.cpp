#include "raylab/render/tile_work.hpp"

#include <algorithm>

namespace raylab {

void TileWork::set_left(const std::vector<std::uint64_t>& samples) {
  tiles_.resize(samples.size());
  left_ = 0.0;
  unknown_ = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    tiles_[i].left = samples[i];
    if (tiles_[i].seconds > 0.0) {
      left_ += tiles_[i].seconds * static_cast<double>(samples[i]);
    } else {
      unknown_ += samples[i];
    }
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
