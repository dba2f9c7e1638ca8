#include "file_kind.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <string_view>

#include "file_bytes.hpp"
#include "raylab/core/error.hpp"
#include "raylab/image/image_file.hpp"

namespace raylab {
namespace {

using namespace std::string_view_literals;

struct Magic {
  std::string_view bytes;
  FileKind kind;
  const char* words;
};

constexpr std::array kMagic = {
    Magic{"ply\n"sv, FileKind::ply, "a PLY model"},
    Magic{"ply\r"sv, FileKind::ply, "a PLY model"},
    Magic{"glTF"sv, FileKind::gltf, "a binary glTF model"},
    Magic{"\x89PNG\r\n\x1a\n"sv, FileKind::other, "a PNG picture"},
    Magic{"\xff\xd8\xff"sv, FileKind::other, "a JPEG picture"},
    Magic{"\x76\x2f\x31\x01"sv, FileKind::other, "an OpenEXR picture"},
    Magic{"GIF8"sv, FileKind::other, "a GIF picture"},
    Magic{"BLENDER"sv, FileKind::other, "a Blender file"},
    Magic{"\x28\xb5\x2f\xfd"sv, FileKind::other, "a Zstandard archive, as Blender compresses its files"},
    Magic{"Kaydara FBX Binary"sv, FileKind::other, "an FBX model"},
    Magic{"; FBX"sv, FileKind::other, "an FBX model"},
    Magic{"PK\x03\x04"sv, FileKind::other, "a zip archive"},
    Magic{"\x1f\x8b"sv, FileKind::other, "a gzip archive"},
    Magic{"7z\xbc\xaf\x27\x1c"sv, FileKind::other, "a 7-Zip archive"},
    Magic{"\xfd"
          "7zXZ"sv,
          FileKind::other, "an xz archive"},
    Magic{"BZh"sv, FileKind::other, "a bzip2 archive"},
    Magic{"%PDF"sv, FileKind::other, "a PDF document"},
    Magic{"ISO-10303-21"sv, FileKind::other, "a STEP model"},
    Magic{"#VRML"sv, FileKind::other, "a VRML model"},
    Magic{"#USDA"sv, FileKind::other, "a USD model"},
    Magic{"#usda"sv, FileKind::other, "a USD model"},
    Magic{"PXR-USDC"sv, FileKind::other, "a USD model"},
    Magic{"OFF\n"sv, FileKind::other, "an OFF model"},
    Magic{"<?xml"sv, FileKind::other, "an XML file, as Collada and X3D models are"},
    Magic{"<COLLADA"sv, FileKind::other, "a Collada model"},
    Magic{"<!DOCTYPE"sv, FileKind::other, "a web page"},
    Magic{"<html"sv, FileKind::other, "a web page"},
    Magic{"version https://git-lfs"sv, FileKind::other, "a pointer of Git LFS, not the file itself"},
};

constexpr std::string_view kSpace = " \t\r\n\f\v";

std::string_view first_word(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kSpace), text.size());
  const std::string_view rest = text.substr(begin);
  return rest.substr(0, rest.find_first_of(kSpace));
}

/// Whether the first line that is no comment is a statement of OBJ; no line of a scene file is one.
bool is_obj(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
    const std::string_view word = first_word(line);
    if (!word.empty() && word.front() != '#') {
      constexpr std::array keywords = {"v", "vn", "vt", "vp", "f", "l", "p", "o", "g", "s", "mtllib", "usemtl"};
      const std::size_t after = static_cast<std::size_t>(word.data() - line.data()) + word.size();
      const bool assigns = first_word(line.substr(after)).starts_with('=');
      return !assigns && std::find(keywords.begin(), keywords.end(), word) != keywords.end();
    }
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return false;
}

/// Binary STL has no magic: its size follows from the number of facets, after 80 bytes of anything.
bool is_binary_stl(std::string_view start, std::uintmax_t size) {
  std::uint32_t facets = 0;
  if (start.size() < 84) return false;
  std::memcpy(&facets, start.data() + 80, sizeof facets);
  return size == 84 + std::uintmax_t{50} * facets;
}

FileContent content_of(std::string_view start, std::uintmax_t size) {
  for (const Magic& magic : kMagic) {
    if (start.starts_with(magic.bytes)) return {magic.kind, magic.words};
  }
  if (is_binary_stl(start, size)) return {FileKind::stl, "a binary STL model"};
  if (start.starts_with("\xEF\xBB\xBF")) start.remove_prefix(3);  // byte order mark
  if (start.find('\0') != std::string_view::npos) return {FileKind::other, "binary data of no known kind"};
  const std::string_view word = first_word(start);
  if (word == "solid") return {FileKind::stl, "an STL model"};
  if (word.starts_with('{')) return {FileKind::gltf, "a glTF model"};
  if (is_obj(start)) return {FileKind::obj, "an OBJ model"};
  return {FileKind::scene, "text that is no model's"};
}

/// What the ending of a name promises; `other` when it promises nothing.
FileKind kind_by_name(const std::filesystem::path& file) {
  const std::string ending = lowercase_ending(file);
  if (ending == ".toml") return FileKind::scene;
  if (ending == ".obj") return FileKind::obj;
  if (ending == ".ply") return FileKind::ply;
  if (ending == ".stl") return FileKind::stl;
  if (ending == ".gltf" || ending == ".glb") return FileKind::gltf;
  constexpr std::array foreign = {".3ds", ".3mf", ".ac",   ".ase", ".b3d", ".dae", ".dxf",
                                  ".fbx", ".lwo", ".ms3d", ".off", ".x",   ".x3d"};
  return std::find(foreign.begin(), foreign.end(), ending) != foreign.end() ? FileKind::foreign : FileKind::other;
}

const char* words_of(FileKind kind) {
  switch (kind) {
    case FileKind::scene:
      return "a scene (TOML)";
    case FileKind::obj:
      return "an OBJ model";
    case FileKind::ply:
      return "a PLY model";
    case FileKind::stl:
      return "an STL model";
    case FileKind::gltf:
      return "a glTF model";
    case FileKind::foreign:
      return "a model of another format";
    case FileKind::other:
      break;
  }
  return "a file";
}

}  // namespace

FileContent content_of(const std::filesystem::path& file) {
  std::uintmax_t size = 0;
  const std::string start = file_start(file, 4096, size);
  return content_of(start, size);
}

FileKind model_kind(const std::filesystem::path& file, bool or_scene) {
  const FileContent content = content_of(file);
  const FileKind promised = kind_by_name(file);
  const auto refuse = [&](const std::string& expected) {
    throw Error(ErrorKind::input, file.string(), "found " + content.words + ", expected " + expected);
  };
  // An OBJ file that begins with what no OBJ file should is read, and told of with its line.
  const bool unclear = content.kind == FileKind::scene;
  if (unclear && promised != FileKind::other && (promised != FileKind::scene || or_scene)) return promised;
  if (content.kind == FileKind::other && promised == FileKind::foreign) return promised;
  if (content.kind == FileKind::other || (unclear && !or_scene)) {
    refuse(std::string(or_scene ? "a scene (TOML) or " : "") + "a model (OBJ, PLY, STL or glTF)");
  }
  if (promised != FileKind::other && promised != content.kind) {
    refuse(std::string(words_of(promised)) + ", as its name says");
  }
  return content.kind;
}

}  // namespace raylab
