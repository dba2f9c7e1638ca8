#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "raylab/image/film.hpp"
#include "raylab/render/pixel_rect.hpp"

namespace raylab {

/// How many samples each pixel of a picture is to have, so that its relMSE falls fastest: more where the variance of
/// samples over radiance^2 + 0.01 is large, by its square root.
///
/// Without bias, which sampling has that stops where a pixel's own samples happen to look calm (Kirk and Arvo 1991,
/// "Unbiased sampling techniques for image synthesis"): they throw the samples away that decided. Here pixels are of
/// two colours, as on a chessboard, and the number of samples of a pixel follows from the first kPilot samples of
/// pixels of the other colour alone, its neighbours. It does not depend on the pixel's own samples, all of which enter
/// the mean.
class SampleMap {
 public:
  static constexpr std::uint32_t kPilot = 16;  ///< samples that each pixel has, and that decide
  static constexpr std::uint32_t kMost = 10;   ///< times the mean, more than which no pixel has; nor below a quarter
  static constexpr std::size_t kBytes = 6;     ///< a pixel, while it is made

  /// Of a film that has the first kPilot samples of all pixels of a region.
  SampleMap(const Film& pilot, const PixelRect& region);

  /// Samples of each pixel where so many are wanted in the mean, which are never fewer where more are wanted.
  struct Counts {
    std::array<std::vector<std::uint32_t>, 2> of;  ///< by the pixel's colour and class
    std::uint64_t total = 0;                       ///< up to the mean times the pixels, and little less
  };
  Counts counts(std::uint32_t mean) const;

  std::uint32_t samples(const Counts& counts, int x, int y) const {
    return counts.of[color(x, y)][classes_[index(x, y)]];
  }

 private:
  static std::size_t color(int x, int y) { return static_cast<std::size_t>((x + y) & 1); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - region_.y) * static_cast<std::size_t>(region_.width) +
           static_cast<std::size_t>(x - region_.x);
  }

  PixelRect region_;
  std::vector<std::uint16_t> classes_;  ///< of pixels, by the deviation of their neighbours' samples
  struct Class {
    std::uint64_t pixels = 0;
    std::uint64_t share = 0;  ///< of the mean number of samples, in units of kUnit
  };
  std::array<std::vector<Class>, 2> shares_;  ///< by colour and class
};

}  // namespace raylab
