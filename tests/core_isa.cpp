#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>

#include "catch.hpp"
#include "raylab/core/isa.hpp"

using namespace raylab;

#if defined(__x86_64__)  // 64-bit Arm's only set needs no flags
TEST_CASE("a processor is asked for every feature that the hot loops are compiled for", "[unit][isa]") {
  const std::map<std::string, Isa> isas = {{"sse42", Isa::sse42}, {"avx2", Isa::avx2}, {"avx512", Isa::avx512}};
  std::ifstream file(std::string(RAYLAB_SOURCE_DIR) + "/CMakeLists.txt");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::regex options("_(sse42|avx2|avx512)\\.cpp PROPERTIES COMPILE_OPTIONS\\s+\"([^\"]*)\"");
  const std::regex feature("(?:^|;)-m(?!prefer-)([^;]+)");
  int files = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), options), end; it != end; ++it, ++files) {
    const auto known = isa_features(isas.at((*it)[1]));
    const std::string flags = (*it)[2];
    for (std::sregex_iterator flag(flags.begin(), flags.end(), feature); flag != end; ++flag) {
      INFO((*it)[1] << " is compiled with " << flag->str());
      CHECK(std::ranges::count(known, flag->str(1), &IsaFeature::name) == 1);
    }
  }
  CHECK(files == 3);
}
#endif

TEST_CASE("an instruction set is chosen if the processor has it", "[unit][isa]") {
  CHECK(choose_isa({}) == newest_isa());
  CHECK(choose_isa(kCompiledIsas.front()) == kCompiledIsas.front());
  for (const Isa isa : {Isa::sse42, Isa::avx2, Isa::avx512, Isa::neon, static_cast<Isa>(200)}) {
    if (!isa_supported(isa)) CHECK_THROWS(choose_isa(isa));
  }
}
