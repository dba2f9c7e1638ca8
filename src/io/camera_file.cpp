#include "raylab/io/camera_file.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

#include "file_bytes.hpp"
#include "message_text.hpp"
#include "raylab/core/atomic_file.hpp"
#include "raylab/core/error.hpp"
#include "scene_sections.hpp"
#include "toml_reader.hpp"
#include "toml_value.hpp"

namespace raylab {
namespace {

/// Bytes [at, at + length) of the text give way to `text`.
struct Edit {
  std::size_t at;
  std::size_t length;
  std::string text;
};

/// Offset of a "file:line:column" in the text. Columns count characters, but before a camera's value there are
/// only ASCII ones on its line, a byte order mark aside.
std::size_t offset_of(std::string_view text, const std::string& location) {
  const std::size_t column_colon = location.rfind(':');
  const std::size_t line_colon = location.rfind(':', column_colon - 1);
  std::size_t line = 1, column = 1;
  std::from_chars(location.data() + line_colon + 1, location.data() + column_colon, line);
  std::from_chars(location.data() + column_colon + 1, location.data() + location.size(), column);
  std::size_t at = line == 1 && text.starts_with("\xef\xbb\xbf") ? 3 : 0;
  for (; line > 1; --line) at = text.find('\n', at) + 1;
  return std::min(at + column - 1, text.size());
}

std::size_t number_end(std::string_view text, std::size_t at) {
  return std::min(text.find_first_of(" \t\r\n,]}#", at), text.size());
}

/// One past the value that starts at `at`: a number, or an array of numbers, which may hold comments.
std::size_t value_end(std::string_view text, std::size_t at) {
  if (text[at] != '[') return number_end(text, at);
  while (at < text.size() && text[at] != ']') {
    at = text[at] == '#' ? std::min(text.find('\n', at), text.size()) : at + 1;
  }
  return std::min(at + 1, text.size());
}

std::size_t line_end(std::string_view text, std::size_t at) {
  const std::size_t end = std::min(text.find('\n', at), text.size());
  return end > at && text[end - 1] == '\r' ? end - 1 : end;
}

/// Scene files are read as double and then rounded to float, which for a few shortest floats is another float.
/// Positions are relative to the scene's origin, and written as they are in the world.
std::string exact_text(float value, double origin) {
  if (origin != 0.0) return number_text(static_cast<double>(value) + origin);
  std::string text = number_text(value);
  double read = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), read);
  return static_cast<float>(read) == value ? text : number_text(static_cast<double>(value));
}

struct CameraKey {
  const char* name;
  std::vector<float> now;  ///< as the file says, or by default
  std::vector<float> next;
  dvec3 origin = dvec3(0.0);  ///< of a position

  std::string number(std::size_t i) const { return exact_text(next[i], origin[static_cast<int>(i)]); }
  std::string value() const {
    if (next.size() == 1) return number(0);
    std::string text = "[";
    for (std::size_t i = 0; i < next.size(); ++i) text.append(i > 0 ? ", " : "").append(number(i));
    return text.append("]");
  }
};

std::vector<float> numbers_of(const vec3& v) { return {v.x, v.y, v.z}; }

std::vector<CameraKey> camera_keys(const CameraSettings& now, const CameraSettings& next, const dvec3& origin) {
  return {{"look_from", numbers_of(now.look_from), numbers_of(next.look_from), origin},
          {"look_at", numbers_of(now.look_at), numbers_of(next.look_at), origin},
          {"up", numbers_of(now.up), numbers_of(next.up)},
          {"vfov", {now.vfov}, {next.vfov}},
          {"defocus_angle", {now.defocus_angle}, {next.defocus_angle}},
          {"focus_distance", {now.focus_distance}, {next.focus_distance}}};
}

/// Where the keys the file lacks go, and how they are written there.
Edit addition(std::string_view text, const TomlValue* table, const std::vector<CameraKey>& missing) {
  const std::string newline = text.find("\r\n") != std::string_view::npos ? "\r\n" : "\n";
  std::string lines;
  if (table == nullptr) {
    for (const CameraKey& key : missing) lines += std::string(key.name) + " = " + key.value() + newline;
    const bool ended = text.empty() || text.back() == '\n';
    return {text.size(), 0, (ended ? "" : newline) + newline + "[camera]" + newline + lines};
  }
  const std::size_t start = offset_of(text, table->location);
  const bool is_inline = text[start] == '{';
  std::size_t at = start + 1;
  for (const TomlValue& value : table->items) at = std::max(at, value_end(text, offset_of(text, value.location)));
  if (is_inline) {
    std::string separator = table->items.empty() ? " " : ", ";
    for (const CameraKey& key : missing) {
      lines += separator + key.name + " = " + key.value();
      separator = ", ";
    }
    return {at, 0, lines};
  }
  const std::string prefix = text[start] == '[' ? "" : "camera.";
  for (const CameraKey& key : missing) lines += newline + prefix + key.name + " = " + key.value();
  return {line_end(text, at), 0, lines};
}

