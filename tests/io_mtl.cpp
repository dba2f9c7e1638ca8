// Materials of OBJ files: which file, which name, which model.
#include "catch.hpp"
#include "expect_error.hpp"
#include "io_files.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// The one material of a triangle whose MTL file holds these lines after "newmtl a".
struct OneMaterial {
  InputFolder folder;
  ObjMesh read;

  explicit OneMaterial(const std::string& lines, const std::string& picture = "") {
    if (!picture.empty()) {
      std::filesystem::create_directories((folder / picture).parent_path());
      write_png(folder / picture, Image(1, 1));
    }
    folder.write("mesh.mtl", "newmtl a\n" + lines);
    read = folder.obj("mtllib mesh.mtl\nusemtl a\n" + kTriangle);
  }
  const Material& material() const { return read.materials.at(0); }
  bool warns(int line, std::initializer_list<const char*> parts) const {
    return any_line(read.warnings, folder.at("mesh.mtl:" + std::to_string(line)), parts);
  }
};

const Rgb kGrey = Rgb(0.5f);

}  // namespace

TEST_CASE("illum 2 is lambertian, with Ke a light, illum 3 metal and illum 6 a dielectric", "[unit]") {
  const OneMaterial diffuse("illum 2\nKd 0.1 0.2 0.3\nKe 0 0 0\n");
  CHECK(diffuse.material().kind == Material::Kind::lambertian);
  CHECK(diffuse.material().color.a == Rgb(0.1f, 0.2f, 0.3f));
  CHECK(diffuse.read.warnings.empty());
  CHECK(any_line(diffuse.read.notes, diffuse.folder.at("mesh.mtl:1"), {"\"a\": lambertian, albedo (0.1, 0.2, 0.3)"}));
  const OneMaterial light("illum 2\nKd 0 0 0\nKe 15 14 13\n");
  CHECK(light.material().kind == Material::Kind::diffuse_light);
  CHECK(light.material().color.a == Rgb(15.0f, 14.0f, 13.0f));
  const OneMaterial metal("illum 3\nKd 1 0 0\nKs 0.7 0.6 0.5\nNs 980\n");
  CHECK(metal.material().kind == Material::Kind::metal);
  CHECK(metal.material().color.a == Rgb(0.7f, 0.6f, 0.5f));
  CHECK(metal.material().fuzz == 0.02f);
  const OneMaterial glass("illum 6\nNi 1.33\nKd 1 0 0\n");
  CHECK(glass.material().kind == Material::Kind::dielectric);
  CHECK(glass.material().index == 1.33f);
}

TEST_CASE("without illum a material is a light where Ke is not zero and lambertian elsewhere", "[unit]") {
  CHECK(OneMaterial("Kd 1 1 1\nKe 1 0 0\nNi 1.5\nd 0.5\n").material().kind == Material::Kind::diffuse_light);
  CHECK(OneMaterial("Kd 1 1 1\nKe 0 0 0\nNi 1.5\nNs 500\n").material().kind == Material::Kind::lambertian);
}

TEST_CASE("a parameter that is absent is not one that is zero", "[unit]") {
  CHECK(OneMaterial("illum 2\n").material().color.a == kGrey);
  CHECK(OneMaterial("illum 2\nKd 0 0 0\n").material().color.a == Rgb(0.0f));
  CHECK(OneMaterial("illum 3\n").material().fuzz == 0.0f);
  CHECK(OneMaterial("illum 3\nNs 0\n").material().fuzz == 1.0f);
  CHECK(OneMaterial("illum 3\nKs 0 0 0\n").material().color.a == Rgb(0.0f));
  CHECK(OneMaterial("illum 6\n").material().index == 1.5f);
}

TEST_CASE("values out of range are clamped with a warning", "[unit]") {
  const OneMaterial bright("Kd 1.5 1 0.5\n");
  CHECK(bright.material().color.a == Rgb(1.0f, 1.0f, 0.5f));
  CHECK(bright.warns(1, {"\"a\"", "(1.5, 1, 0.5)", "clamped"}));
  const OneMaterial sharp("illum 3\nNs 2000\n");
  CHECK(sharp.material().fuzz == 0.0f);
  CHECK(sharp.warns(1, {"Ns 2000", "clamped"}));
}

