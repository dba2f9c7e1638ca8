// Models of formats that another program reads: how it is called, and what its failures become.
#include <cstdlib>
#include <filesystem>

#include "catch.hpp"
#include "expect_error.hpp"
#include "gltf_files.hpp"
#include "io_files.hpp"

using namespace raylab;
using namespace raylab::test;
namespace fs = std::filesystem;

namespace {

/// A folder in which a script stands for raylab-import, its arguments the model and the file to write.
class ForeignFolder : public InputFolder {
 public:
  explicit ForeignFolder(const std::string& script) {
    const fs::path program = write("import", "#!/bin/sh\n" + script);
    fs::permissions(program, fs::perms::owner_all);
    setenv("RAYLAB_IMPORT", program.c_str(), 1);
  }
  ~ForeignFolder() { unsetenv("RAYLAB_IMPORT"); }
};

void expect_refused(const std::string& script, std::initializer_list<const char*> parts) {
  const ForeignFolder folder(script);
  const fs::path model = folder.write("a.fbx", "Kaydara FBX Binary  ");
  expect_error(ErrorKind::input, model.string(), parts, [&] { load_scene(model); });
}

}  // namespace

TEST_CASE("a model of another format is what raylab-import makes of it, under its own name", "[unit]") {
  const ForeignFolder folder("test \"$(cat \"$1\")\" = model && cp \"${1%a.dae}made.glb\" \"$2\"\n");
  GltfModel made = one_triangle({{"material", 0}});
  made.root["extensionsUsed"] = {"KHR_materials_volume"};  // as Assimp writes it, always
  made.push("materials", {{"name", "gold"}, {"alphaMode", "BLEND"}});
  folder.write("made.glb", made.glb());
  const fs::path model = folder.write("a.dae", "model");
  const LoadedScene loaded = load_scene(model);
  CHECK(loaded.scene.geometry.triangle_count() == 1);
  CHECK(loaded.made_for_model);
  REQUIRE(loaded.warnings.size() == 1);
  CHECK(any_line(loaded.warnings, model.string(), {"transparency"}));
  CHECK(any_line(loaded.notes, model.string(), {"\"gold\""}));
  CHECK(loaded.files == std::vector<fs::path>{model, model});
  CHECK(folder.load("[[mesh]]\nfile = \"a.dae\"\n").scene.geometry.triangle_count() == 1);
}

TEST_CASE("a program for other formats that fails, dies, takes too long or writes nonsense is told of", "[unit]") {
  expect_refused("echo no such format >&2; echo more >&2; exit 1", {"raylab-import failed: no such format"});
  expect_refused("exit 1", {"raylab-import failed, and says no reason"});
  expect_refused("kill -9 $$", {"raylab-import died: Killed"});
  expect_refused("kill -XCPU $$", {"raylab-import took too long"});
  expect_refused("kill -ALRM $$", {"raylab-import took too long"});
  expect_refused("exit 0", {"the glTF that raylab-import made of it"});
  expect_refused("echo nonsense > \"$2\"", {"the glTF that raylab-import made of it", "not readable as glTF"});
}

TEST_CASE("without a program for other formats they are refused with what to do", "[unit]") {
  const ForeignFolder folder("exit 0");
  setenv("RAYLAB_IMPORT", "", 1);
  const fs::path model = folder.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  expect_error(ErrorKind::input, model.string(), {"only raylab-import reads", "libassimp-dev"},
               [&] { load_scene(model); });
  setenv("RAYLAB_IMPORT", folder.at("nowhere").c_str(), 1);
  expect_error(ErrorKind::input, model.string(), {"raylab-import does not run: No such file"},
               [&] { load_scene(model); });
}

TEST_CASE("Assimp's formats are read where it is installed: OFF, and Collada with a picture", "[unit]") {
  if (!fs::exists(RAYLAB_BINARY_DIR "/raylab-import")) {
    WARN("left out: raylab-import is not built (libassimp-dev is not installed)");
    return;
  }
  const InputFolder folder;
  const LoadedScene off = load_scene(folder.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
  CHECK(off.scene.geometry.triangle_count() == 1);
  fs::copy_file(RAYLAB_SOURCE_DIR "/scenes/forest-palette.png", folder / "Map.png");
  const LoadedScene dae = load_scene(folder.write("a.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><up_axis>Z_UP</up_axis></asset>
 <library_images><image id="picture"><init_from>C:\art\Map.png</init_from></image></library_images>
 <library_effects><effect id="effect"><profile_COMMON>
  <newparam sid="s"><surface type="2D"><init_from>picture</init_from></surface></newparam>
  <newparam sid="t"><sampler2D><source>s</source></sampler2D></newparam>
  <technique sid="common"><lambert><diffuse><texture texture="t" texcoord="UV"/></diffuse></lambert></technique>
 </profile_COMMON></effect></library_effects>
 <library_materials><material id="painted"><instance_effect url="#effect"/></material></library_materials>
 <library_geometries><geometry id="shape"><mesh>
  <source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 0 2</float_array><technique_common>
   <accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
   <param name="Z" type="float"/></accessor></technique_common></source>
  <source id="u"><float_array id="ua" count="6">0 0 1 0 0 1</float_array><technique_common>
   <accessor source="#ua" count="3" stride="2"><param name="S" type="float"/><param name="T" type="float"/>
   </accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
   <input semantic="TEXCOORD" source="#u" offset="1" set="0"/><p>0 0 1 1 2 2</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="all"><node><instance_geometry url="#shape"><bind_material><technique_common>
  <instance_material symbol="m" target="#painted"><bind_vertex_input semantic="UV" input_semantic="TEXCOORD"
   input_set="0"/></instance_material></technique_common></bind_material></instance_geometry></node></visual_scene>
 </library_visual_scenes>
 <scene><instance_visual_scene url="#all"/></scene>
</COLLADA>
)"));
  REQUIRE(dae.scene.geometry.triangle_count() == 1);
  float highest = 0.0f;
  for (const vec3& p : dae.scene.geometry.meshes.at(0).positions) highest = std::max(highest, p.y);
  CHECK(highest == Approx(2.0f));  // up, which z is there
  CHECK(dae.scene.textures.size() == 1);
  expect_error(ErrorKind::input, folder.at("b.3ds"), {"raylab-import failed: "},
               [&] { load_scene(folder.write("b.3ds", "no model")); });
}
