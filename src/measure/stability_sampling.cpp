// Random numbers and what is made of them: extremes, counts, ranges, skies, error estimates.
#include <algorithm>
#include <limits>

#include "raylab/render/sampler.hpp"
#include "stability_cases.hpp"

namespace raylab {

namespace {

using namespace made;

bool is_unit(const vec3& v) { return is_finite(v) && std::abs(glm::length(v) - 1.0f) < 1e-5f; }

/// Numbers at the end of what a random source gives, through what public code samples with them.
StabilityTrial extremes(double below_one, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod&) {
    const float extreme = below_one > 0.0 ? static_cast<float>(1.0 - below_one) : 0.0f;
    Scene bright, even;
    set_sky(bright, 16, 8, [](int x, int y) { return Rgb(x == 3 && y == 2 ? 1e4f : 0.0f); });
    set_sky(even, Rgb(1.0f));
    const EnvironmentSampler skies[] = {EnvironmentSampler(bright.environment), EnvironmentSampler(even.environment)};
    CameraSettings settings;
    settings.defocus_angle = 5.0f;
    const Camera camera(settings, 64, 48);
    UniformFloats uniform(seed);
    StabilityCount found;
    while (found.trials < count) {
      const float other = uniform();
      for (const vec2& u : {vec2(extreme, other), vec2(other, extreme), vec2(extreme)}) {
        for (const EnvironmentSampler& sky : skies) {
          const auto sample = sky.sample(u);
          const bool none = sample.pdf == 0.0f;  // rounding has put it beside the texel, which is said
          found.failures += !is_unit(sample.direction) || !(sample.pdf >= 0.0f) || !(sample.pdf < kInfinity) ||
                            (!none && !(sky.pdf(sample.direction) > 0.0f));
        }
        const Ray ray = camera.ray(u.x * 64.0f, u.y * 48.0f, u);
        found.failures += !is_finite(ray.origin) || !is_finite(ray.direction);
        found.trials += 3;
      }
    }
    return found;
  };
}

/// A sky that is black but for one texel, at the pole or the seam: every sample finds it.
StabilityTrial one_texel(double height, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod&) {
    const int h = static_cast<int>(height), w = 2 * h;
    UniformFloats uniform(seed);
    StabilityCount found;
    for (const glm::ivec2& sun : {glm::ivec2(0, 0), glm::ivec2(w - 1, h / 2), glm::ivec2(w / 2, h - 1)}) {
      Scene scene;
      set_sky(scene, w, h, [&](int x, int y) { return Rgb(glm::ivec2(x, y) == sun ? 1e6f : 0.0f); });
      const EnvironmentSampler sampler(scene.environment);
      std::size_t lost = 0;
      for (std::size_t i = 0; i < count / 3; ++i) {
        const float u = uniform();
        const auto sample = sampler.sample({u, uniform()});
        ++found.trials;
        lost += !(sample.pdf > 0.0f);
        found.failures += !is_unit(sample.direction) || !(sample.pdf >= 0.0f && sample.pdf < kInfinity) ||
                          (sample.pdf > 0.0f && !(std::abs(sampler.pdf(sample.direction) / sample.pdf - 1.0f) < 1e-3f));
      }
      // What rounding moves out of the texel is said; more than one in a hundred would be a bias.
      if (100 * lost > count / 3) found.failures += lost;
    }
    return found;
  };
}

/// Means of so many numbers in each of 24 dimensions, some beyond 1,024.
StabilityTrial sample_counts(double samples, std::size_t, std::uint64_t seed) {
  return [=](const StabilityMethod&) {
    const auto n = static_cast<std::uint32_t>(samples);
    StabilityCount found;
    for (const SamplerKind kind : {SamplerKind::independent, SamplerKind::sobol}) {
      for (const std::uint32_t first : {0u, 1020u, 100000u}) {
        for (std::uint32_t d = first; d < first + 8; ++d) {
          double sum = 0.0, sum_y = 0.0;
          bool inside = true;
          for (std::uint32_t i = 0; i < n; ++i) {
            const vec2 u = Sampler(kind, static_cast<std::uint32_t>(seed), d, 7, i).get2(d);
            sum += static_cast<double>(u.x);
            sum_y += static_cast<double>(u.y);
            inside = inside && u.x >= 0.0f && u.x < 1.0f && u.y >= 0.0f && u.y < 1.0f;
          }
          const double limit = 4.5 / std::sqrt(12.0 * samples);
          found.failures += !inside || std::abs(sum / samples - 0.5) > limit || std::abs(sum_y / samples - 0.5) > limit;
          ++found.trials;
        }
      }
    }
    return found;
  };
}

