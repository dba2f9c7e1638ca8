#pragma once
#include <initializer_list>
#include <string>

#include "catch.hpp"
#include "raylab/core/error.hpp"

namespace raylab::test {

/// Calls action, which must throw an Error of this kind and place whose text contains all the given parts.
template <class Action>
void expect_error(ErrorKind kind, const std::string& place, std::initializer_list<const char*> parts,
                  const Action& action) {
  try {
    action();
    FAIL("no error was thrown");
  } catch (const Error& e) {
    const std::string text = e.what();
    CHECK(e.kind() == kind);
    CHECK(e.location() == place);
    for (const char* part : parts) {
      INFO("\"" << text << "\" should contain \"" << part << "\"");
      CHECK(text.find(part) != std::string::npos);
    }
    CHECK(text.find('\n') == std::string::npos);
  }
}

}  // namespace raylab::test
