#include <algorithm>
#include <functional>
#include <vector>

#include "catch.hpp"
#include "raylab/scene/needs.hpp"
#include "test_scenes.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

Texture any_picture(Scene& scene) {
  return picture(scene, 4, 4, [](int x, int y) { return (x + y) % 2 == 0 ? Rgb(0.2f, 0.5f, 0.8f) : Rgb(0.7f); });
}

void add_floor(Scene& scene, const Material& material) { add_quad(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, material); }

/// One need, and the least scene that has it and no other, but for specular spheres spheres and a light.
struct Case {
  const char* name;
  bool SceneNeeds::*need;
  std::function<void(Scene&)> add;
};

const std::vector<Case>& cases() {
  using N = SceneNeeds;
  static const std::vector<Case> all = {
      {"spheres", &N::spheres, [](Scene& s) { add_sphere(s, vec3(0), 1, lambertian(grey(0.5f))); }},
      {"shading normals", &N::shading_normals, [](Scene& s) { add_smooth_sphere(s, vec3(0), 1, 4, glass()); }},
      {"area lights", &N::area_lights, [](Scene& s) { add_floor(s, light(grey(1))); }},
      {"background sampling", &N::environment_sampling,
       [](Scene& s) { set_sky(s, 2, 1, [](int x, int) { return Rgb(static_cast<float>(x)); }); }},
      {"specular spheres", &N::specular_spheres,
       [](Scene& s) {
         add_sphere(s, vec3(0), 1, glass());
         add_floor(s, light(grey(1)));
       }},
      {"plane mirrors", &N::plane_mirrors, [](Scene& s) { add_floor(s, metal(grey(0.9f), 0.0f)); }},
  };
  return all;
}

}  // namespace

TEST_CASE("an empty scene needs nothing", "[unit][needs]") {
  CHECK(scene_needs(Scene()) == SceneNeeds());
  Scene no_materials;
  no_materials.geometry.meshes.emplace_back();
  no_materials.mesh_materials.emplace_back();
  CHECK(scene_needs(no_materials) == SceneNeeds());
  // Materials that nothing has, a black picture as sky, and an empty mesh count for nothing either.
  Scene scene;
  scene.materials = {light(grey(1.0f)), metal(any_picture(scene), 0.5f)};
  set_sky(scene, 2, 2, [](int, int) { return Rgb(0.0f); });
  scene.geometry.meshes.emplace_back();
  scene.mesh_materials.emplace_back();
  scene.mesh_names.emplace_back();
  CHECK(scene_needs(scene) == SceneNeeds());
  // What every code path handles needs none of its own.
  set_sky(scene, Rgb(0.0f), Rgb(1.0f));
  add_floor(scene, lambertian(any_picture(scene)));
  add_floor(scene, metal(checker(1, Rgb(0), Rgb(1)), 0.5f));
  CHECK(scene_needs(scene) == SceneNeeds());
}

TEST_CASE("each need is there when, and only when, the scene has what asks for it", "[unit][needs]") {
  for (const Case& c : cases()) {
    Scene scene;
    c.add(scene);
    SceneNeeds expected;
    expected.*c.need = true;
    expected.spheres |= expected.specular_spheres;
    expected.area_lights |= expected.specular_spheres;
    INFO(c.name);
    CHECK(scene_needs(scene) == expected);
  }
  Scene everything;
  for (const Case& c : cases()) c.add(everything);
  CHECK(scene_needs(everything) == all_needs());
}

TEST_CASE("needs are told one a line, each by name and with yes or no", "[unit][needs]") {
  const auto none = describe(SceneNeeds());
  const auto all = describe(all_needs());
  REQUIRE(none.size() == cases().size());
  REQUIRE(all.size() == cases().size());
  for (std::size_t i = 0; i < cases().size(); ++i) {
    SceneNeeds one;
    one.*cases()[i].need = true;
    const auto lines = describe(one);
    INFO(cases()[i].name);
    CHECK(std::count_if(lines.begin(), lines.end(), [](const auto& l) { return l.find("yes") != l.npos; }) == 1);
    CHECK(std::count_if(lines.begin(), lines.end(), [&](const auto& l) {
            return l.find("yes") != l.npos && l.find(cases()[i].name) != l.npos;
          }) == 1);
    CHECK(none[i].find("no") != std::string::npos);
    CHECK(all[i].find("yes") != std::string::npos);
  }
}

TEST_CASE("materials of single triangles count like those of whole meshes", "[unit][needs]") {
  Scene scene;
  add_floor(scene, lambertian(grey(0.5f)));
  scene.materials.push_back(light(grey(1.0f)));
  scene.mesh_materials[0].per_triangle = {0, 0};
  CHECK_FALSE(scene_needs(scene).area_lights);
  scene.mesh_materials[0].per_triangle = {0, 1};
  CHECK(scene_needs(scene).area_lights);
}

