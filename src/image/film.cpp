#include "raylab/image/film.hpp"

#include <limits>

#include "raylab/core/check.hpp"

namespace raylab {

namespace {

std::size_t pixel_count(int width, int height) {
  RAYLAB_CHECK(width > 0 && height > 0);
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// Below this, numbers and their squares are cut to integers of 64 bits at once, which is nearly always.
constexpr float kRootOfSmall = 16.0f;
static_assert(kRootOfSmall * kRootOfSmall <= ExactSum::kSmall);

bool all_small(const float* numbers, std::size_t count) {
  int large = 0;
  for (std::size_t i = 0; i < count; ++i) large |= static_cast<int>(!(numbers[i] < kRootOfSmall));
  return large == 0;
}

void add_numbers(const float* numbers, std::size_t count, ExactSum& sum) {
  ExactSum all = sum;
  if (all_small(numbers, count)) {
    for (std::size_t i = 0; i < count; ++i) all.add_small(numbers[i]);
  } else {
    for (std::size_t i = 0; i < count; ++i) all.add(numbers[i]);
  }
  sum = all;
}

}  // namespace

/// Squared in double: the variance of equal samples must not drown in the rounding of their squares.
void SquareSum::add(const float* numbers, std::size_t count) {
  constexpr double kScale = static_cast<double>(std::int64_t{1} << kFractionBits);
  constexpr double kMost = 0x1p96;  // of one square: more than the sum holds, and 2^32 of them fit 128 bits
  unsigned __int128 sum = bits();
  if (all_small(numbers, count)) {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = numbers[i];
      sum += static_cast<std::uint64_t>(static_cast<std::int64_t>(x * x * kScale));
    }
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      const double x = numbers[i];
      sum += static_cast<unsigned __int128>(std::min(x * x * kScale, kMost));
    }
  }
  set(sum);
}

Film::Film(int width, int height)
    : width_(width),
      height_(height),
      sums_(pixel_count(width, height)),
      squares_(sums_.size()),
      kept_(sums_.size()),
      taken_(sums_.size()) {}

void Film::add(int x, int y, const std::array<const float*, 3>& radiance, std::size_t count) {
  const std::size_t i = index(x, y);
  for (std::size_t c = 0; c < 3; ++c) {
    add_numbers(radiance[c], count, sums_[i][c]);
    squares_[i][c].add(radiance[c], count);
  }
  kept_[i] += static_cast<std::uint32_t>(count);
  taken_[i] += static_cast<std::uint32_t>(count);
}

Rgb Film::mean(int x, int y) const {
  const std::size_t i = index(x, y);
  return kept_[i] == 0 ? Rgb(0.0f) : Rgb(mean(i));
}

dvec3 Film::mean(std::size_t pixel) const {
  const auto& sum = sums_[pixel];
  return dvec3(sum[0].value(), sum[1].value(), sum[2].value()) / static_cast<double>(kept_[pixel]);
}

dvec3 Film::variance_of_mean(std::size_t pixel) const {
  return kept_[pixel] < 2 ? dvec3(0.0) : variance_of_mean(pixel, mean(pixel));
}

dvec3 Film::variance_of_mean(std::size_t pixel, const dvec3& m) const {
  const double n = kept_[pixel];
  const auto& squares = squares_[pixel];
  const dvec3 squared_deviations = dvec3(squares[0].value(), squares[1].value(), squares[2].value()) - n * m * m;
  return glm::max(squared_deviations, dvec3(0.0)) / (n - 1.0) / n;
}

double Film::estimated_relmse() const {
  double total = 0.0;
  std::size_t pixels = 0;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (kept_[i] < 2) continue;
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
  const auto copy = [&](const auto& from, auto& to) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(index(0, first)), to.size(), to.begin());
  };
  copy(sums_, part.sums_);
  copy(squares_, part.squares_);
  copy(kept_, part.kept_);
  copy(taken_, part.taken_);
  return part;
}

void Film::add(const Film& other, int x, int y) {
  RAYLAB_CHECK(x >= 0 && y >= 0 && other.width_ <= width_ - x && other.height_ <= height_ - y);
  for (int row = 0; row < other.height_; ++row) {
    for (int column = 0; column < other.width_; ++column) {
      const std::size_t from = other.index(column, row);
      const std::size_t to = index(x + column, y + row);
      for (std::size_t c = 0; c < 3; ++c) {
        sums_[to][c].add(other.sums_[from][c]);
        squares_[to][c].add(other.squares_[from][c]);
      }
      kept_[to] += other.kept_[from];
      taken_[to] += other.taken_[from];
    }
  }
}

void Film::clear() { *this = Film(width_, height_); }

void Film::row_words(int y, std::uint32_t* words) const {
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t x = 0; x < width; ++x) {
    const std::size_t pixel = index(0, y) + x;
    std::uint32_t* word = words + x;
    const auto put = [&](unsigned __int128 bits, int count) {
      for (int i = 0; i < count; ++i, word += width) *word = static_cast<std::uint32_t>(bits >> (32 * i));
    };
    put(kept_[pixel], 1);
    for (std::size_t c = 3; c-- > 0;) put(squares_[pixel][c].bits(), 3);
    for (std::size_t c = 3; c-- > 0;) put(sums_[pixel][c].bits(), 4);
    put(taken_[pixel], 1);
  }
}

void Film::add_row_words(int y, const std::uint32_t* words) {
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t x = 0; x < width; ++x) {
    const std::size_t pixel = index(0, y) + x;
    const std::uint32_t* word = words + x;
    const auto take = [&](int count) {
      unsigned __int128 bits = 0;
      for (int i = 0; i < count; ++i, word += width) bits |= static_cast<unsigned __int128>(*word) << (32 * i);
      return bits;
    };
    kept_[pixel] += static_cast<std::uint32_t>(take(1));
    for (std::size_t c = 3; c-- > 0;) {
      SquareSum squares;
      squares.set(take(3));
      squares_[pixel][c].add(squares);
    }
    for (std::size_t c = 3; c-- > 0;) sums_[pixel][c].add(ExactSum::from_bits(take(4)));
    taken_[pixel] += static_cast<std::uint32_t>(take(1));
  }
}

}  // namespace raylab
