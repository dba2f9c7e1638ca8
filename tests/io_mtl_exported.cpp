// Materials of OBJ files as exporters write them: gold is gold, and glass is glass.
#include <algorithm>
#include <utility>

#include "catch.hpp"
#include "expect_error.hpp"
#include "io_files.hpp"
#include "raylab/image/image.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

using Kind = Material::Kind;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const Rgb kGold = Rgb(1.0f, 0.766f, 0.336f);

/// The material named "a" of a triangle whose MTL file is this text.
struct Exported {
  InputFolder folder;
  ObjMesh read;

  explicit Exported(const std::string& text) { load(text); }
  /// With a picture of 2 x 1 texels of these colours beside it.
  Exported(const std::string& text, const std::string& picture, const Rgb& left, const Rgb& right) {
    Image image(2, 1);
    image.pixels = {left, right};
    write_png(folder / picture, image);
    load(text);
  }
  void load(const std::string& text) {
    folder.write("mesh.mtl", text);
    read = folder.obj("mtllib mesh.mtl\nusemtl a\n" + kTriangle);
  }
  const Material& material() const { return read.materials.at(0); }
  bool notes(std::initializer_list<const char*> parts) const {
    INFO(joined(read.notes));
    return any_line(read.notes, folder.at("mesh.mtl:" + std::to_string(line_of_newmtl())), parts);
  }
  bool warns(int line, std::initializer_list<const char*> parts) const {
    return any_line(read.warnings, folder.at("mesh.mtl:" + std::to_string(line)), parts);
  }
  int line_of_newmtl() const {
    const std::string text = read_text(folder / "mesh.mtl");
    return 1 + static_cast<int>(std::count(text.begin(), text.begin() + text.find("newmtl a"), '\n'));
  }
};

/// What a material of these lines becomes.
Material made_of(const std::string& lines) { return Exported("newmtl a\n" + lines).material(); }

bool is_metal(const Material& m, const Rgb& color, float fuzz) {
  return m.kind == Kind::metal && m.color.kind == Texture::Kind::solid && m.color.a == color &&
         m.fuzz == Approx(fuzz).margin(1e-4);
}
bool is_dielectric(const Material& m, float index) { return m.kind == Kind::dielectric && m.index == index; }
bool is_lambertian(const Material& m, const Rgb& color) {
  return m.kind == Kind::lambertian && m.color.kind == Texture::Kind::solid && m.color.a == color;
}

}  // namespace

TEST_CASE("Blender 4 with its extension for physically based materials: gold, glass and plastic", "[unit]") {
  const std::string head = "# Blender 4.0.2 MTL File: 'room.blend'\n# www.blender.org\n\nnewmtl a\n";
  const std::string rest = "Ps 0.000000\nPc 0.000000\nPcr 0.030000\naniso 0.000000\nanisor 0.000000\n";
  const Exported gold(head +
                      "Kd 1.000000 0.766000 0.336000\nKs 0.500000 0.500000 0.500000\nKe 0.000000 0.000000 0.000000\n"
                      "Ni 1.450000\nd 1.000000\nillum 3\nPr 0.200000\nPm 1.000000\n" +
                      rest);
  // GGX of width 0.04 has half of its light within 2 atan 0.04 of the mirror direction.
  CHECK(is_metal(gold.material(), kGold, 0.0799f / 0.8660f));
  CHECK(gold.read.warnings.empty());
  CHECK(gold.read.notes.at(0).find("left out") == std::string::npos);
  const Exported glass(head +
                       "Kd 0.800000 0.900000 0.800000\nKs 0.500000 0.500000 0.500000\nKe 0.000000 0.000000 0.000000\n"
                       "Ni 1.330000\nd 1.000000\nillum 2\nPr 0.000000\nPm 0.000000\n" +
                       rest + "Tf 1.000000 1.000000 1.000000\n");
  CHECK(is_dielectric(glass.material(), 1.33f));
  CHECK(glass.read.notes.at(0).ends_with("dielectric, index 1.33; left out: its tint"));
  const Exported plastic(head + "Kd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1\nillum 2\nPr 0.5\nPm 0\n" +
                         rest);
  CHECK(is_lambertian(plastic.material(), Rgb(0.8f, 0.1f, 0.1f)));
  CHECK(plastic.read.notes.at(0).ends_with("; left out: its gloss (roughness 0.5)"));
}

