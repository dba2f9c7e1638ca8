// EXR files, with films and without.
#include "fuzz.hpp"
#include "raylab/image/film_file.hpp"
#include "raylab/image/image_file.hpp"

using namespace raylab;

RAYLAB_FUZZ(bytes) {
  const auto file = fuzz::write("picture.exr", bytes);
  fuzz::read_or_tell([&] { read_image_info(file); });
  fuzz::read_or_tell([&] { read_exr(file); });
  fuzz::read_or_tell([&] {
    FilmFile opened(file);
    Film film(opened.width(), opened.height());
    opened.add_to(film);
  });
}
