#pragma once
// Films in and out: pictures by rows, and with the exact sums, so that renders go on and parts are merged.
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "raylab/image/film.hpp"
#include "raylab/image/image_file.hpp"

namespace raylab {

/// Samples [first, end) of each pixel.
struct SampleRange {
  std::uint32_t first = 0;
  std::uint32_t end = 0;

  bool operator==(const SampleRange&) const = default;
};
/// "first:end".
std::string to_string(const SampleRange& range);

/// What a film file says of its film.
struct FilmInfo {
  /// All that determines the picture, by name: films of which one differs are of different pictures.
  std::map<std::string, std::string> settings;
  /// The samples that it is of, in their order. One range alone may be taken in part: of each pixel the first
  /// taken(x, y) samples of it.
  std::vector<SampleRange> ranges;
  std::uint32_t wanted = 0;  ///< samples that the whole picture is to have
  std::uint64_t pixels = 0;  ///< that are rendered, as a crop leaves some out
  double seconds = 0.0;      ///< spent rendering

  bool operator==(const FilmInfo&) const = default;
};

/// FNV-1a, 64 bits, of the settings: one number for all that determines the picture.
std::uint64_t picture_hash(const std::map<std::string, std::string>& settings);

/// What two films' settings differ in: "seed is 1 NAME_A and 2 NAME_B; …"; empty where they are the same.
std::string settings_difference(const std::map<std::string, std::string>& a, const std::string& name_a,
                                const std::map<std::string, std::string>& b, const std::string& name_b);

/// Gives a film of the rows from `first` on, `count` of them. Asked for from the top down.
using FilmRows = std::function<Film(int first, int count)>;

/// A film as it is written, row by row.
struct FilmPicture {
  int width = 0;
  int height = 0;
  FilmRows rows;
  std::vector<Layer> layers;  ///< beside those of the film itself:
  bool variance = false;      ///< variance.R, .G and .B
  bool samples = false;       ///< sampleCount
  bool as_float = false;      ///< R, G, B and A in float, not half
  Attributes attributes;
  std::optional<FilmInfo> film;  ///< given: EXR files hold the exact sums too, in a second part
};

/// By the file's ending, as write_image; of the picture there is no copy in memory. Throws Error (output or usage).
///
/// The second part of an EXR file, "film", has a channel of 32 bits for each word of Film::row_words(), and one more
/// that checks the others of its pixel; its attributes are what FilmInfo has.
void write_film_picture(const std::filesystem::path& file, FilmPicture picture);

/// The same of the picture of a film.
bool fits_half(const Film& film);

/// What of a row of a film file is not as it was written.
struct DamagedRow {
  int y = 0;
  int pixels = 0;  ///< how many of it
  int first = 0;   ///< the leftmost of them
};

/// A film file that is open for reading.
class FilmFile {
 public:
  /// Throws Error (input): missing, not an EXR file with a film of this format, damaged header.
  explicit FilmFile(const std::filesystem::path& file);
  ~FilmFile();
  FilmFile(FilmFile&&) noexcept;

  /// Whether the file is there and has a film, of whatever version.
  static bool is_one(const std::filesystem::path& file) noexcept;

  const std::filesystem::path& name() const { return file_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const FilmInfo& info() const { return info_; }
  /// Of the picture.
  const Attributes& attributes() const { return attributes_; }

  /// Adds all samples to a film of the same size. Returns the fewest and the most taken of a rendered pixel. Throws
  /// Error (input) with the first pixel that is damaged.
  SampleRange add_to(Film& film);

  /// Reads all sums, and gives the rows that have damaged pixels.
  std::vector<DamagedRow> damaged_rows();

 private:
  struct Exr;

  /// Fills in the words of a row. Returns what of them is damaged. Throws Error (input) where the row cannot be read.
  DamagedRow read_row(int y, std::vector<std::uint32_t>& words);

  std::filesystem::path file_;
  int width_ = 0, height_ = 0;
  FilmInfo info_;
  Attributes attributes_;
  std::uint32_t check_seed_ = 0;
  std::unique_ptr<Exr> exr_;
};

}  // namespace raylab
