#include "surd.hpp"

#include <cmath>

namespace raylab::exact {

namespace {

/// x 2^bits; checked integers shift no negative ones.
Integer shifted(const Integer& x, int bits) { return x.sign() < 0 ? -Integer(-x << bits) : x << bits; }

/// The sign of e + s √x.
int sign_with_root(const Integer& e, int s, const Integer& x) {
  if (x.is_zero()) s = 0;
  const int sign = e.sign();
  if (s == 0 || sign == s) return sign;
  if (sign == 0) return s;
  const int larger = Integer(e * e).compare(x);
  return larger > 0 ? sign : larger < 0 ? s : 0;
}

/// The sign of e + s1 √x1 + s2 √x2.
int sign_with_roots(const Integer& e, int s1, const Integer& x1, int s2, const Integer& x2) {
  if (s1 == 0 || x1.is_zero()) return sign_with_root(e, s2, x2);
  if (s2 == 0 || x2.is_zero()) return sign_with_root(e, s1, x1);
  const int sign = e.sign();
  const int larger = x1.compare(x2);
  const int sign_of_roots = s1 == s2 || larger > 0 ? s1 : larger < 0 ? s2 : 0;
  if (sign == 0 || sign == sign_of_roots) return sign_of_roots;
  if (sign_of_roots == 0) return sign;
  // Of opposite signs: the squares decide, and that of the roots holds a root itself.
  const int roots_larger = sign_with_root(x1 + x2 - e * e, s1 * s2, 4 * x1 * x2);
  return roots_larger > 0 ? sign_of_roots : roots_larger < 0 ? sign : 0;
}

}  // namespace

int compare(const Surd& a, const Surd& b) {
  Integer pa = a.p, qa = a.q, pb = b.p, qb = b.q;
  if (const int shift = a.exponent - b.exponent; shift > 0) {
    pa = shifted(pa, shift);
    qa = shifted(qa, 2 * shift);
  } else {
    pb = shifted(pb, -shift);
    qb = shifted(qb, -2 * shift);
  }
  if (a.r != b.r) {  // two spheres have the same divisor, and need not be multiplied by it
    pa *= b.r;
    pb *= a.r;
    if (a.s != 0) qa *= b.r * b.r;
    if (b.s != 0) qb *= a.r * a.r;
  }
  return sign_with_roots(pa - pb, a.s, qa, -b.s, qb);
}

double approximate(const Surd& x) {
  using Real = long double;  // for its range
  const auto scale = [&](Real y) { return static_cast<double>(std::ldexp(y, x.exponent)); };
  const auto p = x.p.convert_to<Real>();
  const auto r = x.r.convert_to<Real>();
  if (x.s == 0) return scale(p / r);
  const Real root = std::sqrt(x.q.convert_to<Real>());
  if (x.p.sign() != -x.s) return scale((p + x.s * root) / r);
  // The two cancel; their sum times their difference is p² - q.
  const Integer product = x.p * x.p - x.q;
  return scale(product.convert_to<Real>() / r / (p - x.s * root));
}

Integer scaled(double x, int exponent) {
  int place;
  const double mantissa = std::frexp(x, &place);
  const auto digits = static_cast<long long>(std::ldexp(mantissa, 53));
  if (digits == 0) return 0;
  const int shift = place - 53 - exponent;
  return shift < 0 ? Integer(digits >> -shift) : shifted(digits, shift);
}

}  // namespace raylab::exact
