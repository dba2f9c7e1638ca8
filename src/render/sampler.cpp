#include "raylab/render/sampler.hpp"

#include <string>

#include "raylab/core/error.hpp"
#include "sampler_lanes.hpp"

namespace raylab {

SamplerKind parse_sampler(std::string_view name) {
  if (name == "independent") return SamplerKind::independent;
  if (name == "sobol") return SamplerKind::sobol;
  throw Error(ErrorKind::usage, "--sampler",
              "unknown sampler \"" + std::string(name) + "\"; expected independent or sobol");
}

std::string_view sampler_name(SamplerKind kind) { return kind == SamplerKind::independent ? "independent" : "sobol"; }

float Sampler::get1(std::uint32_t d) const {
  return BasicSampler<float>(kind_, pixel_.low, pixel_.high, sample_).get1(d);
}

vec2 Sampler::get2(std::uint32_t d) const {
  const Vec2<float> u = BasicSampler<float>(kind_, pixel_.low, pixel_.high, sample_).get2(d);
  return {u.x, u.y};
}

}  // namespace raylab
