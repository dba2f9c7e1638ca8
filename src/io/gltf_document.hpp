#pragma once
#include <cstddef>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "material_library.hpp"
#include "tinygltf.hpp"

namespace raylab {

/// A glTF 2.0 file, .gltf or .glb as its content says, with the buffers that it names. Nothing in it is trusted: what
/// is reached by an index, an offset or a name is checked here.
class GltfDocument {
 public:
  /// Throws Error (input) where the file is no glTF 2.0, needs an extension that is not understood, is nested too deep,
  /// or names a buffer that is missing or shorter than it says. What is left out of it is warned of.
  GltfDocument(MaterialLibrary& library, const std::filesystem::path& file);

  /// Without buffers, images and what of the file is left out.
  const tinygltf::Model& model() const { return model_; }

  /// The bytes of a bufferView. Throws Error (input).
  std::string_view view(int buffer_view) const;

  /// A picture: its bytes, or the file that holds them.
  struct Image {
    std::string name;
    std::filesystem::path file;  ///< empty: `bytes`
    std::string_view bytes;
  };
  /// nullopt where its file is missing. Throws Error (input).
  std::optional<Image> image(int index);

  const std::filesystem::path& file() const { return file_; }

  /// Bytes of the file and of those with its buffers.
  std::size_t size() const { return size_; }

  /// Adds a warning of this document, once.
  void warn(const std::string& message);

  /// Throws Error (input) with the file as place.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  struct Chunks {
    std::string_view json, binary;
  };
  Chunks chunks() const;
  using Sections = std::map<std::string, std::string_view, std::less<>>;
  std::string take_apart(std::string_view json, Sections& sections) const;
  nlohmann::json array_of(const Sections& sections, const char* name);
  void read_model(const std::string& json);
  void read_buffers(const nlohmann::json& buffers, std::string_view binary);
  /// The bytes that a URI stands for, or the file; neither where there is no such file.
  struct Resource {
    std::filesystem::path file;
    std::optional<std::string> bytes;
  };
  Resource resource(const std::string& name, const std::string& what) const;

  MaterialLibrary& library_;
  std::filesystem::path file_;
  std::string content_;
  tinygltf::Model model_;
  nlohmann::json images_;
  std::vector<std::string_view> data_;                       // URIs, in content_
  std::deque<std::string> decoded_;                          // from data URIs
  std::map<std::filesystem::path, std::string> companions_;  // files of buffers
  std::vector<std::string_view> buffers_;
  std::map<int, std::size_t> decoded_image_;  // index into decoded_
  std::size_t size_ = 0;
  std::set<std::string> warned_;
};

}  // namespace raylab