TEST_CASE("Blender 2.8 to 4 without the extension: illum 3 is a metal of colour Kd, as far as Ka says", "[unit]") {
  const std::string gold =
      "newmtl a\nNs 640.000000\nKa 1.000000 1.000000 1.000000\nKd 1.000000 0.766000 0.336000\n"
      "Ks 0.500000 0.500000 0.500000\nKe 0.000000 0.000000 0.000000\nNi 1.450000\nd 1.000000\nillum 3\n";
  // Ns = 1000 (1 - 0.2)²; the comment may have been cut off.
  for (const char* head : {"# Blender 3.3.1 MTL File: 'None'\n# www.blender.org\n\n",
                           "# Blender MTL File: 'gold.blend'\n# Material Count: 1\n\n", "# by hand\n", ""}) {
    INFO(head);
    CHECK(is_metal(Exported(head + gold).material(), kGold, 0.0799f / 0.8660f));
  }
  const std::string head = "# Blender 3.3.1 MTL File: 'None'\nnewmtl a\n";
  const Exported dark(head + "Ns 640\nKa 1 1 1\nKd 0.3 0.2 0.1\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\nillum 3\n");
  CHECK(is_metal(dark.material(), Rgb(0.3f, 0.2f, 0.1f), 0.0799f / 0.8660f));
  const Exported little(head + "Ns 640\nKa 0.1 0.1 0.1\nKd 0.3 0.2 0.1\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\nillum 3\n");
  CHECK(is_lambertian(little.material(), Rgb(0.3f, 0.2f, 0.1f)));
  CHECK(little.notes({"; left out: its metallic part (0.1), its gloss (roughness 0.2)"}));
  // No Blender writes a coloured Ks: someone has changed it.
  const Exported changed(head + "Ns 900\nKa 1 1 1\nKd 1 0 0\nKs 0.7 0.6 0.5\nNi 1.45\nd 1\nillum 3\n");
  CHECK(is_metal(changed.material(), Rgb(0.7f, 0.6f, 0.5f), 0.1f));
}

TEST_CASE("Blender up to 2.79: Ka is a sharp mirror over a body of colour Kd", "[unit]") {
  const std::string head = "# Blender MTL File: 'car.blend'\nnewmtl a\nNs 96.078431\n";
  CHECK(is_metal(
      Exported(head + "Ka 0.9 0.9 0.9\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNi 1.000000\nd 1\nillum 3\n").material(),
      Rgb(0.9f), 0.0f));
  CHECK(is_metal(
      Exported(head + "Ka 0.9 0.9 0.9\nKd 0.8 0.6 0.2\nKs 0.5 0.5 0.5\nNi 1.000000\nd 1\nillum 3\n").material(),
      Rgb(0.8f, 0.6f, 0.2f), 0.0f));
  CHECK(is_lambertian(
      Exported(head + "Ka 0.01 0.01 0.01\nKd 0.8 0.8 0.8\nKs 0.1 0.1 0.1\nNi 1.000000\nd 1\nillum 3\n").material(),
      Rgb(0.8f)));
  const Exported pane(head + "Ka 0.5 0.5 0.5\nKd 0.82 0.82 0.82\nKs 0.5 0.5 0.5\nNi 1.000000\nd 0.500000\nillum 3\n");
  CHECK(is_dielectric(pane.material(), 1.5f));
  CHECK(pane.notes({"; left out: its tint, its part that is not clear (0.5), its index (1)"}));
}

TEST_CASE("a metal of our convention stays what it is where an exporter's d is added", "[unit]") {
  for (const char* lines :
       {"illum 3\nKd 1 0 0\nKs 0.7 0.6 0.5\nNs 980\n", "illum 3\nKd 1 0 0\nKs 0.7 0.7 0.7\nNs 980\n",
        "illum 3\nKs 0 0 0\n", "illum 3\n", "Ka 0 0 0\nKd 0.5 0.5 0.5\nKs 0.4 0.4 0.4\nillum 3\n",
        "illum 6\nNi 1.33\nKd 1 0 0\n", "illum 6\n", "illum 2\nKd 0.1 0.2 0.3\nKe 0 0 0\n", "Ke 2 1 0\n",
        "illum 0\nKd 1 0 0\n", "illum 1\nKd 1 0 0\n", "illum 2\n"}) {
    INFO(lines);
    const Material plain = made_of(lines);
    for (const char* added : {"d 1.000000\n", "Tr 0\n", "Tf 1 1 1\n"}) {
      const Material exported = made_of(lines + std::string(added));
      CHECK(exported.kind == plain.kind);
      CHECK(exported.color.a == plain.color.a);
      CHECK(exported.fuzz == plain.fuzz);
      CHECK(exported.index == plain.index);
    }
  }
}

