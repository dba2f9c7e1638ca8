#include "raylab/measure/agreement_cases.hpp"

#include <cmath>

#include "raylab/measure/ray_sets.hpp"
#include "raylab/measure/shapes.hpp"

namespace raylab {

namespace {

constexpr std::size_t kRays = 10'000;

/// A tenth of the triangles spoilt, each in its own way, and a few collapsed to a line or a point.
TriangleMesh spoilt(TriangleMesh mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 10) {
    uvec3& corners = mesh.triangles[i];
    vec3& p = mesh.positions[corners.x];
    switch (i / 10 % 6) {
      case 0:
        p.x = std::nanf("");
        break;
      case 1:
        p.y = kInfinity;
        break;
      case 2:
        p.z = -3e18f;
        break;
      case 3:
        corners.y = static_cast<std::uint32_t>(mesh.positions.size());
        break;
      case 4:
        corners.z = corners.x;
        break;
      case 5:
        corners = uvec3(corners.x);
        break;
    }
  }
  return mesh;
}

/// Walls, floors and sheets along the axes, whose boxes are flat.
TriangleMesh flat_boxes(std::uint64_t seed) {
  UniformFloats uniform(seed);
  TriangleMesh all;
  for (int i = 0; i < 60; ++i) {
    const vec3 at = uniform.in_box(vec3(-1.0f), vec3(1.0f));
    const TriangleMesh box = box_mesh(at, at + uniform.in_box(vec3(0.05f), vec3(0.5f)));
    const auto first = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), box.positions.begin(), box.positions.end());
    for (const uvec3& corners : box.triangles) all.triangles.push_back(corners + first);
  }
  return all;
}

/// Every second ray gets an interval of its own, which may end before the surfaces that it was aimed at, begin behind
/// them, or lie between.
void give_intervals(std::vector<Ray>& rays, std::uint64_t seed) {
  UniformFloats uniform(seed);
  for (std::size_t i = 0; i < rays.size(); i += 2) {
    const float from = uniform(0.0f, 2.0f), to = uniform(0.0f, 2.0f);
    if (i % 3 != 1) rays[i].t_min = from;
    if (i % 3 != 2) rays[i].t_max = i % 3 == 0 ? from + to : to;
  }
}

}  // namespace

std::vector<AgreementCase> agreement_cases(std::uint64_t seed) {
  std::vector<AgreementCase> cases;
  const auto add = [&](std::string name, Geometry geometry) {
    Bounds bounds = geometry.bounds();
    if (bounds.empty()) bounds = {vec3(-1.0f), vec3(1.0f)};
    std::vector<Ray> rays = random_rays(bounds, kRays, seed + cases.size());
    give_intervals(rays, seed + cases.size());
    cases.push_back({std::move(name), std::move(geometry), std::move(rays)});
  };
  const TriangleMesh soup = triangle_soup(500, 1.0f, 0.4f, seed);
  std::vector<Sphere> spheres = sphere_soup(200, 1.0f, 0.2f, seed);
  const TriangleMesh ball = icosphere(vec3(0.2f, -0.1f, 0.3f), 1.0f, 3);

  add("nothing", {});
  add("one triangle", {{triangle_soup(1, 0.1f, 1.0f, seed)}, {}});
  add("one sphere", {{}, {{{0.1f, 0.2f, 0.3f}, 1.0f}}});
  add("triangles", {{soup}, {}});
  add("closed mesh", {{ball}, {}});
  add("spheres", {{}, spheres});
  add("meshes and spheres", {{TriangleMesh{}, soup, ball}, spheres});
  add("flat boxes", {{flat_boxes(seed)}, {}});

  TriangleMesh copies = triangle_soup(1, 0.1f, 1.0f, seed);
  copies.triangles.resize(300, copies.triangles[0]);
  add("300 copies of one triangle", {{copies}, {}});

  spheres[1].radius = 0.0f;
  spheres[2].radius = -1.0f;
  spheres[3].center.y = std::nanf("");
  spheres[4].radius = kInfinity;
  add("with invalid and degenerate primitives", {{soup, spoilt(soup)}, spheres});
  add("invalid primitives alone", {{TriangleMesh{{{0, 0, 0}}, {{0, 1, 2}}, {}, {}, {}, {}}}, {{vec3(0.0f), -1.0f}}});
  return cases;
}

bool passes_agreement(const AcceleratorEntry& entry, const AcceleratorOptions& options, std::uint64_t seed,
                      const std::function<void(const AgreementCase&, const AgreementReport&)>& tell) {
  check_options(entry, options);
  bool all = true;
  for (const AgreementCase& c : agreement_cases(seed)) {
    const auto judge = make_accelerator("list", c.geometry);
    const auto tested = entry.make(c.geometry, options);
    AgreementReport report = compare_hits(*tested, *judge, c.geometry, c.rays);
    if (entry.capabilities.batch_equals_single) report.batches = different_batches(*tested, c.rays);
    tell(c, report);
    const BuildReport& built = tested->build_report();
    all = all && report.agrees() && built.primitives == judge->build_report().primitives &&
          built.invalid_primitives == judge->build_report().invalid_primitives;
  }
  return all;
}

bool passes_agreement(std::string_view name, const AcceleratorOptions& options, std::uint64_t seed,
                      const std::function<void(const AgreementCase&, const AgreementReport&)>& tell) {
  return passes_agreement(find_accelerator(name), options, seed, tell);
}

}  // namespace raylab
