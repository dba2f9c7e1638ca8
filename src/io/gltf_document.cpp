#include "gltf_document.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "file_bytes.hpp"
#include "message_text.hpp"
#include "raylab/core/error.hpp"
#include "uri_text.hpp"

namespace raylab {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// Extensions that the picture takes account of.
constexpr std::array kUnderstood = {"KHR_materials_emissive_strength",
                                    "KHR_materials_ior",
                                    "KHR_materials_pbrSpecularGlossiness",
                                    "KHR_materials_transmission",
                                    "KHR_materials_unlit",
                                    "KHR_mesh_quantization",
                                    "KHR_texture_transform"};

constexpr char kPlaceholder = '\1';

bool is_understood(const std::string& extension) {
  return std::find(kUnderstood.begin(), kUnderstood.end(), extension) != kUnderstood.end();
}

std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
  return value;
}

/// One past the quote that ends a JSON text whose opening quote stands at `start`; the end where none does.
std::size_t end_of_text(std::string_view json, std::size_t start) {
  for (std::size_t at = json.find('"', start + 1); at != std::string_view::npos; at = json.find('"', at + 1)) {
    std::size_t backslashes = 0;
    while (json[at - 1 - backslashes] == '\\') ++backslashes;
    if (backslashes % 2 == 0) return at + 1;
  }
  return json.size();
}

}  // namespace

GltfDocument::GltfDocument(MaterialLibrary& library, const fs::path& file)
    : library_(library), file_(file), content_(read_file(file)), size_(content_.size()) {
  library.files.push_back(file);
  const auto [text, binary] = chunks();
  Sections sections;
  read_model(take_apart(text, sections));
  for (const std::string& extension : model_.extensionsUsed) {
    if (!is_understood(extension)) warn("its extension " + in_quotes(extension) + " is left out");
  }
  for (const char* name : {"animations", "cameras", "skins"}) {
    const auto section = sections.find(name);
    if (section == sections.end() || trimmed(section->second) == "[]") continue;
    warn("its " + std::string(name) + " are left out");
  }
  images_ = array_of(sections, "images");
  read_buffers(array_of(sections, "buffers"), binary);
}

void GltfDocument::warn(const std::string& message) {
  if (warned_.insert(message).second) library_.warnings.push_back(file_.string() + ": " + message);
}

void GltfDocument::fail(const std::string& message) const { throw Error(ErrorKind::input, file_.string(), message); }

GltfDocument::Chunks GltfDocument::chunks() const {
  const std::string_view bytes = content_;
  if (!bytes.starts_with("glTF")) return {bytes, {}};
  constexpr std::size_t header = 12, chunk_header = 8;
  if (bytes.size() < header) fail("a GLB file that ends in its header");
  if (const std::uint32_t version = little_endian(bytes.substr(4)); version != 2) {
    fail("found GLB version " + std::to_string(version) + ", expected 2");
  }
  const std::size_t length = little_endian(bytes.substr(8));
  if (length > bytes.size()) {
    fail("found " + std::to_string(bytes.size()) + " bytes, expected " + std::to_string(length) +
         " as its header says: is the file truncated?");
  }
  Chunks result;
  for (std::size_t at = header; at + chunk_header <= length;) {
    const std::size_t size = little_endian(bytes.substr(at));
    const std::uint32_t type = little_endian(bytes.substr(at + 4));
    at += chunk_header;
    if (size > length - at) fail("a chunk of " + std::to_string(size) + " bytes goes beyond the end of the file");
    constexpr std::uint32_t json_type = 0x4e4f534a, binary_type = 0x004e4942;
    const std::string_view chunk = bytes.substr(at, size);
    if (type == json_type && result.json.data() == nullptr) result.json = chunk;
    if (type == binary_type && result.binary.data() == nullptr) result.binary = chunk;
    at += size;
  }
  if (result.json.data() == nullptr) fail("a GLB file without a JSON chunk");
  return result;
}

