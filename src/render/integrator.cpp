#include "raylab/render/integrator.hpp"

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

LightStatistics light_statistics(const Scene& scene, const SceneNeeds& needs) {
  const Lights lights(scene, needs);
  return {lights.count(), lights.bytes()};
}

}  // namespace raylab