TEST_CASE("what a material's model does not read is named in a warning", "[unit]") {
  CHECK(OneMaterial("illum 10\nKd 1 1 1\n").warns(1, {"\"a\"", "illum 10"}));
  CHECK(OneMaterial("illum 10\nKd 1 1 1\nd 1\n").warns(1, {"\"a\"", "illum 10"}));
  CHECK(OneMaterial("illum 3\nKe 1 1 1\n").warns(1, {"Ke (1, 1, 1)", "left out"}));
  CHECK(OneMaterial("illum 6\nmap_Kd x.png\n").warns(1, {"map_Kd \"x.png\"", "left out"}));
}

TEST_CASE("MTL statements that are not understood give one warning a kind", "[unit]") {
  const OneMaterial one(
      "Kd 1 1 1\nPc 0.5\nPc 0.6\nmap_Bump bump.png\nKs spectral steel.rfl\nmap_d d.png\n"
      "newmtl b\nPc 1\nmap_d e.png\n");
  CHECK(one.read.warnings.size() == 4);
  CHECK(one.warns(3, {"\"Pc\""}));
  CHECK(one.warns(5, {"\"map_Bump\""}));
  CHECK(one.warns(6, {"\"Ks spectral\""}));
  CHECK(one.warns(7, {"\"map_d\""}));
  CHECK(OneMaterial("Ka 1 1 1\nd 1.0\nTr 0\nTf 1 1 1\n").read.warnings.empty());
}

TEST_CASE("bad values in an MTL file are refused with file:line and value", "[unit]") {
  struct Case {
    std::string lines;
    int line;
    const char* part;
  };
  const std::vector<Case> cases = {
      {"Kd 1 x 1\n", 2, "found \"x\""},     {"\nKd 1 1\n", 3, "found \"1 1\""}, {"Ke -1 0 0\n", 2, "found \"-1\""},
      {"Ks nan 0 0\n", 2, "found \"nan\""}, {"Ke 1e39 0 0\n", 2, "1e39"},       {"Ns shiny\n", 2, "found \"shiny\""},
      {"Ni 0\n", 2, "found \"0\""},         {"Ni -1.5\n", 2, "found \"-1.5\""}, {"illum 2.5\n", 2, "found \"2.5\""},
      {"d x\n", 2, "found \"x\""},          {"Pr\n", 2, "found \"\""},          {"Tf -1 1 1\n", 2, "found \"-1\""},
      {"illum 11\n", 2, "found \"11\""},    {"newmtl\n", 2, "newmtl"},          {"map_Kd -s 1 1 1\n", 2, "file name"}};
  for (const Case& bad : cases) {
    INFO(bad.lines);
    InputFolder folder;
    folder.write("mesh.mtl", "newmtl a\n" + bad.lines);
    expect_error(ErrorKind::input, folder.at("mesh.mtl:" + std::to_string(bad.line)), {bad.part},
                 [&] { folder.obj("mtllib mesh.mtl\nusemtl a\n" + kTriangle); });
  }
}

TEST_CASE("numbers in an MTL file are read with comments, signs, one for three and tiny values", "[unit]") {
  CHECK(OneMaterial("Kd +0.25 .5 1e-1 # paint\r\n").material().color.a == Rgb(0.25f, 0.5f, 0.1f));
  CHECK(OneMaterial("\tKd 0.25\n").material().color.a == Rgb(0.25f));
  CHECK(OneMaterial("Kd 0 0 1e-60\n").material().color.a == Rgb(0.0f));
}

TEST_CASE("each triangle has the material of the last usemtl before it", "[unit]") {
  InputFolder folder;
  folder.write("mesh.mtl", "newmtl unused\nKd 0 0 0\nnewmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0\n");
  const ObjMesh read = folder.obj(
      "mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nusemtl green\n"
      "usemtl red\nf 1 2 3 4\nusemtl green\nf 1 2 3\nusemtl red\nf 2 3 4\n");
  REQUIRE(read.mesh.triangles.size() == 5);
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < 5; ++i) names.push_back(read.materials.at(read.mesh_materials.of(i)).name);
  CHECK(names == std::vector<std::string>{"default", "red", "red", "green", "red"});
  CHECK(read.materials.size() == 3);
  CHECK(read.materials.at(read.mesh_materials.of(0)).color.a == kGrey);
  CHECK(read.warnings.empty());
}

TEST_CASE("a mesh of one material stores no index for each triangle", "[unit]") {
  const OneMaterial one("Kd 1 0 0\n");
  CHECK(one.read.mesh_materials.per_triangle.empty());
  CHECK(one.read.materials.size() == 1);
  // Nor when several names mean the same.
  const ObjMesh unknown = one.folder.obj("usemtl x\n" + kTriangle + "usemtl y\nf 1 2 3\n");
  CHECK(unknown.mesh_materials.per_triangle.empty());
  CHECK(unknown.warnings.size() == 2);
}