TEST_CASE("a sphere that emits is an area light", "[unit][needs]") {
  Scene scene;
  add_sphere(scene, vec3(0), 1.0f, light(grey(1.0f)));
  CHECK(scene_needs(scene).area_lights);
}

TEST_CASE("texture coordinates are kept where a picture is looked up and freed elsewhere", "[unit][needs]") {
  Scene scene;
  add_floor(scene, lambertian(any_picture(scene)));
  add_floor(scene, lambertian(checker(1.0f, Rgb(0.0f), Rgb(1.0f))));
  add_floor(scene, lambertian(grey(0.5f)));
  add_floor(scene, lambertian(grey(0.5f)));
  scene.mesh_materials[3].per_triangle = {3, 0};  // its second triangle has the picture
  scene.geometry.meshes[2].texcoord_indices = scene.geometry.meshes[2].triangles;
  const std::size_t before = scene.bytes();
  const std::size_t freed = drop_unneeded(scene);
  CHECK(freed == 2 * 4 * sizeof(vec2) + 2 * sizeof(uvec3));
  CHECK(scene.bytes() == before - freed);
  CHECK(scene.geometry.meshes[0].texcoords.size() == 4);
  CHECK(scene.geometry.meshes[1].texcoords.empty());
  CHECK(scene.geometry.meshes[2].texcoords.empty());
  CHECK(scene.geometry.meshes[2].texcoord_indices.empty());
  CHECK(scene.geometry.meshes[3].texcoords.size() == 4);
  CHECK(drop_unneeded(scene) == 0);
}

TEST_CASE("normals are kept where they bend the light and freed where flat or unseen", "[unit][needs]") {
  Scene scene;
  add_smooth_sphere(scene, vec3(0), 1.0f, 6, lambertian(grey(0.5f)));
  add_smooth_sphere(scene, vec3(3), 1.0f, 6, light(grey(0.5f)));
  add_floor(scene, lambertian(grey(0.5f)));
  scene.geometry.meshes[2].normals.assign(4, vec3(0, 1, 0));
  add_floor(scene, lambertian(grey(0.5f)));
  scene.geometry.meshes[3].normals.assign(4, glm::normalize(vec3(0.01f, 1, 0)));  // half a degree off
  drop_unneeded(scene);
  CHECK_FALSE(scene.geometry.meshes[0].normals.empty());
  CHECK(scene.geometry.meshes[1].normals.empty());
  CHECK(scene.geometry.meshes[2].normals.empty());
  CHECK_FALSE(scene.geometry.meshes[3].normals.empty());
  CHECK(scene_needs(scene).shading_normals);
  scene.geometry.meshes[0].normals.clear();
  scene.geometry.meshes[3].normals.clear();
  CHECK_FALSE(scene_needs(scene).shading_normals);
}

TEST_CASE("what is dropped is not missed: the picture stays the same to the bit", "[unit][needs]") {
  SeenScene scene = lit_room();
  add_quad(scene, {-1, -0.99f, 0.5f}, {2, 0, 0}, {0, 0.1f, -0.3f}, lambertian(any_picture(scene)));
  add_smooth_sphere(scene, {0.0f, 0.3f, -0.3f}, 0.3f, 6, lambertian(grey(0.6f)));
  add_smooth_sphere(scene, {0.6f, 0.5f, -0.3f}, 0.15f, 4, light(grey(2.0f)));
  const RenderOptions options = render_options(24, 24, 8);
  const Film before = render(scene, options);
  CHECK(drop_unneeded(scene) > 0);
  CHECK(different_pixels(render(scene, options), before) == 0);
}

TEST_CASE("what a scene does not need changes nothing when it is switched on", "[statistical][needs]") {
  // All branches on, with and without a picture of the sky to sample: the first is the same to the bit.
  const SeenScene room = lit_room();
  RenderOptions options = render_options(16, 16, 16);
  const Film lean = render(room, options);
  options.needs = all_needs();
  CHECK(different_pixels(render(room, options), lean) == 0);

  SeenScene sky;
  add_sphere(sky, vec3(0.0f), 1.0f, lambertian(grey(0.6f)));
  set_sky(sky, Rgb(1.0f, 0.8f, 0.2f), Rgb(0.1f, 0.4f, 2.0f));
  look(sky, {0, 0.5f, 3}, vec3(0.0f), 45.0f);
  RenderOptions plain = render_options(12, 12, 256);
  plain.sampler = SamplerKind::independent;
  RenderOptions sampled = plain;
  sampled.needs = all_needs();
  sampled.seed = 1;
  const double z = difference_z(mean_luminance(render(sky, plain)), mean_luminance(render(sky, sampled)));
  CHECK(std::abs(z) < 4.0);
}
