// raylab-import MODEL GLB: reads a model of any format that Assimp knows and writes it as binary glTF, its pictures
// within. Raylab runs it as a process of its own, as Assimp promises neither a bound of memory or time nor an end
// without a crash, and files are never trusted.
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

constexpr rlim_t kMostBytes = rlim_t{4} << 30;
constexpr rlim_t kMostSeconds = 60;  // of the processor; five times that by the clock

void set_limits() {
  const auto limit = [](auto resource, rlim_t most) {
    rlimit both{};
    getrlimit(resource, &both);
    both.rlim_cur = both.rlim_max = std::min(both.rlim_max, most);
    setrlimit(resource, &both);
  };
  limit(RLIMIT_AS, kMostBytes);
  limit(RLIMIT_FSIZE, kMostBytes);
  limit(RLIMIT_CPU, kMostSeconds);
  limit(RLIMIT_CORE, 0);
  alarm(5 * kMostSeconds);
}

/// A picture that the model names, from where it says or from beside the model; empty where it is no PNG or JPEG.
std::string read_picture(const fs::path& folder, std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  for (const fs::path& file : {folder / name, folder / fs::path(name).filename()}) {
    std::error_code error;
    if (!fs::is_regular_file(file, error)) continue;
    std::ifstream stream(file, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xff\xd8\xff")) return bytes;
  }
  return {};
}

std::unique_ptr<aiTexture> texture_of(const std::string& picture) {
  auto texture = std::make_unique<aiTexture>();
  texture->mWidth = static_cast<unsigned>(picture.size());  // in bytes, as mHeight = 0 marks a compressed picture
  texture->pcData = new aiTexel[picture.size() / sizeof(aiTexel) + 1];
  std::memcpy(static_cast<void*>(texture->pcData), picture.data(), picture.size());
  std::strcpy(texture->achFormatHint, picture.front() == '\x89' ? "png" : "jpg");
  return texture;
}

/// Puts the pictures that lie in files into the scene, as what is written lies elsewhere.
void embed_pictures(aiScene& scene, const fs::path& folder) {
  std::vector<aiTexture*> textures(scene.mTextures, scene.mTextures + scene.mNumTextures);
  std::vector<std::string> names(textures.size());
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
    aiMaterial& material = *scene.mMaterials[m];
    for (int t = aiTextureType_DIFFUSE; t <= AI_TEXTURE_TYPE_MAX; ++t) {
      const auto type = static_cast<aiTextureType>(t);
      aiString path;
      if (material.GetTexture(type, 0, &path) != AI_SUCCESS || scene.GetEmbeddedTexture(path.C_Str()) != nullptr)
        continue;
      auto known = std::find(names.begin(), names.end(), path.C_Str());
      if (known == names.end()) {
        const std::string picture = read_picture(folder, path.C_Str());
        if (picture.empty()) continue;
        textures.push_back(texture_of(picture).release());
        known = names.insert(names.end(), path.C_Str());
      }
      aiString embedded("*");
      embedded.Append(std::to_string(known - names.begin()).c_str());
      material.AddProperty(&embedded, AI_MATKEY_TEXTURE(type, 0));
    }
  }
  delete[] scene.mTextures;
  scene.mNumTextures = static_cast<unsigned>(textures.size());
  scene.mTextures = new aiTexture*[textures.size()];  // which the scene owns
  std::copy(textures.begin(), textures.end(), scene.mTextures);
}

int convert(const fs::path& model, const char* output) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  if (importer.ReadFile(model.string(), aiProcess_Triangulate | aiProcess_SortByPType |
                                            aiProcess_JoinIdenticalVertices | aiProcess_GenUVCoords |
                                            aiProcess_TransformUVCoords) == nullptr) {
    std::fprintf(stderr, "%s\n", importer.GetErrorString());
    return 1;
  }
  const std::unique_ptr<aiScene> scene(importer.GetOrphanedScene());
  embed_pictures(*scene, model.parent_path());
  Assimp::Exporter exporter;
  if (exporter.Export(scene.get(), "glb2", output) == AI_SUCCESS) return 0;
  std::fprintf(stderr, "%s\n", exporter.GetErrorString());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: raylab-import MODEL GLB\nRaylab runs it for models of formats that it does not read itself.\n",
               stderr);
    return 2;
  }
  set_limits();
  try {
    return convert(argv[1], argv[2]);
  } catch (const std::bad_alloc&) {
    std::fputs("it takes more than 4 GiB of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 1;
}