TEST_CASE("names of materials and of MTL files may hold spaces", "[unit]") {
  InputFolder folder;
  folder.write("my scene.mtl", "newmtl dark wood \nKd 1 0 0\nnewmtl dark\nKd 0 1 0\n");
  folder.write("other.MTL", "newmtl #2 paint\r\nKd 0 0 1\r\n");
  const ObjMesh read =
      folder.obj("mtllib my scene.mtl other.MTL\nusemtl  dark wood\t\n" + kTriangle + "usemtl #2 paint\r\nf 1 2 3\n");
  CHECK(read.warnings.empty());
  CHECK(read.materials.at(read.mesh_materials.of(0)).color.a == Rgb(1.0f, 0.0f, 0.0f));
  CHECK(read.materials.at(read.mesh_materials.of(1)).color.a == Rgb(0.0f, 0.0f, 1.0f));
  CHECK(read.files.size() == 3);
}

TEST_CASE("mtllib may come after usemtl, be given twice and name a folder with backslashes", "[unit]") {
  InputFolder folder;
  std::filesystem::create_directories(folder / "sub");
  folder.write("sub/mesh.mtl", "newmtl a\nKd 1 0 0\n");
  const ObjMesh read = folder.obj("usemtl a\n" + kTriangle + "mtllib sub\\mesh.mtl\nmtllib sub/mesh.mtl\n");
  CHECK(read.warnings.empty());
  CHECK(read.materials.at(0).color.a == Rgb(1.0f, 0.0f, 0.0f));
  CHECK(read.files.size() == 2);
}

TEST_CASE("missing MTL files and unknown materials are named in warnings and grey", "[unit]") {
  InputFolder folder;
  const ObjMesh read = folder.obj("mtllib absent.mtl\n\nusemtl paint\n" + kTriangle);
  CHECK(any_line(read.warnings, folder.at("mesh.obj:1"), {"\"absent.mtl\"", "missing"}));
  CHECK(any_line(read.warnings, folder.at("mesh.obj:3"), {"\"paint\"", "not defined"}));
  CHECK(read.materials.at(read.mesh_materials.of(0)).kind == Material::Kind::lambertian);
  CHECK(read.materials.at(read.mesh_materials.of(0)).color.a == kGrey);
}

TEST_CASE("an OBJ file without materials is grey without a warning", "[unit]") {
  InputFolder folder;
  const ObjMesh read = folder.obj(kTriangle);
  CHECK(read.warnings.empty());
  CHECK(read.materials.at(read.mesh_materials.of(0)).color.a == kGrey);
}

TEST_CASE("of two materials with one name the first counts, with a warning", "[unit]") {
  const OneMaterial one("Kd 1 0 0\nnewmtl a\nKd 0 1 0\n");
  CHECK(one.material().color.a == Rgb(1.0f, 0.0f, 0.0f));
  CHECK(one.warns(3, {"\"a\"", "mesh.mtl:1"}));
}

TEST_CASE("map_Kd takes the place of Kd whatever options and spaces are around its name", "[unit]") {
  for (const char* statement :
       {"map_Kd sub/my map.png", "map_Kd sub\\my map.png", "map_Kd -s 2 2 2 -o 0.5 sub/my map.png",
        "map_Kd sub/my map.png -clamp on", "map_Kd -blendu off -mm 0 1 -bm 0.5 sub/my map.png -t 1 1",
        "map_Kd -imfchan r -texres 64 -boost 2 -cc on -blendv on -type sphere sub/my map.png",
        "map_Kd \"sub/my map.png\"", "map_Kd \t sub/my map.png \t\r"}) {
    INFO(statement);
    const OneMaterial one("Kd 1 0 0\n" + std::string(statement) + "\n", "sub/my map.png");
    INFO(joined(one.read.warnings));
    CHECK(one.material().color.kind == Texture::Kind::image);
    REQUIRE(one.read.textures.size() == 1);
    CHECK(one.read.textures[0].name == "sub/my map.png");
    CHECK(one.read.files.size() == 3);
    CHECK(one.read.warnings.empty() == (std::string(statement).find('-') == std::string::npos));
  }
}

TEST_CASE("an option of a map that is left out is named", "[unit]") {
  const OneMaterial one("map_Kd -s 2 2 2 -clamp on map.png\n", "map.png");
  CHECK(one.warns(2, {"\"-s\"", "map_Kd"}));
  CHECK(one.warns(2, {"\"-clamp\""}));
}

