#pragma once
// What the files of this folder share: telling the formats apart, and one function each format has.
#include <cstdio>
#include <filesystem>
#include <memory>

#include "raylab/image/image_file.hpp"

namespace raylab::detail {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using InputFile = std::unique_ptr<std::FILE, CloseFile>;

/// Opens the file for reading. Throws Error (input) with the system's reason; a folder is refused.
InputFile open_input(const std::filesystem::path& file);

/// True when the ending is .exr in any case, or the content begins as an EXR file does. Throws as open_input.
bool is_exr(const std::filesystem::path& file);

ImageInfo read_exr_info(const std::filesystem::path& file);
ImageInfo read_image8_info(const std::filesystem::path& file);

}  // namespace raylab::detail
