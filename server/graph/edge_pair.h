// Two edges at once: the formulas of edge_terms.h on vectors of two numbers, which every x86-64 has (SSE2). Each lane
// does what the scalar code does, so that bytes do not depend on the machine.
#pragma once

#include <array>

#include "server/graph/edge_terms.h"

namespace rigcal::graph::pair {

using Double2 = double __attribute__((vector_size(16)));

struct Vector {
  Double2 x, y, z;
};
struct Quaternion {
  Vector v;
  Double2 w;
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(Double2 s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vector operator*(double s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Double2 Dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector Cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Quaternion Conjugate(const Quaternion& q) { return {{-q.v.x, -q.v.y, -q.v.z}, q.w}; }
inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.v + b.w * a.v + Cross(a.v, b.v), a.w * b.w - Dot(a.v, b.v)};
}
inline Vector Rotate(const Quaternion& q, const Vector& p) {
  const Vector t = 2.0 * Cross(q.v, p);
  return p + q.w * t + Cross(q.v, t);
}

inline Vector Load(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {Double2{a.x(), b.x()}, Double2{a.y(), b.y()}, Double2{a.z(), b.z()}};
}
inline Quaternion Load(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return {{Double2{a.x(), b.x()}, Double2{a.y(), b.y()}, Double2{a.z(), b.z()}}, Double2{a.w(), b.w()}};
}

template <std::size_t N>
inline Double2 Polynomial(const std::array<double, N>& c, Double2 x) {
  Double2 sum = {c[N - 1], c[N - 1]};
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// A twist or a force: [translation, rotation].
struct Twist {
  Vector linear, angular;
  [[nodiscard]] Vector6d Lane(int lane) const {
    Vector6d result;
    result << linear.x[lane], linear.y[lane], linear.z[lane], angular.x[lane], angular.y[lane], angular.z[lane];
    return result;
  }
};

struct State {
  Quaternion q_i_j;
  Vector p_i_j_m;
  Twist e;
};

// False where a rotation is too large for the series: then `state` means nothing.
inline bool StateAt(const Constraint& a, const Constraint& b, const std::vector<Se3>& T_ref, State& state) {
  const auto pose = [&T_ref](int vertex) -> const Se3& { return T_ref[static_cast<std::size_t>(vertex)]; };
  const Se3 &a_i = pose(a.i), &a_j = pose(a.j), &b_i = pose(b.i), &b_j = pose(b.j);
  const Quaternion q_i_ref = Conjugate(Load(a_i.q, b_i.q));
  state.q_i_j = q_i_ref * Load(a_j.q, b_j.q);
  state.p_i_j_m = Rotate(q_i_ref, Load(a_j.p_m, b_j.p_m) - Load(a_i.p_m, b_i.p_m));
  const Quaternion q_j_i = Load(a.T_j_i.q, b.T_j_i.q);
  const Quaternion q = q_j_i * state.q_i_j;
  const Vector p_m = Rotate(q_j_i, state.p_i_j_m) + Load(a.T_j_i.p_m, b.T_j_i.p_m);
  const Double2 sine2 = Dot(q.v, q.v);
  if (!(sine2[0] < series::kSineBelow2 && sine2[1] < series::kSineBelow2)) return false;
  const Double2 sign = {std::copysign(2.0, q.w[0]), std::copysign(2.0, q.w[1])};
  const Vector phi = (sign * Polynomial(series::kArcsineOver, sine2)) * q.v;
  const Vector turned = Cross(phi, p_m);
  const Double2 h = Polynomial(series::kHalfCotangentRestOver2, Dot(phi, phi));
  state.e = {p_m - 0.5 * turned + h * Cross(phi, turned), phi};
  return true;
}

// Omega * e, lane by lane, columns first.
inline Twist Weighted(const Matrix6d& Omega_a, const Matrix6d& Omega_b, const Twist& e) {
  const std::array<Double2, 6> x = {e.linear.x, e.linear.y, e.linear.z, e.angular.x, e.angular.y, e.angular.z};
  std::array<Double2, 6> y{};
  for (int c = 0; c < 6; ++c)
    for (int r = 0; r < 6; ++r)
      y[static_cast<std::size_t>(r)] += Double2{Omega_a(r, c), Omega_b(r, c)} * x[static_cast<std::size_t>(c)];
  return {{y[0], y[1], y[2]}, {y[3], y[4], y[5]}};
}

// Jr^-1(e)^T * force; see JacobianTransposedTimes.
inline Twist ForceOnJ(const Twist& e, const Twist& force) {
  const Vector &rho = e.linear, &phi = e.angular;
  const Double2 t2 = Dot(phi, phi);
  const Double2 h = Polynomial(series::kHalfCotangentRestOver2, t2);
  const auto turn = [&phi, h](const Vector& v) {
    const Vector across = Cross(phi, v);
    return v - 0.5 * across + h * Cross(phi, across);
  };
  const Vector f = turn(force.linear);
  const Double2 a = Polynomial(series::kThetaMinusSineOver3, -t2), b = Polynomial(series::kCosineRestOver4, -t2);
  const Double2 c = Polynomial(series::kSineCosineRestOver5, -t2), d = Dot(phi, rho);
  const Vector Pf = Cross(phi, f), PPf = Cross(phi, Pf), Uf = Cross(rho, f), PUf = Cross(phi, Uf);
  const Vector Q_f = 0.5 * Uf + a * (Cross(rho, Pf) + PUf - d * Pf) +
                     b * (Cross(rho, PPf) + Cross(phi, PUf) + (3.0 * d) * Pf) - (2.0 * c * d) * PPf;
  return {f, turn(force.angular - Q_f)};
}

// Ad(T_j_i)^T * force.
inline Twist ForceOnI(const State& state, const Twist& force) {
  const Vector linear = Rotate(state.q_i_j, force.linear);
  return {linear, Rotate(state.q_i_j, force.angular) + Cross(state.p_i_j_m, linear)};
}

}  // namespace rigcal::graph::pair