TEST_CASE("3ds Max writes d, Tr and a white Tf for everything", "[unit]") {
  const std::string head = "# 3ds Max Wavefront OBJ Exporter v0.97b - (c)2007 guruware\n\nnewmtl a\n";
  CHECK(is_lambertian(
      Exported(head + "\tNs 32\n\tNi 1.5000\n\td 1.0000\n\tTr 0.0000\n\tTf 1.0000 1.0000 1.0000 \n\tillum 2\n"
                      "\tKa 0.5 0.5 0.5\n\tKd 0.5 0.25 0.125\n\tKs 0.35 0.35 0.35\n\tKe 0 0 0\n")
          .material(),
      Rgb(0.5f, 0.25f, 0.125f)));
  CHECK(is_dielectric(
      Exported(head + "\tNs 10\n\tNi 1.6000\n\td 0.3000\n\tTr 0.7000\n\tTf 0.3000 0.3000 0.3000 \n\tillum 2\n"
                      "\tKa 0.5 0.5 0.5\n\tKd 0.5 0.5 0.5\n\tKs 0 0 0\n\tKe 0 0 0\n")
          .material(),
      1.6f));
  // Those that follow it write the extension too, and the white Tf is none of Blender's transmission.
  CHECK(is_lambertian(
      Exported(head + "Ni 1.5\nd 1\nTr 0\nTf 1 1 1\nillum 2\nKd 0.5 0.25 0.125\nPr 0.33\nPm 0\n").material(),
      Rgb(0.5f, 0.25f, 0.125f)));
}

TEST_CASE("Maya writes illum 4 for everything, and Tf 1 for what is opaque", "[unit]") {
  CHECK(is_lambertian(made_of("illum 4\nKd 0.50 0.25 0.12\nKa 0.00 0.00 0.00\nTf 1.00 1.00 1.00\nNi 1.00\n"),
                      Rgb(0.5f, 0.25f, 0.12f)));
  CHECK(is_dielectric(made_of("illum 4\nKd 0.50 0.25 0.12\nKa 0.00 0.00 0.00\nTf 0.20 0.20 0.20\nNi 1.00\n"), 1.5f));
  CHECK(is_dielectric(made_of("illum 4\nKd 0.50 0.25 0.12\nTf 1 1 1\nNi 1.4\n"), 1.4f));
}

TEST_CASE("SketchUp, Sweet Home 3D and MeshLab", "[unit]") {
  CHECK(is_dielectric(
      made_of("Ka 0.000000 0.000000 0.000000\nKd 0.392157 0.584314 0.929412\nKs 0.330000 0.330000 0.330000\n"
              "d 0.400000\n"),
      1.5f));
  CHECK(is_lambertian(made_of("Ka 0.000000 0.000000 0.000000\nKd 0.25 0.5 0.75\nKs 0.330000 0.330000 0.330000\n"),
                      Rgb(0.25f, 0.5f, 0.75f)));
  CHECK(is_dielectric(made_of("illum 4\nKd 0.5 0.5 0.5\nd 0.3\nTr 0.7\n"), 1.5f));
  CHECK(is_dielectric(
      made_of("Ni 1\nillum 2\nKa 0.0 0.0 0.0\nKd 0.64 0.64 0.64\nKs 0.5 0.5 0.5\nNs 96.07843\nd 0.25\n"), 1.5f));
  CHECK(is_dielectric(made_of("illum 1\nKd 0.2 0.1 0.02\nKs 0.2 0.2 0.2\nNi 1.0\nd 0.4\n"), 1.5f));
  CHECK(is_lambertian(made_of("Ka 0.2 0.2 0.2\nKd 1 0.5 0.25\nKs 1 1 1\nTr 1.000000\nillum 2\nNs 0\n"),
                      Rgb(1.0f, 0.5f, 0.25f)));
}

TEST_CASE("what is at most half opaque is glass, and d says it before Tr", "[unit]") {
  const std::vector<std::pair<const char*, bool>> cases = {
      {"d 0.5\n", true},          {"d 0.51\n", false},           {"Tr 0.5\n", true},         {"Tr 0.49\n", false},
      {"d 1\nTr 1\n", false},     {"Tr 1\nd 0.1\n", true},       {"Tr 1\n", false},          {"d 0.2\nTr 0\n", true},
      {"Tf 0.9 0.9 0.9\n", true}, {"Tf 0.1 0.1 0.1\n", false},   {"Tf 0 0 0\nd 1\n", false}, {"d -halo 0.2\n", true},
      {"d 1.7\n", false},         {"d 0\nmap_d x.png\n", false}, {"d 0.001\n", true},        {"Tf 1 1 1\n", false}};
  for (const auto& [lines, is_clear] : cases) {
    INFO(lines);
    const Material made = made_of("Kd 0.5 0.5 0.5\n" + std::string(lines));
    CHECK(made.kind == (is_clear ? Kind::dielectric : Kind::lambertian));
    if (is_clear) CHECK(made.index == 1.5f);
  }
}

