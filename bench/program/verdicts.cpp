#include "verdicts.hpp"

#include <charconv>
#include <cstdio>

#include "raylab/core/atomic_file.hpp"
#include "raylab/core/error.hpp"

namespace raylab::bench {

namespace {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result;
}

/// "5%" as 0.05.
double parse_percent(const std::string& text) {
  double percent = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), percent);
  if (error != std::errc() || std::string_view(end) != "%" || !(percent > 0.0 && percent < 1e6))
    throw Error(ErrorKind::usage, "--fail-on", "found slower=" + text + ", expected such as slower=5%");
  return percent / 100.0;
}

}  // namespace

FailOn parse_fail_on(const std::vector<std::string>& parts) {
  const std::string slower = "slower=";
  FailOn fail_on;
  for (const std::string& part : parts) {
    if (part.rfind(slower, 0) == 0) {
      fail_on.slower = parse_percent(part.substr(slower.size()));
    } else if (part == "wrong") {
      fail_on.wrong = true;
    } else {
      throw Error(ErrorKind::usage, "--fail-on", "found " + part + ", expected slower=PERCENT% or wrong");
    }
  }
  return fail_on;
}

int conclude(const std::string& suite, const std::vector<Verdict>& verdicts, const std::string& junit) {
  std::size_t failures = 0;
  std::string cases;
  for (const Verdict& verdict : verdicts) {
    cases += "  <testcase classname=\"" + escaped(suite) + "\" name=\"" + escaped(verdict.name) + "\"";
    if (verdict.failure.empty()) {
      cases += "/>\n";
      continue;
    }
    ++failures;
    cases += ">\n    <failure message=\"" + escaped(verdict.failure) + "\"/>\n  </testcase>\n";
    std::fprintf(stderr, "raylab-bench: %s: %s\n", verdict.name.c_str(), verdict.failure.c_str());
  }
  if (!junit.empty()) {
    AtomicFile file(junit);
    file.stream() << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"" << escaped(suite) << "\" tests=\""
                  << verdicts.size() << "\" failures=\"" << failures << "\">\n"
                  << cases << "</testsuite>\n";
    file.commit();
  }
  return failures == 0 ? 0 : static_cast<int>(ErrorKind::failure);
}

}  // namespace raylab::bench