TEST_CASE("a missing texture is named in a warning and magenta", "[unit]") {
  const OneMaterial one("Kd 1 1 1\nmap_Kd absent.png\n");
  CHECK(one.material().color.kind == Texture::Kind::solid);
  CHECK(one.material().color.a == Rgb(1.0f, 0.0f, 1.0f));
  CHECK(one.warns(3, {"\"absent.png\"", "\"a\"", "missing"}));
}

TEST_CASE("a texture of a kind that is not read is magenta like a missing one, whatever its name", "[unit]") {
  for (const std::string kind : {"map_Kd", "map_Ke", "map_Pr"}) {
    InputFolder folder;
    folder.write("mesh.mtl", "newmtl a\nKd 1 1 1\n" + kind + " map.gif\n");
    folder.write("map.gif", "GIF89a");
    const ObjMesh read = folder.obj("mtllib mesh.mtl\nusemtl a\n" + kTriangle);
    REQUIRE(read.warnings.size() == 1);
    CHECK(read.warnings.front().find("mesh.mtl:3: texture \"map.gif\" is neither PNG nor JPEG") != std::string::npos);
    CHECK(read.materials.at(0).color.a == (kind == "map_Kd" ? Rgb(1.0f, 0.0f, 1.0f) : Rgb(1.0f)));
  }
}

TEST_CASE("a texture that is there but damaged is refused", "[unit]") {
  InputFolder folder;
  folder.write("mesh.mtl", "newmtl a\nmap_Kd map.png\n");
  folder.write("map.png", "no picture");
  expect_error(ErrorKind::input, folder.at("map.png"), {},
               [&] { folder.obj("mtllib mesh.mtl\nusemtl a\n" + kTriangle); });
}

TEST_CASE("textures of materials that no face uses are not read", "[unit]") {
  const OneMaterial one("Kd 1 1 1\nnewmtl b\nmap_Kd absent.png\n");
  CHECK(one.read.warnings.empty());
  CHECK(one.read.textures.empty());
}

TEST_CASE("materials are left alone when they are to be ignored", "[unit]") {
  InputFolder folder;
  const ObjMesh read =
      read_obj(folder.write("mesh.obj", "mtllib absent.mtl\nusemtl a\n" + kTriangle), {.ignore_materials = true});
  CHECK(read.warnings.empty());
  CHECK(read.materials.empty());
  CHECK(read.files.size() == 1);
  CHECK(read.mesh.triangles.size() == 1);
}

TEST_CASE("a texture is found by its name beside the MTL file, with a warning", "[unit]") {
  for (const char* name : {"C:\\Users\\me\\my wood.png", "/home/me/my wood.png", "../../my wood.png", "MY Wood.PNG",
                           "Textures\\My Wood.png", "textures/absent/my wood.png"}) {
    INFO(name);
    const OneMaterial one("map_Kd " + std::string(name) + "\n", "my wood.png");
    CHECK(one.material().color.kind == Texture::Kind::image);
    CHECK(one.read.warnings.size() == 1);
    CHECK(one.warns(2, {"missing: \"my wood.png\" in its place"}));
  }
  // The folder that is named goes first, and of names that differ in case alone the first.
  const OneMaterial one("Kd 1 1 1\n", "maps/WOOD.png");
  for (const char* name : {"maps/Wood.png", "wood.png"}) write_png(one.folder / name, Image(1, 1));
  one.folder.write("mesh.mtl", "newmtl a\nmap_Kd maps/wood.png\n");
  const ObjMesh read = one.folder.obj("mtllib mesh.mtl\nusemtl a\n" + kTriangle);
  CHECK(any_line(read.warnings, one.folder.at("mesh.mtl:2"), {"\"maps/WOOD.png\" in its place"}));
}

TEST_CASE("a material file is found by its name beside the OBJ file, with a warning", "[unit]") {
  const InputFolder folder;
  folder.write("Mesh.mtl", "newmtl a\nKd 1 0 0\n");
  for (const char* name : {"C:\\models\\mesh.mtl", "MESH.MTL", "/tmp/absent/Mesh.mtl"}) {
    INFO(name);
    const ObjMesh read = folder.obj("mtllib " + std::string(name) + "\nusemtl a\n" + kTriangle);
    CHECK(read.materials.at(0).color.a == Rgb(1.0f, 0.0f, 0.0f));
    CHECK(read.warnings.size() == 1);
    CHECK(any_line(read.warnings, folder.at("mesh.obj:1"), {"missing: \"Mesh.mtl\" in its place"}));
  }
}
