#include "raylab/render/integrator.hpp"

#include <string>

#include "raylab/core/error.hpp"
#include "shading_scene.hpp"

namespace raylab {

IntegratorKind parse_integrator(std::string_view name) {
  if (name == "path") return IntegratorKind::path;
  if (name == "book") return IntegratorKind::book;
  throw Error(ErrorKind::usage, "--integrator",
              "unknown integrator \"" + std::string(name) + "\"; expected path or book");
}

std::string_view integrator_name(IntegratorKind kind) { return kind == IntegratorKind::path ? "path" : "book"; }

namespace {

TraceKernel kernel_of(Isa isa) {
  switch (isa) {
    case Isa::avx512:
      return kTraceAvx512;
    case Isa::avx2:
      return kTraceAvx2;
    case Isa::sse42:
      break;
  }
  return kTraceSse42;
}

}  // namespace

Integrator::Integrator(const Scene& scene, const Camera& camera, const Accelerator& accelerator,
                       const SceneNeeds& needs, const IntegratorSettings& settings)
    : shading_(std::make_unique<ShadingScene>(scene, camera, accelerator, needs, settings)),
      kernel_(kernel_of(choose_isa(settings.isa))) {}

Integrator::~Integrator() = default;

void Integrator::trace(const PathBatch& paths, BatchRadiance& radiance, RayCounts& counts) const {
  kernel_(*shading_, paths, radiance, counts);
}

const Lights& Integrator::lights() const { return shading_->lights; }

}  // namespace raylab
