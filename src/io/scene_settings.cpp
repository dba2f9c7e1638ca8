// [camera], [render] and [background].
#include <algorithm>
#include <cstdint>
#include <initializer_list>

#include "file_bytes.hpp"
#include "raylab/image/image_file.hpp"
#include "scene_sections.hpp"
#include "texture_files.hpp"
#include "toml_reader.hpp"

namespace raylab {
namespace {

constexpr Numbers kFieldOfView = {"a number of degrees in (0, 180)", [](float x) { return x > 0.0f && x < 180.0f; }};
constexpr Numbers kConeAngle = {"a number of degrees in [0, 180)", [](float x) { return x >= 0.0f && x < 180.0f; }};

/// Throws at the first of the keys that the table has, or at the table.
[[noreturn]] void fail_at(const TomlValue& table, std::initializer_list<const char*> keys, const std::string& message) {
  for (const char* key : keys) {
    if (const TomlValue* value = table.find(key)) value->fail_here(message);
  }
  table.fail_here(message);
}

void check_view(const CameraSettings& camera, const TomlValue& table, const std::string& path) {
  const dvec3 view = dvec3(camera.look_at) - dvec3(camera.look_from);
  const dvec3 up(camera.up);
  if (view == dvec3(0.0)) {
    fail_at(table, {"look_at", "look_from"}, path + ": look_from and look_at are the same point");
  }
  if (up == dvec3(0.0)) fail_at(table, {"up"}, path + ".up: found a vector of length zero, expected a direction");
  // The same to within rounding of the float components.
  if (glm::length(glm::cross(glm::normalize(view), glm::normalize(up))) < 1e-6) {
    fail_at(table, {"up", "look_at", "look_from"}, path + ": the view from look_from to look_at runs along up");
  }
}

void read_camera_keys(TableReader& reader, CameraSettings& camera) {
  reader.vector("look_from", camera.look_from, kAnyNumber);
  reader.vector("look_at", camera.look_at, kAnyNumber);
  reader.vector("up", camera.up, kAnyNumber);
  reader.number("vfov", camera.vfov, kFieldOfView);
  reader.number("defocus_angle", camera.defocus_angle, kConeAngle);
  reader.number("focus_distance", camera.focus_distance, kPositive);
}

/// Subtracts where the table has a position under this key.
void move_position(TomlValue& table, std::string_view key, const dvec3& origin) {
  TomlValue* value = table.is_table() ? table.find(key) : nullptr;
  if (value == nullptr || !value->is_array() || value->items.size() != 3) return;
  for (int axis = 0; axis < 3; ++axis) {
    TomlValue& number = value->items[static_cast<std::size_t>(axis)];
    if (number.kind == TomlValue::Kind::integer) {
      number.kind = TomlValue::Kind::real;
      number.real = static_cast<double>(number.integer);
    }
    if (number.kind == TomlValue::Kind::real) number.real -= origin[axis];
  }
}

}  // namespace

dvec3 move_to_origin(TomlValue& root) {
  const TomlValue* value = root.find("origin");
  if (value == nullptr) return dvec3(0.0);
  const dvec3 origin = dvec3_of(*value, "origin");
  const auto move_each = [&](std::string_view tables, std::initializer_list<std::string_view> keys) {
    TomlValue* array = root.find(tables);
    if (array == nullptr || !array->is_array()) return;
    for (TomlValue& table : array->items) {
      for (const std::string_view key : keys) move_position(table, key, origin);
    }
  };
  if (TomlValue* camera = root.find("camera")) {
    for (const char* key : {"look_from", "look_at"}) move_position(*camera, key, origin);
  }
  move_each("view", {"look_from", "look_at"});
  move_each("sphere", {"center"});
  return origin;
}

CameraSettings read_camera(const TomlValue* table) {
  CameraSettings camera;
  if (table == nullptr) return camera;
  TableReader reader(*table, "camera");
  read_camera_keys(reader, camera);
  reader.finish();
  check_view(camera, *table, "camera");
  return camera;
}

std::vector<NamedView> read_views(std::span<const TomlValue> tables, const CameraSettings& camera) {
  std::vector<NamedView> views;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string path = "view." + std::to_string(i);
    TableReader reader(tables[i], path);
    NamedView view{"", camera};
    reader.string("name", view.name);
    read_camera_keys(reader, view.camera);
    reader.finish();
    const TomlValue& name = reader.require("name");
    constexpr const char* letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    if (view.name.find_first_not_of(letters) != std::string::npos) {
      name.fail(path + ".name", "a name of letters, digits, - and _, as files are named after it");
    }
    const bool taken = std::any_of(views.begin(), views.end(), [&](const NamedView& v) { return v.name == view.name; });
    if (taken) name.fail(path + ".name", "a name that no view before it has");
    check_view(view.camera, tables[i], path);
    views.push_back(std::move(view));
  }
  return views;
}

RenderSettings read_render(const TomlValue* table) {
  RenderSettings render;
  if (table == nullptr) return render;
  TableReader reader(*table, "render");
  reader.count("width", render.width);
  reader.count("height", render.height);
  reader.count("samples_per_pixel", render.samples_per_pixel);
  reader.count("max_depth", render.max_depth);
  reader.finish();
  if (std::int64_t{render.width} * render.height > kMostPixels) {
    fail_at(*table, {"width", "height"},
            "render: found " + std::to_string(render.width) + " x " + std::to_string(render.height) +
                " pixels, expected at most " + std::to_string(kMostPixels));
  }
  return render;
}

Environment read_background(const TomlValue* table, const std::filesystem::path& folder,
                            std::vector<std::filesystem::path>& files) {
  Environment environment;
  if (table == nullptr) return environment;
  TableReader reader(*table, "background");
  const TomlValue* color = reader.find("color");
  const TomlValue* bottom = reader.find("bottom");
  const TomlValue* top = reader.find("top");
  const TomlValue* image = reader.find("image");
  reader.finish();
  const int ways = (color != nullptr) + (bottom != nullptr || top != nullptr) + (image != nullptr);
  if (ways > 1) {
    fail_at(*table, {"image", "bottom", "top"}, "background: expected only one of color, bottom with top, image");
  }
  if ((bottom == nullptr) != (top == nullptr)) {
    fail_at(*table, {"bottom", "top"}, "background: expected bottom and top together");
  }
  if (color != nullptr) environment.bottom = vec3_of(*color, "background.color", kNotNegative);
  if (bottom != nullptr) {
    environment.kind = Environment::Kind::gradient;
    environment.bottom = vec3_of(*bottom, "background.bottom", kNotNegative);
    environment.top = vec3_of(*top, "background.top", kNotNegative);
  }
  if (image != nullptr) {
    const std::string name = string_of(*image, "background.image");
    const std::filesystem::path file = folder / name;
    if (lowercase_ending(file) != ".exr") image->fail("background.image", "the name of an EXR file");
    if (!is_file(file)) image->fail("background.image", "an existing file");
    environment.kind = Environment::Kind::image;
    environment.picture = read_texture(file, name);
    files.push_back(file);
  }
  return environment;
}

}  // namespace raylab
