// Materials and pictures of glTF files.
#include "catch.hpp"
#include "expect_error.hpp"
#include "gltf_files.hpp"
#include "io/surface_description.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;
using namespace raylab::test;

namespace {

/// One triangle with texture coordinates, whose material is these members.
GltfModel with_material(const Json& material) {
  GltfModel model;
  const int positions = model.accessor(kCorners, 3);
  const int texcoords = model.accessor(std::vector<float>{0, 0, 1, 0, 0, 0.25f}, 2);
  const int other = model.accessor(std::vector<float>{0.5f, 0.5f, 1, 1, 2, 2}, 2);
  model.mesh({{"POSITION", positions}, {"TEXCOORD_0", texcoords}, {"TEXCOORD_1", other}}, {{"material", 0}});
  model.push("materials", material);
  return model;
}

/// What is read with this material; its pictures lie in the folder, as textures of their index.
struct OneMaterial {
  GltfRead read;

  OneMaterial(const InputFolder& folder, const Json& material, const std::vector<std::string>& pictures = {})
      : read(folder, model(material, pictures)) {}
  static GltfModel model(const Json& material, const std::vector<std::string>& pictures) {
    GltfModel result = with_material(material);
    for (const std::string& picture : pictures) {
      const int image = result.push("images", {{"uri", picture}});
      result.push("textures", {{"source", image}});
    }
    return result;
  }
  const Material* operator->() const { return &read.material(); }
  const TextureImage& picture() const { return read.library.textures.images().at(read.material().color.image); }
  bool notes(const char* part) const { return read.library.notes.at(0).find(part) != std::string::npos; }
  bool warns(const char* part) const { return joined(read.library.warnings).find(part) != std::string::npos; }
};

/// Writes a picture of these bytes of sRGB, side by side.
void write_picture(const std::filesystem::path& file, const std::vector<std::array<int, 3>>& pixels) {
  Image image(static_cast<int>(pixels.size()), 1);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      image.pixels[i][c] = srgb_byte_to_linear(static_cast<std::uint8_t>(pixels[i][static_cast<std::size_t>(c)]));
    }
  }
  write_png(file, image);
}

Json metal_rough(const Json& members) { return {{"pbrMetallicRoughness", members}}; }
Json extension(const char* name, const Json& members) { return {{"extensions", {{name, members}}}}; }
Json joined_with(Json a, const Json& b) {
  a.update(b, /*merge_objects=*/true);
  return a;
}

const Json kPlain = metal_rough({{"metallicFactor", 0}});

}  // namespace

TEST_CASE("metallic and roughness decide between metal and lambertian", "[unit]") {
  const InputFolder folder;
  const OneMaterial metal(folder, metal_rough({{"baseColorFactor", {0.9, 0.5, 0.25, 1}}, {"roughnessFactor", 0}}));
  CHECK(metal->kind == Material::Kind::metal);
  CHECK(metal->color.a == Rgb(0.9f, 0.5f, 0.25f));
  CHECK(metal->fuzz == 0.0f);
  CHECK(metal->name == "material 0");
  const OneMaterial rough(folder, metal_rough({{"roughnessFactor", 0.5}}));
  CHECK(rough->fuzz == fuzz_of_roughness(0.5f));
  const OneMaterial diffuse(folder, {{"name", "wall"}, {"pbrMetallicRoughness", {{"metallicFactor", 0.25}}}});
  CHECK(diffuse->kind == Material::Kind::lambertian);
  CHECK(diffuse->color.a == Rgb(1.0f));
  CHECK(any_line(diffuse.read.library.notes, folder.at("a.gltf"),
                 {"material \"wall\": lambertian, albedo (1, 1, 1); left out: its metallic part (0.25)"}));
}

TEST_CASE("a material that transmits is a dielectric, with its index of refraction", "[unit]") {
  const InputFolder folder;
  Json glass = joined_with(kPlain, extension("KHR_materials_transmission", {{"transmissionFactor", 1}}));
  CHECK(OneMaterial(folder, glass)->kind == Material::Kind::dielectric);
  CHECK(OneMaterial(folder, glass)->index == 1.5f);
  glass["extensions"]["KHR_materials_ior"] = {{"ior", 1.33}};
  CHECK(OneMaterial(folder, glass)->index == 1.33f);
  glass["extensions"]["KHR_materials_ior"] = {{"ior", 0}};
  CHECK(OneMaterial(folder, glass)->index == 1.5f);
  CHECK(OneMaterial(folder, glass).warns("index of refraction of 0"));
  write_picture(folder / "quarter.png", {{51, 0, 0}});
  glass["extensions"]["KHR_materials_transmission"]["transmissionTexture"] = {{"index", 0}};
  const OneMaterial little(folder, glass, {"quarter.png"});
  CHECK(little->kind == Material::Kind::lambertian);
  CHECK(little.notes("its transmission (0.2)"));
}

