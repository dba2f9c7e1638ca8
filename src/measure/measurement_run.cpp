#include "measurement_run.hpp"

#include <algorithm>
#include <cinttypes>
#include <ctime>
#include <map>

#include "raylab/core/error.hpp"
#include "raylab/core/text.hpp"
#include "raylab/image/film_file.hpp"

namespace raylab {

namespace fs = std::filesystem;

namespace {

using Settings = std::map<std::string, std::string>;

std::string utc_date() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text;
}

/// The words of a command line, as a shell would have them but for their quotes.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words(1);
  bool quoted = false;
  for (std::size_t i = 0; i < command.size(); ++i) {
    if (command[i] == ' ' && !quoted) {
      words.emplace_back();
      continue;
    }
    words.back() += command[i];
    if (command[i] == '\\' && !quoted && i + 1 < command.size()) {
      words.back() += command[++i];
    } else if (command[i] == '\'') {
      quoted = !quoted;
    }
  }
  return words;
}

/// Options and their values; what comes before the first of them is the measurement.
Settings settings_of(const std::string& command) {
  Settings settings;
  std::string name = "measurement";
  for (const std::string& word : words_of(command)) {
    std::string value = word;
    if (word.starts_with("--")) {
      const std::size_t end = std::min(word.find('='), word.size());
      name = word.substr(0, end);
      value = word.substr(std::min(end + 1, word.size()));
    }
    std::string& all = settings[name];
    all += (all.empty() || value.empty() ? "" : " ") + value;
  }
  settings.erase("--out");
  settings.erase("--resume");
  return settings;
}

std::string without_resume(const std::string& command) {
  std::string rest;
  for (const std::string& word : words_of(command)) {
    if (word != "--resume") rest += (rest.empty() ? "" : " ") + word;
  }
  return rest;
}

bool is_complete(const Row& run) { return run.value("complete", false); }

std::string difference(const Row& run, Settings here) {
  Settings there = settings_of(run.value("command", ""));
  there["version"] = run.value("raylab", "unknown");
  here["version"] = RAYLAB_VERSION;
  return settings_difference(there, "there", here, "here");
}

}  // namespace

bool begin_run(std::vector<Row>& runs, const std::string& suite, const std::string& command, bool resume,
               const fs::path& folder) {
  const Settings settings = settings_of(command);
  const auto is_same = [&](const Row& run) { return settings_of(run.value("command", "")) == settings; };
  if (resume) {
    auto found = std::find_if(runs.begin(), runs.end(), is_same);
    if (found == runs.end()) {
      found = std::find_if(runs.begin(), runs.end(),
                           [&](const Row& run) { return run.value("suite", "") == suite && !is_complete(run); });
    }
    if (found != runs.end()) {
      if (const std::string text = difference(*found, settings); !text.empty())
        throw Error(ErrorKind::usage, folder.string(), "--resume cannot go on with the run there: " + text);
      std::rotate(found, found + 1, runs.end());
      return true;
    }
  }
  std::erase_if(runs, is_same);
  runs.push_back({{"suite", suite},
                  {"command", without_resume(command)},
                  {"date", utc_date()},
                  {"complete", false},
                  {"raylab", RAYLAB_VERSION}});
  return false;
}

bool has_measured(const Row& run, const std::string& part) {
  const auto parts = run.value("measured", std::vector<std::string>());
  return is_complete(run) || std::find(parts.begin(), parts.end(), part) != parts.end();
}

std::vector<std::string> keys_under_way(const Row& run) { return run.value("under_way", std::vector<std::string>()); }

void note_row(Row& run, const std::string& key) {
  const auto keys = keys_under_way(run);
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) run["under_way"].push_back(key);
}

void note_part(Row& run, const std::string& part) {
  run["measured"].push_back(part);
  run.erase("under_way");
}

void note_scene(Row& run, const std::string& file, std::uint64_t hash) {
  const std::string text = format("%016" PRIx64, hash);
  if (!run.contains("scenes")) run["scenes"] = Row::object();
  Row& scenes = run["scenes"];
  if (const std::string before = scenes.value(file, text); before != text) {
    throw Error(ErrorKind::input, file,
                "--resume cannot go on with the run: the scene's hash was " + before + " and is " + text);
  }
  scenes[file] = text;
}

void finish_run(Row& run) {
  run["complete"] = true;
  run.erase("measured");
  run.erase("under_way");
}

}  // namespace raylab
