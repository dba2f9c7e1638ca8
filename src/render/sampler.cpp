#include "raylab/render/sampler.hpp"

#include <string>

#include "raylab/core/error.hpp"

namespace raylab {

SamplerKind parse_sampler(std::string_view name) {
  if (name == "independent") return SamplerKind::independent;
  if (name == "sobol") return SamplerKind::sobol;
  throw Error(ErrorKind::usage, "--sampler",
              "unknown sampler \"" + std::string(name) + "\"; expected independent or sobol");
}

std::string_view sampler_name(SamplerKind kind) {
  return kind == SamplerKind::independent ? "independent" : "sobol";
}

}  // namespace raylab
