#pragma once
// A double and how far it may be from the real number it stands for.
#include <cmath>
#include <limits>
#include <optional>

namespace raylab::exact {

/// All reals within `error` of `mid`. Operations round to nearest and add what rounding lost, so the ball always
/// holds the exact result. Nothing overflows or becomes denormal here: coordinates and directions are floats, 0 or
/// between 2^-149 and 2^129 in size, products have at most six factors, and errors are 2^-53 of them.
struct Ball {
  double mid = 0.0;
  double error = 0.0;

  double lower() const { return mid - (error * kOutward + std::abs(mid) * 0x1p-52); }
  double upper() const { return mid + (error * kOutward + std::abs(mid) * 0x1p-52); }

  /// Of the exact number, if the ball tells.
  std::optional<int> sign() const {
    if (mid > error) return 1;
    if (mid < -error) return -1;
    if (mid == 0.0 && error == 0.0) return 0;
    return std::nullopt;
  }

  static constexpr double kRoundoff = 0x1p-53;
  /// Makes up for the roundings of a few operations on errors, which are all positive.
  static constexpr double kOutward = 1.0 + 0x1p-49;
};

inline Ball operator-(const Ball& a) { return {-a.mid, a.error}; }

inline Ball operator+(const Ball& a, const Ball& b) {
  const double mid = a.mid + b.mid;
  return {mid, (a.error + b.error + Ball::kRoundoff * std::abs(mid)) * Ball::kOutward};
}

inline Ball operator-(const Ball& a, const Ball& b) { return a + -b; }

inline Ball operator*(const Ball& a, const Ball& b) {
  const double mid = a.mid * b.mid;
  const double error = std::abs(a.mid) * b.error + a.error * (std::abs(b.mid) + b.error);
  return {mid, (error + Ball::kRoundoff * std::abs(mid)) * Ball::kOutward};
}

/// Of infinite error where the divisor may be 0.
inline Ball operator/(const Ball& a, const Ball& b) {
  const double least = std::abs(b.mid) * (1.0 - 0x1p-50) - b.error;
  if (!(least > 0.0)) return {0.0, std::numeric_limits<double>::infinity()};
  const double mid = a.mid / b.mid;
  const double error = (a.error + std::abs(mid) * b.error * Ball::kOutward) / least;
  return {mid, (error + Ball::kRoundoff * std::abs(mid)) * Ball::kOutward};
}

/// Of a number that is known not to be negative.
inline Ball sqrt(const Ball& a) {
  if (!(a.mid > a.error)) return {0.0, std::sqrt(std::abs(a.mid) + a.error) * Ball::kOutward};
  const double mid = std::sqrt(a.mid);
  // |√x - √m| = |x - m| / (√x + √m)
  return {mid, (a.error / mid + Ball::kRoundoff * mid) * Ball::kOutward};
}

}  // namespace raylab::exact