TEST_CASE("a material that emits is a light of its colour times its strength", "[unit]") {
  const InputFolder folder;
  Json light = {{"emissiveFactor", {1, 0.5, 0}}};
  CHECK(OneMaterial(folder, light)->kind == Material::Kind::diffuse_light);
  CHECK(OneMaterial(folder, light)->color.a == Rgb(1.0f, 0.5f, 0.0f));
  light.update(extension("KHR_materials_emissive_strength", {{"emissiveStrength", 8.5}}));
  CHECK(OneMaterial(folder, light)->color.a == Rgb(8.5f, 4.25f, 0.0f));
  write_picture(folder / "a.png", {{255, 255, 0}, {0, 0, 0}});
  light["emissiveTexture"] = {{"index", 0}};
  const OneMaterial shown(folder, light, {"a.png"});
  CHECK(shown->color.kind == Texture::Kind::image);
  CHECK(shown.picture().texels == std::vector<Rgb>{Rgb(8.5f, 4.25f, 0.0f), Rgb(0.0f)});
  write_picture(folder / "b.png", {{255, 255, 0}, {0, 0, 0}, {0, 0, 0}});
  const OneMaterial dark(folder, light, {"b.png"});
  CHECK(dark->kind == Material::Kind::metal);
  CHECK(dark.notes("its emission"));
  light["emissiveFactor"] = {0, 0, 0};
  CHECK(OneMaterial(folder, light, {"a.png"})->kind == Material::Kind::metal);
}

TEST_CASE("a picture is the albedo as it is, or times the factor beside it", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a.png", {{255, 255, 255}, {255, 0, 188}});
  Json material = joined_with(kPlain, metal_rough({{"baseColorTexture", {{"index", 0}}}}));
  const OneMaterial plain(folder, material, {"a.png"});
  CHECK(plain->color.kind == Texture::Kind::image);
  CHECK(plain.picture().name == "a.png");
  CHECK(plain.picture().texels[0] == Rgb(1.0f));
  CHECK(plain.read.library.textures.files() == std::vector<std::filesystem::path>{folder / "a.png"});
  material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 1, 1};
  const OneMaterial tinted(folder, material, {"a.png"});
  CHECK(tinted.picture().texels == std::vector<Rgb>{Rgb(0.5f, 0.25f, 1.0f), Rgb(0.5f, 0.0f, srgb_byte_to_linear(188))});
  CHECK(tinted.picture().mean.r == 0.5f);
  CHECK(tinted.read.library.files.back() == folder / "a.png");
}

TEST_CASE("pictures lie in files, in data URIs or in bufferViews", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a b.png", {{255, 0, 0}});
  const std::string bytes = read_text(folder / "a b.png");
  const Json material = joined_with(kPlain, metal_rough({{"baseColorTexture", {{"index", 0}}}}));
  GltfModel model = with_material(material);
  model.push("textures", {{"source", 0}});
  const int view = model.view(bytes);
  for (const Json& image :
       {Json{{"uri", "a%20b.png"}}, Json{{"uri", "a b.png"}}, Json{{"uri", "data:image/png;base64," + base64(bytes)}},
        Json{{"bufferView", view}, {"mimeType", "image/png"}}}) {
    INFO(image.dump().substr(0, 40));
    model.root["images"] = Json::array({image});
    for (const auto& file : {folder.write("a.gltf", model.gltf()), folder.write("a.glb", model.glb())}) {
      const GltfRead read(file);
      CHECK(read.library.warnings.empty());
      REQUIRE(read.library.textures.images().size() == 1);
      CHECK(read.library.textures.images()[0].texels == std::vector<Rgb>{Rgb(1.0f, 0.0f, 0.0f)});
    }
  }
}

TEST_CASE("one picture of two materials is read once", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a.png", {{255, 0, 0}});
  const Json material = joined_with(kPlain, metal_rough({{"baseColorTexture", {{"index", 0}}}}));
  GltfModel model = with_material(material);
  model.push("textures", {{"source", 0}});
  model.push("images", {{"bufferView", model.view(read_text(folder / "a.png"))}});
  model.push("materials", material);
  model.mesh({{"POSITION", 0}}, {{"material", 1}});
  const GltfRead read(folder, model);
  CHECK(read.library.materials.size() == 2);
  CHECK(read.library.textures.images().size() == 1);
}