bool same(const CameraSettings& a, const CameraSettings& b) {
  for (const CameraKey& key : camera_keys(a, b, dvec3(0.0))) {
    if (key.now != key.next) return false;
  }
  return true;
}

}  // namespace

std::string with_camera(std::string_view text, const std::string& file, const CameraSettings& camera) {
  TomlValue root = parse_toml(text, file);
  const dvec3 origin = move_to_origin(root);
  const TomlValue* table = root.find("camera");
  std::vector<Edit> edits;
  std::vector<CameraKey> missing;
  for (const CameraKey& key : camera_keys(read_camera(table), camera, origin)) {
    if (key.now == key.next) continue;
    const TomlValue* value = table == nullptr ? nullptr : table->find(key.name);
    if (value == nullptr) {
      missing.push_back(key);
      continue;
    }
    for (std::size_t i = 0; i < key.next.size(); ++i) {
      if (key.now[i] == key.next[i]) continue;
      const std::size_t at = offset_of(text, value->is_array() ? value->items[i].location : value->location);
      edits.push_back({at, number_end(text, at) - at, key.number(i)});
    }
  }
  if (!missing.empty()) edits.push_back(addition(text, table, missing));
  // From the back, so that earlier offsets stay right.
  std::stable_sort(edits.begin(), edits.end(), [](const Edit& a, const Edit& b) { return a.at > b.at; });
  std::string changed(text);
  for (const Edit& edit : edits) changed.replace(edit.at, edit.length, edit.text);

  // The text was edited by place, not written anew: what it now means is checked before anyone relies on it.
  const auto fail = [&] {
    throw Error(ErrorKind::failure, table == nullptr ? file : table->location,
                "this way of writing a camera cannot be changed in place");
  };
  try {
    TomlValue read_back = parse_toml(changed, file);
    move_to_origin(read_back);
    if (!same(read_camera(read_back.find("camera")), camera)) fail();
  } catch (const Error& e) {
    if (e.kind() == ErrorKind::failure) throw;
    fail();
  }
  return changed;
}

std::string with_view(std::string_view text, const std::string& file, const CameraSettings& camera, std::string& name) {
  TomlValue root = parse_toml(text, file);
  const dvec3 origin = move_to_origin(root);
  const std::vector<NamedView> views =
      read_views(tables_of(root.find("view"), "view"), read_camera(root.find("camera")));
  const auto taken = [&](const NamedView& view) { return view.name == name; };
  for (int number = 1; name.empty() || std::any_of(views.begin(), views.end(), taken); ++number) {
    name = "view-" + std::to_string(number);
  }
  const std::string newline = text.find("\r\n") != std::string_view::npos ? "\r\n" : "\n";
  std::string changed(text);
  if (!changed.empty() && changed.back() != '\n') changed += newline;
  changed += newline + "[[view]]" + newline + "name = \"" + name + "\"" + newline;
  for (const CameraKey& key : camera_keys(camera, camera, origin)) {
    changed += std::string(key.name) + " = " + key.value() + newline;
  }
  // An array written in one line, view = [...], takes no more tables.
  try {
    parse_toml(changed, file);
  } catch (const Error&) {
    throw Error(ErrorKind::failure, file, "a view cannot be added to views that are written this way");
  }
  return changed;
}

CameraFile::CameraFile(std::filesystem::path file) : file_(std::move(file)), text_(read_file(file_)) {}

void CameraFile::check_unchanged() {
  if (new_ && std::filesystem::exists(file_)) {
    throw Error(ErrorKind::output, file_.string(), "is there already, so it was left alone");
  }
  if (std::string now = new_ ? text_ : read_file(file_); now != text_) {
    text_ = std::move(now);
    throw Error(ErrorKind::output, file_.string(), "changed since it was read, so it was left alone");
  }
}

void CameraFile::replace(std::string text) {
  AtomicFile out(file_);
  out.stream() << text;
  out.commit();
  text_ = std::move(text);
  new_ = false;
}

bool CameraFile::write(const CameraSettings& camera) {
  check_unchanged();
  std::string next = with_camera(text_, file_.string(), camera);
  if (next == text_ && !new_) return false;
  replace(std::move(next));
  return true;
}

std::string CameraFile::add_view(const CameraSettings& camera) {
  check_unchanged();
  std::string name;
  replace(with_view(text_, file_.string(), camera, name));
  return name;
}

}  // namespace raylab
