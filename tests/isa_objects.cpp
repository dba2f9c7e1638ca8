// What the object files of the hot loops, compiled once for each instruction set, may define.
#ifdef RAYLAB_ISA_OBJECTS
#include <sstream>
#include <string>

#include "catch.hpp"
#include "run_program.hpp"

TEST_CASE("no object file of a hot loop defines a symbol that the linker may take for all", "[unit][layout]") {
  // An inline function that is not inlined is a weak symbol, of which the linker keeps any one: the whole program would
  // then run that of AVX-512, and fail on a processor without it.
  std::istringstream objects(RAYLAB_ISA_OBJECTS);
  int seen = 0;
  for (std::string object; std::getline(objects, object, ':'); ++seen) {
    INFO(object);
    const raylab::test::ProgramResult nm = raylab::test::run_program(RAYLAB_NM, {"--demangle", object});
    REQUIRE(nm.exit_code == 0);
    std::istringstream lines(nm.out);
    int symbols = 0;
    for (std::string line; std::getline(lines, line); ++symbols) {
      const char kind = line.size() > 17 ? line[17] : ' ';  // after an address of 16 digits and a blank
      INFO(line);
      CHECK((kind != 'W' && kind != 'V' && kind != 'u'));
    }
    CHECK(symbols > 0);
  }
#if defined(__x86_64__)
  CHECK(seen == 6);
#else
  CHECK(seen == 2);
#endif
}
#endif
