#include "comparison.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdlib>
#include <optional>
#include <vector>

#include "raylab/core/parallel.hpp"

namespace raylab {

namespace {

enum class Verdict : std::uint8_t { same, last_bits, primitive, distance, presence, count };
constexpr std::uint32_t kSameDistanceUlp = 8;

// From harmless to harmful.
constexpr std::array<Rgb, static_cast<std::size_t>(Verdict::count)> kColors{
    Rgb(0.02f), Rgb(0.015f, 0.03f, 0.12f), Rgb(0.9f, 0.8f, 0.1f), Rgb(1.0f, 0.35f, 0.02f), Rgb(1.0f, 0.0f, 0.0f)};

Verdict judge(const std::optional<Hit>& a, const std::optional<Hit>& b) {
  if (a.has_value() != b.has_value()) return Verdict::presence;
  if (!a || *a == *b) return Verdict::same;
  // Positive floats are ordered as their bits are.
  const auto bits_a = std::bit_cast<std::int32_t>(a->t), bits_b = std::bit_cast<std::int32_t>(b->t);
  if (std::abs(static_cast<std::int64_t>(bits_a) - bits_b) > kSameDistanceUlp) return Verdict::distance;
  const bool same_primitive = a->geometry == b->geometry && a->primitive == b->primitive;
  return same_primitive ? Verdict::last_bits : Verdict::primitive;
}

/// How many pixels around its own a verdict is drawn over: of millions of rays a handful may go wrong.
constexpr std::array<int, kColors.size()> kReach{0, 0, 1, 2, 3};

Image picture_of(const std::vector<Verdict>& verdicts, int width, int height) {
  Image picture(width, height);
  const auto at = [&](int x, int y) { return verdicts[static_cast<std::size_t>(y) * width + x]; };
  // From harmless to harmful, so that the worst is on top.
  for (std::size_t v = 0; v < kColors.size(); ++v) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        if (at(x, y) != static_cast<Verdict>(v)) continue;
        for (int j = std::max(y - kReach[v], 0); j <= std::min(y + kReach[v], height - 1); ++j) {
          for (int i = std::max(x - kReach[v], 0); i <= std::min(x + kReach[v], width - 1); ++i) {
            picture.at(i, j) = kColors[v];
          }
        }
      }
    }
  }
  return picture;
}

}  // namespace

std::string RayComparison::text() const {
  const auto part = [](std::uint64_t count, const char* what) { return std::to_string(count) + " " + what; };
  return "of " + std::to_string(rays) + " camera rays:\n" + part(presence, "hit or miss (large red), ") +
         part(distance, "distance (orange),\n") + part(primitive, "primitive (yellow), ") +
         part(last_bits, "last bits (dim blue)");
}

RayComparison compare_rays(const Accelerator& a, const Accelerator& b, const CameraSettings& settings, int width,
                           int height) {
  const Camera camera(settings, width, height);
  RayComparison result;
  result.rays = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  std::vector<Verdict> verdicts(result.rays);
  std::array<std::atomic<std::uint64_t>, kColors.size()> counts{};
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    std::array<std::uint64_t, kColors.size()> row{};
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, vec2(0.5f));
      const Verdict verdict = judge(a.intersect(ray), b.intersect(ray));
      ++row[static_cast<std::size_t>(verdict)];
      verdicts[y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = verdict;
    }
    for (std::size_t i = 0; i < row.size(); ++i) counts[i] += row[i];
  });
  const auto count = [&](Verdict v) { return counts[static_cast<std::size_t>(v)].load(); };
  result.presence = count(Verdict::presence);
  result.distance = count(Verdict::distance);
  result.primitive = count(Verdict::primitive);
  result.last_bits = count(Verdict::last_bits);
  result.picture = picture_of(verdicts, width, height);
  return result;
}

}  // namespace raylab
