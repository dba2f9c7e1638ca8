// Scripts of raylab-preview.
#include "script.hpp"

#include "fuzz.hpp"

using namespace raylab;

RAYLAB_FUZZ(text) {
  fuzz::read_or_tell([&] { parse_script(text, "script"); });
}