TEST_CASE("what is wholly clear without a word of glass is not to be seen", "[unit]") {
  CHECK(is_dielectric(made_of("Kd 1 1 1\nd 0\n"), 1.0f));
  CHECK(Exported("newmtl a\nNi 1\nillum 2\nd 0\n").notes({"index 1; left out: ", "wholly clear (d 0)"}));
  CHECK(is_dielectric(made_of("Kd 1 1 1\nd 0\nillum 9\n"), 1.5f));
  CHECK(is_dielectric(made_of("Kd 1 1 1\nd 0\nNi 1.45\n"), 1.45f));
}

TEST_CASE("illum 4, 6, 7 and 9 are glass, 5 and 8 sharp metals of colour Ks, 0 and 1 lambertian", "[unit]") {
  for (const char* illum :
       {"illum 4\n", "illum 6\nd 1\n", "illum 7\n", "illum 9\n", "illum 9\nd 0.6\n", "illum 7\nd 0.9\n"}) {
    INFO(illum);
    CHECK(is_dielectric(made_of(illum + std::string("Kd 0.5 0.5 0.5\nNi 1.6\n")), 1.6f));
  }
  CHECK(Exported("newmtl a\nillum 9\nKd 1 1 1\nd 0.6\n").notes({"; left out: its opacity (0.6)"}));
  // Blender marks a leaf that fades with 9, too.
  CHECK(is_lambertian(made_of("illum 9\nKd 0.5 0.25 0.125\nd 0.9\n"), Rgb(0.5f, 0.25f, 0.125f)));
  for (const char* illum : {"illum 5\n", "illum 8\n"}) {
    INFO(illum);
    CHECK(is_metal(made_of(illum + std::string("Kd 1 0 0\nKs 0.9 0.8 0.7\nNs 100\n")), Rgb(0.9f, 0.8f, 0.7f), 0.0f));
    CHECK(is_metal(made_of(illum + std::string("Ka 1 1 1\nKd 1 0 0\nKs 0.9 0.9 0.9\n")), Rgb(0.9f), 0.0f));
  }
  CHECK(is_lambertian(made_of("illum 0\nKd 1 0 0\nKs 1 1 1\nNs 900\nd 1\n"), Rgb(1.0f, 0.0f, 0.0f)));
  CHECK(is_lambertian(made_of("illum 1\nKd 1 0 0\nd 1\n"), Rgb(1.0f, 0.0f, 0.0f)));
}

TEST_CASE("map_Ke is a light in the picture's colours, whether Ke is there or not", "[unit]") {
  for (const char* lines :
       {"map_Ke lamp.png\n", "Ke 0 0 0\nmap_Ke lamp.png\n", "Ke 1 1 1\nKd 1 1 1\nmap_Ke lamp.png\n"}) {
    INFO(lines);
    const Exported screen("newmtl a\n" + std::string(lines), "lamp.png", Rgb(1.0f), Rgb(0.25f));
    CHECK(screen.material().kind == Kind::diffuse_light);
    CHECK(screen.material().color.kind == Texture::Kind::image);
    CHECK(screen.read.warnings.empty());
    CHECK(screen.read.textures.size() == 1);
  }
  const Exported bright("newmtl a\nKe 5 5 5\nmap_Ke lamp.png\n", "lamp.png", Rgb(1.0f), Rgb(1.0f));
  CHECK(bright.notes({"diffuse_light", "its factor Ke (5, 5, 5)"}));
  const Exported missing("newmtl a\nKd 1 0 0\nmap_Ke lamp.png\n");
  CHECK(is_lambertian(missing.material(), Rgb(1.0f, 0.0f, 0.0f)));
  CHECK(missing.warns(3, {"\"lamp.png\"", "missing"}));
}

TEST_CASE("lamps on a body that is otherwise black in map_Ke do not make it a light", "[unit]") {
  Image image(4, 1);
  image.pixels = {Rgb(1.0f), Rgb(0.0f), Rgb(0.002f), Rgb(0.0f)};
  InputFolder folder;
  write_png(folder / "lamps.png", image);
  folder.write("mesh.mtl", "newmtl a\nKd 1 0 0\nmap_Ke lamps.png\n");
  const ObjMesh car = folder.obj("mtllib mesh.mtl\nusemtl a\n" + kTriangle);
  CHECK(is_lambertian(car.materials.at(0), Rgb(1.0f, 0.0f, 0.0f)));
  CHECK(any_line(car.notes, folder.at("mesh.mtl:1"), {"; left out: its light", "black"}));
  CHECK(car.textures.empty());
  CHECK(car.files.size() == 3);
}

