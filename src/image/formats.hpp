#pragma once
// What the files of this folder share: telling the formats apart, and one function each format has.
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

#include "raylab/image/image_file.hpp"

namespace raylab::detail {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using InputFile = std::unique_ptr<std::FILE, CloseFile>;

/// A picture that is made while it is written, so that of a large one there is no copy.
struct PictureRows {
  int width, height;
  bool as_float = false;                             ///< in EXR files
  std::vector<std::pair<std::string, bool>> layers;  ///< name, and whether it is float
  /// Gives row y, and for each layer `width` values, one layer after the other. Called from the top down.
  std::function<void(int y, Rgb* pixels, float* layers)> fill;
};
PictureRows rows_of(const Image& image, const std::vector<Layer>& layers = {});  // which must outlive it

bool fits_half(const Rgb& color);

/// A second part of an EXR file, of as many pixels.
struct WordRows {
  std::string name;
  Attributes attributes;
  std::vector<std::string> channels;  ///< in the order of their names
  std::function<void(int y, std::uint32_t* words)> fill;
};

/// Written beside and renamed. Throw Error (output).
void write_exr(const std::filesystem::path& file, const PictureRows& picture, const Attributes& attributes,
               const WordRows* words);
void write_png(const std::filesystem::path& file, const PictureRows& picture);

enum class Format { exr, png };
/// Throws Error (usage) for another ending.
Format output_format(const std::filesystem::path& file);

/// Opens the file for reading. Throws Error (input) with the system's reason; a folder is refused.
InputFile open_input(const std::filesystem::path& file);

/// True when the ending is .exr in any case, or the content begins as an EXR file does. Throws as open_input.
bool is_exr(const std::filesystem::path& file);

/// A picture of 8 bits a channel that is about to be read, from a file or from memory.
struct Input8 {
  InputFile stream;            ///< at its beginning
  std::filesystem::path name;  ///< for messages
  std::int64_t budget;         ///< memory_budget of its bytes
};

/// The bytes that reading a picture of so many bytes, or the file, may take beside the picture itself.
std::int64_t memory_budget(std::uint64_t bytes);
std::int64_t memory_budget(const std::filesystem::path& file);

/// Throws Error (input) where a picture of this size, as its file's header says, is beyond the budget of read_image.
void check_budget(std::int64_t width, std::int64_t height, const std::filesystem::path& file, std::int64_t budget);

/// Throws Error (input): "not readable as a picture: REASON".
[[noreturn]] void fail_reading(const std::filesystem::path& file, const std::string& reason);

/// "R 8-bit", "G 8-bit" and so on, or Y for grey.
std::vector<std::string> channel_names(bool color, bool alpha, bool is_16_bit);

Image8 read_png(Input8 input);
Image8 read_jpeg(Input8 input);
ImageInfo read_exr_info(const std::filesystem::path& file);
ImageInfo read_image8_info(const std::filesystem::path& file);
ImageInfo read_png_info(Input8 input);
ImageInfo read_jpeg_info(Input8 input);

}  // namespace raylab::detail
