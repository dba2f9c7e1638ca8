// raylab-image: compares, converts and describes pictures.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "commands.hpp"
#include "raylab/apps/program.hpp"
#include "raylab/core/error.hpp"

namespace {

using raylab::Error;
using raylab::ErrorKind;

/// Runs the command that the arguments name and returns the exit code. Throws Error.
int run(int argc, char** argv) {
  CLI::App app{"Compares, converts and describes pictures: OpenEXR, PNG, and to read also JPEG."};
  app.name("raylab-image");
  app.set_version_flag("--version", "raylab-image " RAYLAB_VERSION);
  app.require_subcommand(1);

  std::string image, reference, input, output;
  bool as_json = false;
  double exposure = 0.0;
  double full_scale = 1.0;

  CLI::App* compare = app.add_subcommand("compare", "Print the errors of a picture against a reference");
  compare->add_option("IMAGE", image, "The picture to judge")->required();
  compare->add_option("REFERENCE", reference, "The picture to judge it by, of the same size")->required();
  compare->add_flag("--json", as_json, "Print a JSON object; a value that is not finite is null");

  CLI::App* convert = app.add_subcommand("convert", "Write a picture in another format; layers are left out");
  convert->add_option("IN", input, "The picture to read")->required();
  convert->add_option("OUT", output, "The .exr or .png file to write")->required();
  convert->add_option("--exposure", exposure, "Multiply the linear values by 2^STOPS")
      ->type_name("STOPS")
      ->check(CLI::Range(-100.0, 100.0));

  CLI::App* info =
      app.add_subcommand("info",
                         "Print a picture's size, channels, ranges of linear values and attributes; of a film what it "
                         "is of, and whether its sums are whole");
  info->add_option("FILE", input, "The picture to describe")->required();

  CLI::App* diff = app.add_subcommand(
      "diff",
      "Write a picture of the relative error of each pixel: black for none, then red, yellow, and white for the "
      "full scale and above; magenta marks values that are not finite");
  diff->add_option("IMAGE", image, "The picture to judge")->required();
  diff->add_option("REFERENCE", reference, "The picture to judge it by, of the same size")->required();
  diff->add_option("-o,--output", output, "The .exr or .png file to write")->required()->type_name("OUT");
  diff->add_option("--full-scale", full_scale, "The relative error shown as white (default 1, which is 100%)")
      ->type_name("ERROR")
      ->check(CLI::Range(1e-12, 1e12));

  std::vector<std::filesystem::path> parts;
  std::string exr;
  CLI::App* merge = app.add_subcommand(
      "merge", "Join the parts of a picture that raylab-render --samples made, to the bits of one render");
  merge->add_option("PARTS", parts, "The films, in any order")->required();
  merge->add_option("-o,--output", output, "The .exr file to write, a film again, or a .png")
      ->required()
      ->type_name("OUT");
  merge->add_option("--exr", exr, "Values of an EXR picture (default: half, and float where half would lose some)")
      ->check(CLI::IsMember({"half", "float"}));

  std::vector<std::string> layers;
  merge->add_option("--layers", layers, "EXR layers beside the picture, comma separated: variance, samples")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"variance", "samples"}));

  int exit_code = 0;
  if (!raylab::parse_or_tell(app, argc, argv, exit_code)) return exit_code;
  std::error_code none;  // where the output is not there
  if (std::filesystem::is_regular_file(output, none) && std::filesystem::hard_link_count(output, none) > 1) {
    std::fprintf(stderr, "raylab-image: warning: %s has other names, hard links, which keep what they have\n",
                 output.c_str());
  }
  if (*compare) raylab::app::compare(image, reference, as_json);
  if (*convert) raylab::app::convert(input, output, exposure);
  if (*info) raylab::app::info(input);
  if (*merge) raylab::app::merge(parts, output, exr, layers);
  if (*diff) raylab::app::diff(image, reference, output, full_scale);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return raylab::run_and_tell("raylab-image", [&] {
    const int exit_code = run(argc, argv);
    raylab::check_printed();
    return exit_code;
  });
}