TEST_CASE("map_Pr and map_Pm stand for the mean of the numbers in them", "[unit]") {
  // Bytes 51 and 153: 0.2 and 0.6.
  const Exported rough("newmtl a\nKd 1 0.766 0.336\nPm 1\nPr 0.9\nmap_Pr n.png\n", "n.png", Rgb(srgb_to_linear(0.2f)),
                       Rgb(srgb_to_linear(0.6f)));
  // tan = 0.4² and twice its angle.
  CHECK(is_metal(rough.material(), kGold, 0.31201f / 0.86603f));
  CHECK(rough.read.textures.empty());
  CHECK(rough.read.files.size() == 3);
  const Exported metal("newmtl a\nKd 1 0.766 0.336\nPr 0\nmap_Pm n.png\n", "n.png", Rgb(1.0f),
                       Rgb(srgb_to_linear(0.2f)));
  CHECK(is_metal(metal.material(), kGold, 0.0f));
  const Exported matt("newmtl a\nKd 1 0.766 0.336\nPr 0\nmap_Pm n.png\n", "n.png", Rgb(0.0f),
                      Rgb(srgb_to_linear(0.2f)));
  CHECK(is_lambertian(matt.material(), kGold));
  const Exported missing("newmtl a\nKd 1 0.766 0.336\nPm 1\nPr 0\nmap_Pr n.png\n");
  CHECK(is_metal(missing.material(), kGold, 0.0f));
  CHECK(missing.warns(5, {"\"n.png\"", "missing"}));
}

TEST_CASE("metals keep their pictures", "[unit]") {
  for (const char* lines : {"Pm 1\nPr 0.1\nmap_Kd p.png\n", "illum 5\nKs 1 1 1\nmap_Ks p.png\n",
                            "Ka 1 1 1\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\nillum 3\nmap_Kd p.png\n",
                            "Ka 1 1 1\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\nillum 3\nmap_Kd p.png\n"}) {
    INFO(lines);
    const Exported one("newmtl a\n" + std::string(lines), "p.png", Rgb(0.5f), Rgb(0.7f));
    CHECK(one.material().kind == Kind::metal);
    CHECK(one.material().color.kind == Texture::Kind::image);
    CHECK(one.read.warnings.empty());
  }
  // What glass and lights do not show is not read.
  const Exported glass("newmtl a\nd 0.2\nmap_Kd p.png\n", "p.png", Rgb(0.5f), Rgb(0.7f));
  CHECK(glass.read.textures.empty());
  CHECK(glass.notes({"its tint"}));
}

TEST_CASE("Pm without more is a metal, and half metallic is one", "[unit]") {
  CHECK(made_of("Kd 1 0.766 0.336\nPm 1\n").kind == Kind::metal);
  CHECK(made_of("Kd 1 0.766 0.336\nPm 0.5\nPr 0\n").kind == Kind::metal);
  CHECK(made_of("Kd 1 0.766 0.336\nPm 0.49\nPr 0\n").kind == Kind::lambertian);
  CHECK(made_of("Kd 1 1 1\nillum 3\nKs 1 1 1\nPm 0\n").kind == Kind::lambertian);
  CHECK(made_of("Kd 1 1 1\nPm 1\nKe 1 1 1\n").kind == Kind::diffuse_light);
}

TEST_CASE("shares beyond [0, 1] are clamped with a warning", "[unit]") {
  const Exported one("newmtl a\nKd 1 1 1\nPr -0.5\nPm 2\nd 100\nTr -1\n");
  CHECK(is_metal(one.material(), Rgb(1.0f), 0.0f));
  CHECK(one.read.warnings.size() == 4);
  CHECK(one.warns(3, {"\"a\"", "Pr -0.5, clamped to 0"}));
  CHECK(one.warns(4, {"Pm 2, clamped to 1"}));
  CHECK(one.warns(5, {"d 100, clamped to 1"}));
  CHECK(one.warns(6, {"Tr -1, clamped to 0"}));
}

TEST_CASE("an index of 0 or -1 is that of an exporter that knows none", "[unit]") {
  const Exported one("newmtl a\nNi -1.000000\nd 0.2\nillum 2\nnewmtl b\nNi 0\nd 1\n");
  CHECK(is_dielectric(one.material(), 1.5f));
  CHECK(one.read.warnings.size() == 1);
  CHECK(one.warns(2, {"Ni -1", "left out"}));
}
