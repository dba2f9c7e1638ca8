#pragma once
// Pictures in and out: OpenEXR and PNG; JPEG in.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "raylab/image/image.hpp"

namespace raylab {

/// The largest picture that is made or read, in pixels.
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

/// One more channel of an EXR file, such as "Z" or "albedo.R"; float or half.
struct Layer {
  std::string name;  ///< none of R, G, B, A, and no other layer's
  bool as_float = false;
  std::vector<float> values;  ///< width * height
};

/// Texts stored beside the picture: EXR header attributes of string type. PNG files carry none.
using Attributes = std::map<std::string, std::string>;

/// Writes R, G, B, A (A = 1) as half, or as float, and the layers, to an EXR file. Values beyond half's range are
/// clamped to it. Written beside and renamed: an existing file stays as it was if anything fails.
/// Throws Error (output).
void write_exr(const std::filesystem::path& file, const Image& image, const std::vector<Layer>& layers = {},
               const Attributes& attributes = {}, bool as_float = false);

/// Whether half holds a picture's values: none beyond 65504, none that is not zero rounded to zero.
bool fits_half(const Image& image);

/// Writes an 8-bit PNG with the sRGB curve, rounding to nearest. Beside and renamed. Throws Error (output).
void write_png(const std::filesystem::path& file, const Image& image);

/// The ending of the file's name in lower case, dot included: ".exr"; empty where it has none.
std::string lowercase_ending(const std::filesystem::path& file);

/// By the file's ending, .exr or .png, any case; layers and attributes go to EXR only. Throws Error (usage) for
/// another ending.
void write_image(const std::filesystem::path& file, const Image& image, const std::vector<Layer>& layers = {},
                 const Attributes& attributes = {}, bool as_float = false);

/// Throws Error (usage) when write_image would refuse the name, and Error (output) when its folder is missing or
/// cannot be written: asked before a render starts, not after.
void check_writable_image(const std::filesystem::path& file);

/// An image with 8 bits a channel as decoded from the file, not linearised; 1 to 4 channels widened to RGB, alpha
/// left out.
struct Image8 {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3
};

/// What a picture file says of itself.
struct ImageInfo {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;  ///< name and type, such as "R half" or "Y 8-bit"
  Attributes attributes;
};

/// Reads R, G, B of an EXR file (the first part), over its display window: what lies outside the data window is
/// black. Throws Error (input): missing, not EXR, without R G B, deep, truncated, beyond the budget of read_image.
Image read_exr(const std::filesystem::path& file);
Attributes read_exr_attributes(const std::filesystem::path& file);

/// Reads PNG or JPEG, told by its content, as 8-bit; of 16 bits the upper 8. Throws Error (input): missing, neither,
/// damaged (what its checksums find included), beyond the budget of read_image.
Image8 read_image8(const std::filesystem::path& file);
/// The same of a picture that is in memory; `name` is the place of errors.
Image8 read_image8(std::string_view bytes, const std::string& name);

/// Reads an EXR as it is, others decoded from sRGB to linear. Throws Error (input). Before memory is asked for, the
/// size in the header is held against a budget: in memory a picture may take 2 GiB, and no more than 64 MiB or 2^17
/// times its file, whichever is more, which no whole file of a picture exceeds but by being empty of content. All that
/// reading takes at a time stays below 1.5 times the picture.
Image read_image(const std::filesystem::path& file);
/// The same of a PNG or JPEG that is in memory; `name` is the place of errors.
Image read_image(std::string_view bytes, const std::string& name);

/// Size, channels and attributes of an EXR or other picture, without its pixels. Throws Error (input).
ImageInfo read_image_info(const std::filesystem::path& file);

}  // namespace raylab
