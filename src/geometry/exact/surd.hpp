#pragma once
// Numbers that distances along a ray are: fractions of integers, with one square root where the ray meets a
// sphere.
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>

namespace raylab::exact {

/// Integers on the stack; more than 4096 bits would throw. In units of the smallest float a coordinate takes at
/// most 210 bits, a direction or an origin 277. The largest numbers made of them, when two spheres are compared,
/// have as factors the squares of four distances and four directions, of 278 bits each, and a shift by 4 · 253 to
/// common units: 3240 bits.
using Integer = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<4096, 4096, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::checked, void>,
    boost::multiprecision::et_off>;

/// (p + s √q) / r · 2^exponent with q >= 0, r > 0 and s one of -1, 0, 1.
struct Surd {
  Integer p, q, r;
  int s;
  int exponent;
};

/// The sign of a - b.
int compare(const Surd& a, const Surd& b);

/// Within a relative 2^-44.
double approximate(const Surd& x);

/// x / 2^exponent, which must be an integer.
Integer scaled(double x, int exponent);

/// Exponent e of the last of a float's 24 bits: x is a multiple of 2^e.
inline int last_place(float x) {
  int exponent;
  std::frexp(x, &exponent);
  return exponent - 24;
}

}  // namespace raylab::exact
