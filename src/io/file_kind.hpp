#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace raylab {

/// What a file holds, as its content tells.
enum class FileKind : std::uint8_t {
  scene,
  obj,
  ply,
  stl,
  gltf,
  foreign,  ///< a model of a format that raylab-import reads, by its name alone
  other
};

struct FileContent {
  FileKind kind;
  std::string words;  ///< for messages: "a PLY model", "a PNG picture"
};

/// Looks at the first bytes of a file, not at its name. What is text of no other kind is a scene. Throws Error (input)
/// when it cannot be read.
FileContent content_of(const std::filesystem::path& file);

/// content_of() a file that is to be a model or, where `or_scene`, a scene. Throws Error (input) when it is neither,
/// and when its name says another kind than its content, as it then is not the file that was meant.
FileKind model_kind(const std::filesystem::path& file, bool or_scene);

}  // namespace raylab
