// Manual pages and completions, which the programs write from their own options.
#include <regex>

#include "catch.hpp"
#include "run_program.hpp"
#include "temp_folder.hpp"

using namespace raylab::test;

namespace {

const std::vector<std::string> kPrograms{"raylab-render", "raylab-image", "raylab-bench"};

std::string generated(const std::string& program, const std::string& kind) {
  const ProgramResult result = run_program(RAYLAB_BINARY_DIR "/" + program, {"--generate", kind});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  return result.out;
}

/// What bash offers where the cursor is behind the last of these words.
std::string bash_offers(const std::string& program, const std::string& words) {
  const std::string text = generated(program, "bash");
  const ProgramResult result = run_program("/bin/bash", {"-c",
                                                         R"(eval "$1"
                                   complete -p "$2" >/dev/null || exit 9
                                   read -ra COMP_WORDS <<<"$2 $3"
                                   [[ $3 != *_ ]] || COMP_WORDS[-1]=''
                                   COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
                                   "_${2/-/_}"
                                   echo "${COMPREPLY[*]}")",
                                                         "bash", text, program, words});
  INFO(result.err);
  CHECK(result.err.empty());
  REQUIRE(result.exit_code == 0);
  return result.out.substr(0, result.out.find('\n'));
}

}  // namespace

TEST_CASE("bash completes options and their values", "[cli]") {
  CHECK(bash_offers("raylab-render", "--acc") == "--accel");
  CHECK(bash_offers("raylab-render", "--accel _") == "list rtiow bvh embree embree-robust exact");
  CHECK(bash_offers("raylab-render", "cornell.toml --accel emb") == "embree embree-robust");
  CHECK(bash_offers("raylab-render", "--accel = b") == "bvh");  // bash parts --accel=b so
  CHECK(bash_offers("raylab-render", "--accel =") == "list rtiow bvh embree embree-robust exact");
  CHECK(bash_offers("raylab-render", "--layers albedo,de") == "albedo,depth");
  CHECK(bash_offers("raylab-render", "--spp 1") == "");
  CHECK(bash_offers("raylab-render", "--bvh") == "");  // an old name
  CHECK(bash_offers("raylab-render", "cor") == "");    // files, by readline
}

TEST_CASE("bash completes commands, and each one's options", "[cli]") {
  CHECK(bash_offers("raylab-image", "_") == "compare convert info diff merge");
  CHECK(bash_offers("raylab-image", "conv") == "convert");
  CHECK(bash_offers("raylab-image", "convert a.exr --") == "--help --exposure");
  CHECK(bash_offers("raylab-image", "--vers") == "--version");
  CHECK(bash_offers("raylab-bench", "rays --accel bvh,emb") == "bvh,embree bvh,embree-robust");
}

TEST_CASE("fish completes options, commands and values", "[cli]") {
  if (run_program("/bin/sh", {"-c", "command -v fish"}).exit_code != 0) {
    WARN("left out: fish is not installed");
    return;
  }
  TempFolder folder;
  // The names alone, without what fish says of each beside it.
  const auto fish_offers = [&](const std::string& line) {
    const std::string program = line.substr(0, line.find(' ')), file = (folder / "completion.fish").string();
    write_text(file, generated(program, "fish"));
    const ProgramResult result = run_program(
        "/usr/bin/env", {"HOME=" + folder.path().string(), "PATH=" RAYLAB_BINARY_DIR ":/usr/bin:/bin", "fish", "-c",
                         "source $argv[1]; complete -C $argv[2] | string split -f 1 \\t", file, line});
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    return result.out;
  };
  // Newer versions of fish also offer what holds the text further on.
  CHECK(fish_offers("raylab-render --acc").starts_with("--accel\n"));
  CHECK(fish_offers("raylab-render --accel emb") == "embree\nembree-robust\n");
  CHECK(fish_offers("raylab-bench ra") == "rays\n");
  CHECK(fish_offers("raylab-bench rays --accel ex") == "exact\n");
}

TEST_CASE("manual pages and completions name every option that --help lists", "[cli]") {
  for (const std::string& program : kPrograms) {
    std::vector<std::vector<std::string>> helps{{"--help"}};
    if (program == "raylab-image") helps.insert(helps.end(), {{"compare", "--help"}, {"diff", "--help"}});
    if (program == "raylab-bench") helps.insert(helps.end(), {{"rays", "--help"}, {"compare", "--help"}});
    const std::string man = std::regex_replace(generated(program, "man"), std::regex(R"(\\-)"), "-");
    const std::string bash = generated(program, "bash"), zsh = generated(program, "zsh"),
                      fish = generated(program, "fish");
    for (const auto& help : helps) {
      const std::string text = run_program(RAYLAB_BINARY_DIR "/" + program, help).out;
      const std::regex option(R"(\n  (?:-\w,)?--([\w-]+))");
      for (std::sregex_iterator at(text.begin(), text.end(), option), end; at != end; ++at) {
        const std::string name = (*at)[1];
        INFO(program << " --" << name);
        CHECK(man.find("--" + name) != std::string::npos);
        CHECK(bash.find("--" + name) != std::string::npos);
        CHECK(zsh.find("--" + name) != std::string::npos);
        CHECK(fish.find(" -l " + name) != std::string::npos);
      }
    }
  }
}

TEST_CASE("what is generated is what its reader understands, where that is installed", "[cli]") {
  TempFolder folder;
  for (const std::string& program : kPrograms) {
    for (const auto& [kind, check] : std::vector<std::pair<std::string, std::string>>{
             {"man", "command -v groff >/dev/null || exit 0; groff -man -ww -Tutf8 -z \"$0\" 2>&1"},
             {"bash", "bash -n \"$0\" 2>&1"},
             {"zsh", "command -v zsh >/dev/null || exit 0; zsh -n \"$0\" 2>&1"},
             {"fish", "command -v fish >/dev/null || exit 0; fish -n \"$0\" 2>&1"}}) {
      const std::string file = (folder / (program + "." + kind)).string();
      write_text(file, generated(program, kind));
      const ProgramResult result = run_program("/bin/sh", {"-c", check, file});
      INFO(program << " " << kind);
      CHECK(result.out.empty());
      CHECK(result.exit_code == 0);
    }
  }
}

TEST_CASE("an unknown kind of text to generate is a mistake of usage", "[cli]") {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--generate"}, {"--generate", "tcsh"}}) {
    const ProgramResult result = run_program(RAYLAB_BINARY_DIR "/raylab-image", arguments);
    CHECK(result.exit_code == 2);
    CHECK(result.out.empty());
    CHECK(result.err.find("expected man, bash, zsh or fish") != std::string::npos);
  }
}
