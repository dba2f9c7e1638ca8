#pragma once
// A vector of twice as many lanes, made of two.
#include <cstdint>

namespace raylab::bvh {
namespace {

template <class Half>
struct Pair {
  static constexpr int lanes = 2 * Half::lanes;
  Half low, high;

  static Pair load(const float* p) { return {Half::load(p), Half::load(p + Half::lanes)}; }
  static Pair splat(float x) { return {Half::splat(x), Half::splat(x)}; }
  void store(float* p) const {
    low.store(p);
    high.store(p + Half::lanes);
  }
  friend Pair operator+(Pair a, Pair b) { return {a.low + b.low, a.high + b.high}; }
  friend Pair operator-(Pair a, Pair b) { return {a.low - b.low, a.high - b.high}; }
  friend Pair operator*(Pair a, Pair b) { return {a.low * b.low, a.high * b.high}; }
  friend Pair operator/(Pair a, Pair b) { return {a.low / b.low, a.high / b.high}; }
  friend Pair min(Pair a, Pair b) { return {min(a.low, b.low), min(a.high, b.high)}; }
  friend Pair max(Pair a, Pair b) { return {max(a.low, b.low), max(a.high, b.high)}; }
  friend Pair abs(Pair a) { return {abs(a.low), abs(a.high)}; }
  friend std::uint32_t less(Pair a, Pair b) { return less(a.low, b.low) | less(a.high, b.high) << Half::lanes; }
  friend std::uint32_t less_equal(Pair a, Pair b) {
    return less_equal(a.low, b.low) | less_equal(a.high, b.high) << Half::lanes;
  }
  friend std::uint32_t equal(Pair a, Pair b) { return equal(a.low, b.low) | equal(a.high, b.high) << Half::lanes; }
};

}  // namespace
}  // namespace raylab::bvh
