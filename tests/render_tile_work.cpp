#include "catch.hpp"
#include "raylab/render/tile_work.hpp"

using namespace raylab;

TEST_CASE("the share of time that a render has spent goes by what its tiles take", "[unit][session]") {
  // Four tiles of glass, then four of sky that take a tenth; passes of 16, 16 and 32 samples.
  constexpr int kTiles = 8;
  const auto seconds = [](int tile) { return tile < 4 ? 1.0 : 0.1; };
  TileWork work(std::vector<std::uint64_t>(kTiles, 64));
  CHECK(work.share() == 0.0);
  double spent = 0.0, all = 0.0;
  for (int tile = 0; tile < kTiles; ++tile) all += 64 * seconds(tile);
  bool known = false;
  for (const int samples : {16, 16, 32}) {
    for (int tile = 0; tile < kTiles; ++tile) {
      work.add(tile, samples, samples * seconds(tile));
      spent += samples * seconds(tile);
      if (known) CHECK(work.share() == Approx(spent / all));
    }
    known = true;  // all tiles were rendered once
    CHECK(work.share() == Approx(spent / all));
  }
  CHECK(work.share() == Approx(1.0));
}

TEST_CASE("tiles that were not rendered yet are taken for what the last ones took", "[unit][session]") {
  TileWork work(std::vector<std::uint64_t>(1000, 1));
  for (int tile = 0; tile < 500; ++tile) work.add(tile, 1, tile < 300 ? 10.0 : 1.0);
  CHECK(work.share() == Approx(3200.0 / 3700.0).epsilon(0.01));
}

TEST_CASE("where what is left changes, tiles keep the time that a sample took", "[unit][session]") {
  TileWork work({16, 16});
  work.add(0, 16, 16.0);
  work.add(1, 16, 32.0);
  CHECK(work.share() == Approx(1.0));
  work.set_left({48, 8});
  CHECK(work.share() == Approx(48.0 / (48.0 + 48.0 + 16.0)));
}
