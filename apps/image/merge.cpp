#include <algorithm>
#include <cstdio>

#include "commands.hpp"
#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/image/film_error.hpp"
#include "raylab/image/film_file.hpp"

namespace raylab::app {

namespace fs = std::filesystem;

namespace {

/// Samples of one part.
struct Part {
  const fs::path* file;
  SampleRange samples;
  bool is_whole = true;  ///< each pixel has all of them
};

std::uint32_t count(const SampleRange& range) { return range.end - range.first; }

void warn(const std::string& warning) { std::fprintf(stderr, "raylab-image: warning: %s\n", warning.c_str()); }

[[noreturn]] void refuse(const fs::path& part, const std::string& why) {
  throw Error(ErrorKind::input, part.string(), "cannot be merged with the others: " + why);
}

std::string described(const SampleRange& samples) {
  return count(samples) == 1 ? "sample " + std::to_string(samples.first)
                             : format("samples %u to %u", samples.first, samples.end - 1);
}

void refuse_overlaps(std::vector<Part>& parts) {
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.samples.first < b.samples.first; });
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const SampleRange &before = parts[i - 1].samples, &samples = parts[i].samples;
    if (samples.first >= before.end) continue;
    refuse(*parts[i].file, "it has " + described({samples.first, std::min(samples.end, before.end)}) + " that " +
                               parts[i - 1].file->string() + " has too");
  }
}

/// Says which of the samples from 0 to `wanted` no part has. Whether there are any.
bool warn_of_gaps(const std::vector<Part>& parts, std::uint32_t wanted) {
  std::uint32_t next = 0;
  bool any = false;
  const auto gap = [&](std::uint32_t end) {
    if (next >= end) return;
    any = true;
    warn(described({next, end}) + format(" of %u are in no part: the picture is whole, with more noise", wanted));
  };
  for (const Part& part : parts) {
    gap(part.samples.first);
    next = part.samples.end;
  }
  gap(wanted);
  return any;
}

}  // namespace

void merge(const std::vector<fs::path>& parts, const fs::path& output, const std::string& exr,
           const std::vector<std::string>& layers) {
  check_writable_image(output);
  // Headers first, so that what cannot be merged is told before hours of reading.
  FilmInfo all;
  Attributes attributes;
  std::vector<Part> ranges;
  int width = 0, height = 0;
  for (const fs::path& name : parts) {
    const FilmFile part(name);
    const FilmInfo& info = part.info();
    if (info.settings.contains("adaptive")) {
      refuse(name, "its samples are where the error was (--adaptive), and not the same ones of each pixel");
    }
    if (&name == &parts.front()) {
      all.settings = info.settings;
      all.pixels = info.pixels;
      attributes = part.attributes();
      width = part.width();
      height = part.height();
    }
    const std::string difference =
        settings_difference(info.settings, "in it", all.settings, "in " + parts.front().string());
    if (!difference.empty()) refuse(name, difference);
    if (part.width() != width || part.height() != height) refuse(name, "its size is another");
    all.wanted = std::max(all.wanted, info.wanted);
    all.seconds += info.seconds;
    for (const SampleRange& range : info.ranges) ranges.push_back({&name, range});
  }
  refuse_overlaps(ranges);

  Film film(width, height);
  for (const fs::path& name : parts) {
    FilmFile part(name);
    const SampleRange taken = part.add_to(film);
    std::uint32_t whole = 0;
    for (const SampleRange& range : part.info().ranges) whole += count(range);
    if (taken.first == whole) continue;
    warn(name.string() +
         format(" is not whole: pixels have %u to %u of its %u samples", taken.first, taken.end, whole));
    for (Part& range : ranges) range.is_whole &= range.file != &name;
  }
  bool joins = false;
  for (const Part& range : ranges) {
    // What follows one that is not whole stays apart: each pixel of that ends where it may.
    if (joins && all.ranges.back().end == range.samples.first) {
      all.ranges.back().end = range.samples.end;
    } else {
      all.ranges.push_back(range.samples);
    }
    joins = range.is_whole;
  }
  const bool is_whole = !warn_of_gaps(ranges, all.wanted) &&
                        std::all_of(ranges.begin(), ranges.end(), [](const Part& range) { return range.is_whole; });

  std::uint32_t samples = 0;
  for (const SampleRange& range : all.ranges) samples += count(range);
  attributes["raylab.firstSample"] = std::to_string(all.ranges.front().first);
  attributes["raylab.samplesPerPixel"] = std::to_string(samples);
  attributes["raylab.seconds"] = std::to_string(all.seconds);
  const auto sampler = all.settings.find("sampler");
  const bool is_sobol = sampler != all.settings.end() && sampler->second == "sobol" && all.ranges.size() == 1 &&
                        all.ranges.front().first == 0;
  const RelmseEstimate error = estimate_relmse(film, is_sobol);
  for (const auto& [name, value] : error.attributes()) attributes[name] = value;
  attributes["raylab.partial"] = is_whole ? "false" : "true";
  attributes["raylab.mergedParts"] = std::to_string(parts.size());
  for (const char* of_one_part : {"raylab.samplesTaken", "raylab.stoppedBy"}) attributes.erase(of_one_part);
  FilmPicture picture;
  picture.width = width;
  picture.height = height;
  picture.rows = [&](int first, int count) { return film.rows(first, count); };
  picture.as_float = exr.empty() ? !fits_half(film) : exr == "float";
  picture.attributes = attributes;
  picture.variance = std::find(layers.begin(), layers.end(), "variance") != layers.end();
  picture.samples = std::find(layers.begin(), layers.end(), "samples") != layers.end();
  picture.film = all;
  write_film_picture(output, picture);
  std::printf("merged %zu parts of %d x %d pixels, %u samples a pixel, estimated relMSE %s\n", parts.size(), width,
              height, samples, error.text().c_str());
}

}  // namespace raylab::app
