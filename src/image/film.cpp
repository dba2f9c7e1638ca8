#include "raylab/image/film.hpp"

#include <limits>

#include "raylab/core/check.hpp"

namespace raylab {

namespace {

std::size_t pixel_count(int width, int height) {
  RAYLAB_CHECK(width > 0 && height > 0);
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// Adds numbers that are not negative, and their squares. Squared in double: the variance of equal samples must not
/// drown in the rounding of their squares.
void add_numbers(const float* numbers, std::size_t count, ExactSum& sum, ExactSum& squares) {
  constexpr float kRootOfSmall = 16.0f;
  static_assert(kRootOfSmall * kRootOfSmall <= ExactSum::kSmall);
  int large = 0;
  for (std::size_t i = 0; i < count; ++i) large |= static_cast<int>(!(numbers[i] < kRootOfSmall));
  ExactSum all = sum, all_squares = squares;
  if (large == 0) {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = numbers[i];
      all.add_small(x);
      all_squares.add_small(x * x);
    }
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = numbers[i];
      all.add(x);
      all_squares.add(x * x);
    }
  }
  sum = all;
  squares = all_squares;
}

}  // namespace

Film::Film(int width, int height)
    : width_(width), height_(height), sums_(pixel_count(width, height)), samples_(sums_.size()) {}

void Film::add(int x, int y, const std::array<const float*, 3>& radiance, std::size_t count) {
  const std::size_t i = index(x, y);
  for (std::size_t c = 0; c < 3; ++c) add_numbers(radiance[c], count, sums_[i].rgb[c], sums_[i].squares[c]);
  samples_[i] += static_cast<std::uint32_t>(count);
}

Rgb Film::mean(int x, int y) const {
  const std::size_t i = index(x, y);
  return samples_[i] == 0 ? Rgb(0.0f) : Rgb(mean(i));
}

dvec3 Film::mean(std::size_t pixel) const {
  const ExactSum* sum = sums_[pixel].rgb;
  return dvec3(sum[0].value(), sum[1].value(), sum[2].value()) / static_cast<double>(samples_[pixel]);
}

dvec3 Film::variance_of_mean(std::size_t pixel) const {
  return samples_[pixel] < 2 ? dvec3(0.0) : variance_of_mean(pixel, mean(pixel));
}

dvec3 Film::variance_of_mean(std::size_t pixel, const dvec3& m) const {
  const double n = samples_[pixel];
  const ExactSum* squares = sums_[pixel].squares;
  const dvec3 squared_deviations = dvec3(squares[0].value(), squares[1].value(), squares[2].value()) - n * m * m;
  return glm::max(squared_deviations, dvec3(0.0)) / (n - 1.0) / n;
}

double Film::estimated_relmse() const {
  double total = 0.0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (samples_[i] < 2) continue;
    const dvec3 m = mean(i);
    const dvec3 relative = variance_of_mean(i, m) / (m * m + 0.01);
    total += (relative.x + relative.y + relative.z) / 3.0;
    ++pixels;
  }
  return pixels == 0 ? std::numeric_limits<double>::infinity() : total / static_cast<double>(pixels);
}

Image Film::image() const {
  Image picture(width_, height_);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) picture.at(x, y) = mean(x, y);
  }
  return picture;
}

Film Film::rows(int first, int count) const {
  RAYLAB_CHECK(first >= 0 && count > 0 && count <= height_ - first);
  Film part(width_, count);
  const auto from = static_cast<std::ptrdiff_t>(index(0, first));
  const auto to = from + static_cast<std::ptrdiff_t>(part.sums_.size());
  std::copy(sums_.begin() + from, sums_.begin() + to, part.sums_.begin());
  std::copy(samples_.begin() + from, samples_.begin() + to, part.samples_.begin());
  return part;
}

void Film::add(const Film& other, int x, int y) {
  RAYLAB_CHECK(x >= 0 && y >= 0 && other.width_ <= width_ - x && other.height_ <= height_ - y);
  for (int row = 0; row < other.height_; ++row) {
    for (int column = 0; column < other.width_; ++column) {
      const std::size_t from = other.index(column, row);
      const std::size_t to = index(x + column, y + row);
      for (int c = 0; c < 3; ++c) {
        sums_[to].rgb[c].add(other.sums_[from].rgb[c]);
        sums_[to].squares[c].add(other.sums_[from].squares[c]);
      }
      samples_[to] += other.samples_[from];
    }
  }
}

void Film::clear() {
  std::fill(sums_.begin(), sums_.end(), PixelSum{});
  std::fill(samples_.begin(), samples_.end(), 0u);
}

}  // namespace raylab
