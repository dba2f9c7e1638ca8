#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gltf_document.hpp"
#include "material_library.hpp"
#include "raylab/core/vec.hpp"
#include "surface_description.hpp"

namespace raylab {

/// How the texture coordinates of what has a material are made from the file's, in which v runs down.
struct GltfTexcoords {
  int set = 0;  ///< n of TEXCOORD_n
  /// u and v of the texture are the first and second row times (u, v, 1).
  std::array<dvec3, 2> rows = {dvec3(1.0, 0.0, 0.0), dvec3(0.0, 1.0, 0.0)};

  bool operator==(const GltfTexcoords&) const = default;
};

struct GltfMaterial {
  std::uint32_t index = 0;  ///< in the library
  GltfTexcoords texcoords;
};

/// The materials of a glTF file, each made when it is first asked for.
class GltfMaterials {
 public:
  GltfMaterials(MaterialLibrary& library, GltfDocument& document) : library_(library), document_(document) {}

  /// Of -1, what no material is given to, it is grey. Throws Error (input).
  const GltfMaterial& get(int material);

 private:
  /// A texture as a material names it.
  struct Use {
    int texture = -1;
    GltfTexcoords texcoords;
  };
  Use use_of(int texture, int set, const tinygltf::ExtensionMap& extensions) const;
  Use use_of(const tinygltf::Value& info) const;
  Texture color(const Use& use, const Rgb& factor, bool is_albedo);
  std::optional<GltfDocument::Image> image_of(int texture, int& image);
  double mean(const Use& use, int channel);
  GltfMaterial make(const tinygltf::Material& source, const std::string& name);

  MaterialLibrary& library_;
  GltfDocument& document_;
  std::map<int, GltfMaterial> made_;
  std::map<int, dvec3> means_;  // of the channels of images as they are stored
};

}  // namespace raylab