TEST_CASE("a missing picture is magenta with a warning, one that is damaged an error", "[unit]") {
  const InputFolder folder;
  const Json material = joined_with(kPlain, metal_rough({{"baseColorTexture", {{"index", 0}}}}));
  for (const char* name : {"none.png", "http://example.org/a.png", "a%00.png", "a\n.png"}) {
    const OneMaterial missing(folder, material, {name});
    CHECK(missing->color.a == Rgb(1.0f, 0.0f, 1.0f));
    CHECK(missing.warns("the picture of texture 0 is missing: magenta in its place"));
  }
  GltfModel without_source = with_material(material);
  without_source.push("textures", Json::object());
  CHECK(GltfRead(folder, without_source).material().color.a == Rgb(1.0f, 0.0f, 1.0f));
  expect_error(ErrorKind::input, folder.at("a.gltf: image 0"), {"neither PNG nor JPEG"},
               [&] { OneMaterial(folder, material, {"data:image/png;base64,AAAA"}); });
  expect_error(ErrorKind::input, folder.at("a.gltf: image 0"), {"it is empty"},
               [&] { OneMaterial(folder, material, {"data:,"}); });
  expect_error(ErrorKind::input, folder.at("a.gltf: image 0"), {"not readable as a picture"},
               [&] { OneMaterial(folder, material, {"data:image/png;base64," + base64("\x89PNG\r\n\x1a\n")}); });
}

TEST_CASE("metalness and roughness are times the means of a picture's bytes, which are no sRGB", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a.png", {{0, 51, 255}, {0, 255, 153}});
  const OneMaterial metal(folder, metal_rough({{"metallicRoughnessTexture", {{"index", 0}}}, {"roughnessFactor", 0.5}}),
                          {"a.png"});
  CHECK(metal->kind == Material::Kind::metal);
  CHECK(metal->fuzz == fuzz_of_roughness(0.3f));
  CHECK(metal.notes("how its metalness and roughness vary, its part that is no metal (0.2)"));
  CHECK(metal.read.library.files.back() == folder / "a.png");
  CHECK(metal.read.library.textures.images().empty());
}

