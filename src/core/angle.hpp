#pragma once
// Sine and cosine of angles in degrees by additions and multiplications alone, so that pictures do not depend on the
// machine's mathematical library. Local to the including file.
#include <cmath>

namespace raylab {
namespace {

struct SineCosine {
  double sine, cosine;
  double tangent() const { return sine / cosine; }
};

/// Exact at quarter turns, elsewhere to about one unit in the last place.
inline SineCosine sine_cosine_of_degrees(double degrees) {
  const double rest = std::remainder(degrees, 90.0);  // without rounding
  const double x = rest * (3.14159265358979323846 / 180.0);
  const double z = x * x;
  // The Taylor series: in [-pi/4, pi/4] what is left out is below 2^-60.
  double sine = 0.0, cosine = 0.0;
  for (int k = 8; k >= 1; --k) {
    sine = (1.0 + sine) * (-z / (2 * k * (2 * k + 1)));
    cosine = (1.0 + cosine) * (-z / (2 * k * (2 * k - 1)));
  }
  sine = x + x * sine;
  cosine = 1.0 + cosine;
  const int quarter = static_cast<int>(std::fmod((degrees - rest) / 90.0, 4.0) + 4.0) % 4;
  if (quarter == 0) return {sine, cosine};
  if (quarter == 1) return {cosine, -sine};
  if (quarter == 2) return {-sine, -cosine};
  return {-cosine, sine};
}

}  // namespace
}  // namespace raylab