/// The samples of a pixel taken in so many ranges and joined, against all at once.
StabilityTrial joined(double parts, std::size_t count, std::uint64_t seed) {
  return [=](const StabilityMethod& method) {
    const SeenScene scene = lit_room();
    RenderOptions options = stability_render_options(method, count, 16, seed);
    options.samples_per_pixel = 17;
    const Film all = stability_render(scene, options, method);
    Film sum(all.width(), all.height());
    const auto n = static_cast<std::uint32_t>(parts);
    for (std::uint32_t part = 0; part < n; ++part) {
      options.first_sample = 17 * part / n;
      options.samples_per_pixel = 17 * (part + 1) / n - options.first_sample;
      sum.add(stability_render(scene, options, method));
    }
    return StabilityCount{static_cast<std::size_t>(different_pixels(all, sum)),
                          static_cast<std::size_t>(all.width()) * static_cast<std::size_t>(all.height())};
  };
}

/// 95% intervals from the variance of a pixel's own samples: a picture of 4,096 pixels fails whose intervals hold the
/// true value in less than 93% or more than 97%.
StabilityTrial error_estimate(double samples, std::size_t, std::uint64_t seed) {
  return [=](const StabilityMethod& method) {
    const LampOverFloor lamp = lamp_over_floor();
    constexpr std::size_t kPixels = 4096;
    const auto n = static_cast<std::uint32_t>(samples);
    StabilityCount found;
    for (std::uint64_t picture = 0; picture < 2; ++picture) {
      RenderOptions options = stability_render_options(method, kPixels * n, n, seed + picture, 2);
      options.sampler = SamplerKind::independent;
      const Film film = stability_render(lamp.scene, options, method);
      int held = 0;
      for (int y = 0; y < film.height(); ++y) {
        for (int x = 0; x < film.width(); ++x) {
          const double error = std::abs(static_cast<double>(film.mean(x, y).g) - lamp.expected);
          held += error <= 1.959964 * std::sqrt(film.variance_of_mean(x, y).g);
        }
      }
      const double share = held / static_cast<double>(kPixels);
      ++found.trials;
      found.failures += share < 0.93 || share > 0.97;
    }
    return found;
  };
}

}  // namespace

std::vector<StabilityCase> stability_sampling_cases() {
  using enum StabilityMethods;
  return {
      {28, "extremes", "The smallest and largest random numbers, through skies and lenses",
       "no finite number, or no unit vector", "1 - u, where 0 stands for u = 0", ours, values(0, 0x1p-24, 1e-6, 1e-3),
       0, 1e-3, "", extremes},
      {51, "one-texel-sky", "A sky with one bright texel, at the poles and the seam",
       "a density that is not that of the direction, or one sample in a hundred lost", "height of the picture", ours,
       values(1, 2, 8, 64, 512), 1, 512, "", one_texel},
      // The variance of few samples is itself not known well enough.
      {60, "error-estimate", "95% intervals from a pixel's own samples, against the true value",
       "a picture with less than 93% or more than 97% held", "samples a pixel", paths, values(4, 16, 64, 256), 64, 256,
       "", error_estimate},
      {61, "sample-counts", "Means of random numbers, in dimensions to 100,000", "off by 4.5 standard errors",
       "number of samples", ours, values(1, 3, 7, 100, 1000, 65537, 1e6), 1, 1e6, "", sample_counts},
      {62, "joined-ranges", "Ranges of samples rendered apart and joined", "a pixel of other bits", "ranges", renders,
       values(1, 2, 3, 5, 17), 1, 17, "", joined},
  };
}

}  // namespace raylab