/// Returns the JSON text with 0 in place of what tinygltf is not to read, which goes to `sections`. What comes after
/// recurs, and takes some hundreds of bytes for a value, so both are limited.
std::string GltfDocument::take_apart(std::string_view text, Sections& sections) const {
  constexpr int most_levels = 64;
  constexpr std::size_t most_values = std::size_t{1} << 23;
  constexpr std::array cut = {"animations", "buffers", "cameras", "images", "skins"};
  std::string rest;
  std::string_view name;   // of the outermost object's member at hand
  std::size_t value = 0;   // where it begins; 0 before its colon
  std::size_t copied = 0;  // so far, into `rest`
  std::size_t values = 0;
  int depth = 0;
  const auto end_member = [&](std::size_t end) {
    if (depth != 1 || value == 0) return;
    if (std::find(cut.begin(), cut.end(), name) != cut.end()) {
      const std::string_view section = text.substr(value, end - value);
      if (!sections.emplace(name, section).second) fail("two members of the name " + in_quotes(name));
      rest.append(text, copied, value - copied).append("0");
      rest.append(static_cast<std::size_t>(std::count(section.begin(), section.end(), '\n')), '\n');
      copied = end;
    }
    value = 0;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    switch (text[i]) {
      case '"': {
        const std::size_t end = end_of_text(text, i);
        if (depth == 1 && value == 0) name = text.substr(i + 1, end - i - 2);
        i = end - 1;
        break;
      }
      case ':':
        if (depth == 1 && value == 0) value = i + 1;
        break;
      case '[':
      case '{':
        if (++depth > most_levels) fail("nested more than " + std::to_string(most_levels) + " deep");
        ++values;
        break;
      case ']':
      case '}':
        end_member(i);
        --depth;
        break;
      case ',':
        end_member(i);
        ++values;
        break;
      default:
        break;
    }
  }
  if (values > most_values) fail("more than " + std::to_string(most_values) + " values in its JSON");
  rest.append(text, copied, text.size() - copied);
  return rest;
}

/// Data URIs, which may be nearly all of the file, do not go through the parser: in their place stands kPlaceholder and
/// their number.
json GltfDocument::array_of(const Sections& sections, const char* name) {
  const auto found = sections.find(name);
  if (found == sections.end()) return json::array();
  const std::string_view section = found->second;
  std::string text;
  std::size_t copied = 0;
  for (std::size_t at = section.find('"'), end = 0; at != std::string_view::npos; at = section.find('"', end)) {
    end = end_of_text(section, at);
    const std::string_view uri = section.substr(at + 1, end - at - 2);
    if (!uri.starts_with("data:") || uri.find('\\') != std::string_view::npos) continue;
    text.append(section, copied, at + 1 - copied).append("\\u0001").append(std::to_string(data_.size()));
    data_.push_back(uri);
    copied = end - 1;
  }
  text.append(section, copied);
  json values = json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto is_object = [](const json& value) { return value.is_object(); };
  if (!values.is_array() || !std::all_of(values.begin(), values.end(), is_object)) {
    fail(in_quotes(name) + " is no JSON array of objects");
  }
  return values;
}

void GltfDocument::read_model(const std::string& text) {
  std::string error, warning;
  bool read = false;
  try {
    if (text.size() > std::numeric_limits<unsigned int>::max()) fail("more than 4 GiB of JSON");
    tinygltf::TinyGLTF reader;
    read =
        reader.LoadASCIIFromString(&model_, &error, &warning, text.data(), static_cast<unsigned int>(text.size()), "");
  } catch (const json::exception& e) {
    error = e.what();
  }
  const std::string& version = model_.asset.version;
  if ((read || version != "2.0") && !version.starts_with("2.")) {
    fail("found glTF version " + in_quotes(version) + ", expected 2.0");
  }
  // Before errors, as it is what they come from: data that are compressed look incomplete.
  for (const std::string& extension : model_.extensionsRequired) {
    if (is_understood(extension) || extension.starts_with("KHR_materials_")) continue;
    fail("it needs the extension " + in_quotes(extension) + ", which is not understood");
  }
  // Of what it understands only in part, tinygltf says so and goes on.
  constexpr std::size_t longest = 300;
  if (!read || !error.empty()) {
    fail("not readable as glTF: " + std::string(trimmed(on_one_line(error.substr(0, longest)))));
  }
}

