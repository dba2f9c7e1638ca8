#pragma once
#include <stdexcept>
#include <string>
#include <utility>

namespace raylab {

/// What went wrong, as the exit code of a program tells it.
enum class ErrorKind {
  failure = 1,  ///< anything else
  usage = 2,    ///< the command line
  input = 3,    ///< a bad scene or input file
  output = 4,   ///< a file that could not be written
};

/// Bad input or a failed operation. what() reads "PLACE: MESSAGE"; PLACE is file:line:column where known,
/// else the file or the option.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, std::string location, const std::string& message)
      : std::runtime_error(location.empty() ? message : location + ": " + message),
        kind_(kind),
        location_(std::move(location)) {}

  ErrorKind kind() const noexcept { return kind_; }
  const std::string& location() const noexcept { return location_; }
  int exit_code() const noexcept { return static_cast<int>(kind_); }

 private:
  ErrorKind kind_;
  std::string location_;
};

}  // namespace raylab
