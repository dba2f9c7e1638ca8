#pragma once
#include <string>

namespace CLI {
class App;
}

namespace raylab {

/// What a program's own options say of it, in the language of `kind`: man (a page of section 1), or the completions of
/// a shell, bash, zsh or fish. Throws Error, of kind usage, for any other.
std::string generated_text(const CLI::App& app, const std::string& kind);

}  // namespace raylab
