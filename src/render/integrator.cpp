#include "raylab/render/integrator.hpp"

#include <algorithm>
#include <string>

#include "raylab/core/error.hpp"
#include "reference_integrator.hpp"

namespace raylab {

IntegratorKind parse_integrator(std::string_view name) {
  if (name == "path") return IntegratorKind::path;
  if (name == "book") return IntegratorKind::book;
  if (name == "reference") return IntegratorKind::reference;
  throw Error(ErrorKind::usage, "--integrator",
              "unknown integrator \"" + std::string(name) + "\"; expected path, book or reference");
}

std::string_view integrator_name(IntegratorKind kind) {
  switch (kind) {
    case IntegratorKind::path:
      return "path";
    case IntegratorKind::book:
      return "book";
    case IntegratorKind::reference:
      break;
  }
  return "reference";
}

Strategies parse_strategies(std::string_view names) {
  if (names == "auto") return {};
  Strategies found{false, false, false};
  bool bsdf = false;
  for (std::string_view left = names; !left.empty();) {
    const std::string_view name = left.substr(0, left.find(','));
    left.remove_prefix(std::min(left.size(), name.size() + 1));
    if (name == "bsdf") {
      bsdf = true;
    } else if (name == "light") {
      found.light = true;
    } else if (name == "mirror") {
      found.mirror = true;
    } else if (name == "sphere") {
      found.sphere = true;
    } else {
      throw Error(
          ErrorKind::usage, "--strategies",
          "unknown strategy \"" + std::string(name) + "\"; expected auto, or of bsdf, light, mirror and sphere");
    }
  }
  if (!bsdf || ((found.mirror || found.sphere) && !found.light)) {
    throw Error(ErrorKind::usage, "--strategies",
                "found " + std::string(names) +
                    ", expected bsdf, then light, then mirror or sphere: each needs those before it");
  }
  return found;
}

namespace {

TraceKernel kernel_of([[maybe_unused]] Isa isa) {
#if defined(__x86_64__)
  if (isa == Isa::avx512) return kTraceAvx512;
  if (isa == Isa::avx2) return kTraceAvx2;
  return kTraceSse42;
#else
  return kTraceNeon;
#endif
}

}  // namespace

Integrator::Integrator(const Scene& scene, const Camera& camera, const Accelerator& accelerator,
                       const SceneNeeds& needs, const IntegratorSettings& settings)
    : shading_(std::make_unique<ShadingScene>(scene, camera, accelerator, needs, settings)),
      kernel_(kernel_of(choose_isa(settings.isa))) {}

Integrator::~Integrator() = default;

void Integrator::trace(const PathBatch& paths, BatchRadiance& radiance, RayCounts& counts) const {
  if (shading_->settings.kind == IntegratorKind::reference) {
    ReferenceIntegrator(*shading_).trace(paths, radiance, counts);
  } else {
    kernel_(*shading_, paths, radiance, counts);
  }
}

LightStatistics Integrator::lights() const { return {shading_->lights.count(), shading_->lights.bytes()}; }

std::size_t Integrator::mirror_chains() const { return shading_->mirrors.count(); }
std::size_t Integrator::sphere_chains() const { return shading_->spheres.count(); }

LightStatistics light_statistics(const Scene& scene, const SceneNeeds& needs) {
  const Lights lights(scene, needs);
  return {lights.count(), lights.bytes()};
}

}  // namespace raylab
