#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "catch.hpp"
#include "raylab/core/numeric.hpp"
#include "raylab/core/parallel.hpp"

using namespace raylab;

namespace {

/// Half of the smallest normal float, computed where the optimiser cannot.
float denormal() {
  volatile float smallest = std::numeric_limits<float>::min();
  return smallest * 0.5f;
}

/// The most bodies of a parallel_for that ran at one time, and the threads that ran them.
struct Concurrency {
  int most = 0;
  std::set<std::thread::id> threads;
};

Concurrency measure() {
  Concurrency result;
  std::mutex mutex;
  std::atomic<int> running{0};
  parallel_for(64, [&](std::size_t) {
    const int now = ++running;
    {
      const std::lock_guard lock(mutex);
      result.most = std::max(result.most, now);
      result.threads.insert(std::this_thread::get_id());
    }
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    --running;
  });
  return result;
}

}  // namespace

TEST_CASE("parallel_for calls each item once, in any number of threads", "[unit][core]") {
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, [&](std::size_t i) { ++calls[i]; });
      CHECK(std::all_of(calls.begin(), calls.end(), [](const auto& c) { return c == 1; }));
    }
  }
}

TEST_CASE("parallel_for starts its items in order", "[unit][core]") {
  {
    const ThreadLimit limit(1);
    std::vector<std::size_t> order;
    parallel_for(500, [&](std::size_t i) { order.push_back(i); });
    REQUIRE(order.size() == 500);
    CHECK(std::is_sorted(order.begin(), order.end()));
  }
  // With more threads an item may overtake those in hand, of which there is one a thread. Items are numbered
  // before their bodies run, so a thread that is held up in between can be late by any amount; but it has its
  // number.
  std::atomic<int> first_started{-1};
  std::atomic<int> clock{0};
  std::vector<int> started(500);
  parallel_for(500, [&](std::size_t i) {
    started[i] = clock++;
    if (i == 0) first_started = started[i];
    std::this_thread::sleep_for(std::chrono::microseconds(20));
  });
  CHECK(first_started < 250);
}

TEST_CASE("an exception in a parallel body reaches the caller, and the next loop runs", "[unit][core]") {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    CHECK_THROWS_WITH(parallel_for(100,
                                   [](std::size_t i) {
                                     if (i == 5) throw std::runtime_error("item five");
                                   }),
                      "item five");
    std::atomic<int> calls{0};
    parallel_for(100, [&](std::size_t) { ++calls; });
    CHECK(calls == 100);
  }
}

TEST_CASE("no more threads work than the limit says, and the limit ends with its object", "[unit][core]") {
  CHECK(hardware_threads() >= 1);
  {
    const ThreadLimit one(1);
    const Concurrency c = measure();
    CHECK(c.most == 1);
    CHECK(c.threads == std::set{std::this_thread::get_id()});
    const ThreadLimit inner(2);  // the stricter of two counts
    CHECK(measure().most == 1);
  }
  {
    const ThreadLimit two(2);
    CHECK(measure().most <= 2);
  }
  {
    const ThreadLimit all(0);
    CHECK(measure().most <= hardware_threads());
  }
  if (hardware_threads() > 1) {
    // Others may keep the machine's cores busy for a while, so several attempts count as one.
    int most = 0;
    for (int i = 0; i < 20 && most < 2; ++i) most = std::max(most, measure().most);
    CHECK(most > 1);
  }
}

TEST_CASE("denormals are flushed in a parallel body and kept outside", "[unit][core]") {
  CHECK(denormal() > 0.0f);
  std::atomic<int> kept{0};
  parallel_for(200, [&](std::size_t) { kept += denormal() != 0.0f; });
  CHECK(kept == 0);
  CHECK(denormal() > 0.0f);
  CHECK_THROWS(parallel_for(10, [](std::size_t) { throw std::runtime_error("any"); }));
  CHECK(denormal() > 0.0f);
}
