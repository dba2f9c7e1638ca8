#pragma once
#include <cstdint>
#include <vector>

namespace raylab {

/// The time that a render takes, by that of its tiles: they differ, and what is left may be all sky or all glass.
class TileWork {
 public:
  /// Samples to be taken of each tile, in the order in which tiles are rendered again and again.
  explicit TileWork(const std::vector<std::uint64_t>& samples = {}) { set_left(samples); }

  /// So many samples of each tile are yet to be taken, whatever was said before.
  void set_left(const std::vector<std::uint64_t>& samples);

  /// So many of a tile were taken, in so many seconds of one thread.
  void add(std::size_t tile, std::uint64_t taken, double seconds);

  /// What was spent of all seconds that the render will take, in [0, 1]; 0 before the first tile.
  double share() const;

 private:
  struct Tile {
    std::uint64_t left = 0;  ///< samples
    double seconds = 0.0;    ///< of a sample, the last time; 0: not known
  };
  std::vector<Tile> tiles_;
  double spent_ = 0.0;         ///< seconds of all threads
  double left_ = 0.0;          ///< the same that tiles of known seconds will take
  std::uint64_t unknown_ = 0;  ///< samples of the other tiles
  double recent_ = 0.0;        ///< seconds of a sample in tiles that were rendered last
};

}  // namespace raylab