TEST_CASE("of specular-glossiness materials the diffuse part is read, and unlit ones are lambertian", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a.png", {{255, 0, 0}});
  Json material = extension("KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.25, 0.5, 0.75, 1}}});
  const OneMaterial diffuse(folder, material);
  CHECK(diffuse->kind == Material::Kind::lambertian);
  CHECK(diffuse->color.a == Rgb(0.25f, 0.5f, 0.75f));
  CHECK(diffuse.notes("its gloss (roughness 0)"));
  material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {{"diffuseTexture", {{"index", 0}, {"texCoord", 1}}}};
  const OneMaterial textured(folder, material, {"a.png"});
  CHECK(textured.picture().texels == std::vector<Rgb>{Rgb(1.0f, 0.0f, 0.0f)});
  CHECK(textured.read.mesh.texcoords[0] == vec2(0.5f, 0.5f));
  const OneMaterial unlit(folder, extension("KHR_materials_unlit", Json::object()));
  CHECK(unlit->kind == Material::Kind::lambertian);
  CHECK(unlit->color.a == Rgb(1.0f));
}

TEST_CASE("texture coordinates are those that the texture names, as KHR_texture_transform moves them", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a.png", {{255, 0, 0}});
  const auto texcoords = [&](const Json& more) {
    Json texture = {{"index", 0}};
    texture.update(more);
    const OneMaterial read(folder, joined_with(kPlain, metal_rough({{"baseColorTexture", texture}})), {"a.png"});
    return read.read.mesh.texcoords;
  };
  const auto transformed = [&](const Json& transform) {
    return texcoords({{"extensions", {{"KHR_texture_transform", transform}}}});
  };
  const auto near_to = [](const vec2& a, const vec2& b) { return glm::length(a - b) < 1e-6f; };
  // In the file: (0, 0), (1, 0), (0, 0.25), with v downwards.
  CHECK(texcoords(Json::object()) == std::vector<vec2>{vec2(0, 1), vec2(1, 1), vec2(0, 0.75f)});
  CHECK(texcoords({{"texCoord", 1}}) == std::vector<vec2>{vec2(0.5f, 0.5f), vec2(1, 0), vec2(2, -1)});
  CHECK(transformed({{"offset", {0.5, 0.25}}, {"scale", {2, 4}}}) ==
        std::vector<vec2>{vec2(0.5f, 0.75f), vec2(2.5f, 0.75f), vec2(0.5f, -0.25f)});
  CHECK(transformed({{"texCoord", 1}, {"scale", {2, 2}}})[1] == vec2(2, -1));
  const auto turned = transformed({{"rotation", 1.5707963267948966}, {"scale", {1, 4}}, {"offset", {0, 1}}});
  CHECK(near_to(turned[1], vec2(0, 1)));  // (1, 0) goes to (0, -1)
  CHECK(near_to(turned[2], vec2(1, 0)));  // (0, 1) goes to (1, 0)
}

TEST_CASE("two materials that place one picture differently have texture coordinates of their own", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a.png", {{255, 0, 0}});
  const Json texture = {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}};
  GltfModel model = OneMaterial::model(joined_with(kPlain, metal_rough({{"baseColorTexture", texture}})), {"a.png"});
  model.push("materials", joined_with(kPlain, metal_rough({{"baseColorTexture", {{"index", 0}}}})));
  Json& primitives = model.root["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["material"] = 1;
  const GltfRead read(folder, model);
  CHECK(read.mesh.texcoords.size() == 6);
  CHECK(read.mesh.texcoords[0] == vec2(0.5f, 1));
  CHECK(read.mesh.texcoords[3] == vec2(0, 1));
}

TEST_CASE("triangles have the materials of their primitives, in the order of use, or grey", "[unit]") {
  const InputFolder folder;
  GltfModel model = with_material(kPlain);
  model.push("materials", metal_rough(Json::object()));
  model.push("materials", {{"name", "unused"}});
  model.mesh({{"POSITION", 0}}, {{"material", 1}});
  model.mesh({{"POSITION", 0}});
  model.mesh({{"POSITION", 0}}, {{"material", 0}});
  const GltfRead read(folder, model);
  CHECK(read.materials.per_triangle == std::vector<std::uint16_t>{0, 1, 2, 0});
  REQUIRE(read.library.materials.size() == 3);
  CHECK(read.material(1).kind == Material::Kind::metal);
  CHECK(read.material(2).color.a == Rgb(0.5f));
  CHECK(read.library.notes.size() == 3);
}

TEST_CASE("one material of all primitives is not said for each triangle", "[unit]") {
  const InputFolder folder;
  GltfModel model = with_material(kPlain);
  model.mesh({{"POSITION", 0}}, {{"material", 0}});
  CHECK(GltfRead(folder, model).materials.per_triangle.empty());
}

TEST_CASE("materials that the scene gives are not read, nor are their pictures", "[unit]") {
  const InputFolder folder;
  const Json material = metal_rough({{"baseColorTexture", {{"index", 0}}}});
  const GltfRead read(folder.write("a.gltf", OneMaterial::model(material, {"none.png"}).gltf()),
                      {/*ignore_materials=*/true});
  CHECK(read.library.materials.empty());
  CHECK(read.library.warnings.empty());
  CHECK(read.materials.per_triangle.empty());
  CHECK(read.mesh.texcoords.size() == 3);
}

TEST_CASE("what of materials is not shown or out of range is said", "[unit]") {
  const InputFolder folder;
  write_picture(folder / "a.png", {{255, 0, 0}});
  Json material = {{"name", "glow"}, {"alphaMode", "BLEND"}, {"normalTexture", {{"index", 0}}}};
  material.update(metal_rough({{"baseColorFactor", {2, 0.5, -1, 1}}}));
  const OneMaterial read(folder, material, {"a.png"});
  CHECK(read->color.a == Rgb(1.0f, 0.5f, 0.0f));
  for (const char* part :
       {"transparency (alpha)", "normal maps", "material \"glow\" has albedo (2, 0.5, -1), clamped"}) {
    CHECK(read.warns(part));
  }
  GltfModel model =
      OneMaterial::model(joined_with(kPlain, metal_rough({{"baseColorTexture", {{"index", 0}}}})), {"a.png"});
  model.root["textures"][0]["sampler"] = 0;
  model.push("samplers", {{"wrapS", 33071}});
  const GltfRead clamped(folder, model);
  CHECK(any_line(clamped.library.warnings, folder.at("a.gltf"), {"wrapping of textures"}));
}