GltfDocument::Resource GltfDocument::resource(const std::string& name, const std::string& what) const {
  std::string_view uri = name;
  std::size_t number = 0;
  if (uri.starts_with(kPlaceholder) && std::from_chars(&uri[1], uri.data() + uri.size(), number).ec == std::errc() &&
      number < data_.size()) {
    uri = data_[number];
  }
  if (!uri.starts_with("data:")) {
    const std::string decoded = with_percents_decoded(uri);
    const bool is_name = std::none_of(decoded.begin(), decoded.end(), [](unsigned char c) { return c < 0x20; });
    const fs::path file = file_.parent_path() / decoded;
    return {is_name && is_file(file) ? file : fs::path(), std::nullopt};
  }
  const auto comma = uri.find(',');
  if (comma == std::string_view::npos) fail(what + ": a data URI without a comma");
  const std::string_view data = uri.substr(comma + 1);
  if (!uri.substr(0, comma).ends_with(";base64")) return {{}, with_percents_decoded(data)};
  auto bytes = from_base64(data);
  if (!bytes) fail(what + ": its data URI is no base64");
  return {{}, std::move(bytes)};
}

void GltfDocument::read_buffers(const json& buffers, std::string_view binary) {
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string what = "buffer " + std::to_string(i);
    const auto length = buffers[i].find("byteLength"), uri = buffers[i].find("uri");
    if (length == buffers[i].end() || !length->is_number_unsigned()) fail(what + ": it has no byteLength");
    std::string_view bytes;
    if (uri != buffers[i].end()) {
      if (!uri->is_string()) fail(what + ": its uri is no text");
      const auto& name = uri->get_ref<const std::string&>();
      Resource found = resource(name, what);
      if (found.bytes) {
        bytes = decoded_.emplace_back(std::move(*found.bytes));
      } else {
        if (found.file.empty()) fail(what + ": its file " + in_quotes(name) + " is missing");
        const auto [companion, is_new] = companions_.try_emplace(fs::weakly_canonical(found.file));
        if (is_new) {
          companion->second = read_file(found.file);
          library_.files.push_back(found.file);
          size_ += companion->second.size();
        }
        bytes = companion->second;
      }
    } else if (i == 0 && binary.data() != nullptr) {
      bytes = binary;
    } else {
      fail(what + ": it has no uri");
    }
    const auto size = length->get<std::uint64_t>();
    if (size > bytes.size()) {
      fail(what + ": found " + std::to_string(bytes.size()) + " bytes, expected " + std::to_string(size));
    }
    buffers_.push_back(bytes.substr(0, size));
  }
}

std::string_view GltfDocument::view(int buffer_view) const {
  const std::string what = "bufferView " + std::to_string(buffer_view);
  const auto at = static_cast<std::size_t>(buffer_view);
  if (buffer_view < 0 || at >= model_.bufferViews.size()) fail("there is no " + what);
  const tinygltf::BufferView& view = model_.bufferViews[at];
  const auto buffer = static_cast<std::size_t>(view.buffer);
  if (view.buffer < 0 || buffer >= buffers_.size()) {
    fail(what + ": there is no buffer " + std::to_string(view.buffer));
  }
  const std::string_view bytes = buffers_[buffer];
  if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) {
    fail(what + ": it goes beyond the end of buffer " + std::to_string(buffer));
  }
  return bytes.substr(view.byteOffset, view.byteLength);
}

std::optional<GltfDocument::Image> GltfDocument::image(int index) {
  const std::string what = "image " + std::to_string(index);
  if (index < 0 || static_cast<std::size_t>(index) >= images_.size()) fail("there is no " + what);
  const json& entry = images_[static_cast<std::size_t>(index)];
  const auto uri = entry.find("uri"), buffer_view = entry.find("bufferView"), name = entry.find("name");
  Image result{name != entry.end() && name->is_string() ? name->get<std::string>() : what, {}, {}};
  if (uri != entry.end() && uri->is_string()) {
    auto known = decoded_image_.find(index);
    if (known == decoded_image_.end()) {
      Resource found = resource(uri->get_ref<const std::string&>(), what);
      if (!found.bytes) {
        if (found.file.empty()) return std::nullopt;
        result.name = uri->get<std::string>();
        result.file = std::move(found.file);
        return result;
      }
      decoded_.push_back(std::move(*found.bytes));
      known = decoded_image_.emplace(index, decoded_.size() - 1).first;
    }
    result.bytes = decoded_[known->second];
    return result;
  }
  if (buffer_view == entry.end() || !buffer_view->is_number_integer())
    fail(what + ": it has neither uri nor bufferView");
  const auto view_index = buffer_view->get<std::int64_t>();
  if (view_index < 0 || view_index > std::numeric_limits<int>::max()) {
    fail(what + ": there is no bufferView " + std::to_string(view_index));
  }
  result.bytes = view(static_cast<int>(view_index));
  return result;
}

}  // namespace raylab
