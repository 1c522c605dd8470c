// One edge at given poses: residual, Jacobians and forces in closed form, by cross products where residuals are small
// (every edge of a sound graph). Larger rotations go through server/math; both agree to rounding.
#pragma once

#include "server/graph/large/lane_kernels.h"
#include "server/graph/solve/problem.h"

namespace rigcal::graph {

// [D U; 0 D]: both Jacobians of an edge have this shape, which saves half of every product.
struct UpperBlocks {
  Eigen::Matrix3d D, U;
};

// e = Log(T_j_i_measured * T_i_j).
struct EdgeState {
  Se3 T_i_j;
  Vector6d e;
};

// Log of the pose (p_m, q) by its series: `sine2`, the squared sine of half its angle, is below series::kSineBelow2.
inline Vector6d SmallLog(const Eigen::Vector3d& p_m, const Eigen::Quaterniond& q, double sine2) {
  const Eigen::Vector3d phi = (std::copysign(2.0, q.w()) * series::Polynomial(series::kArcsineOver, sine2)) * q.vec();
  const Eigen::Vector3d turned = phi.cross(p_m);
  Vector6d xi;
  xi.head<3>() =
      p_m - 0.5 * turned + series::Polynomial(series::kHalfCotangentRestOver2, phi.squaredNorm()) * phi.cross(turned);
  xi.tail<3>() = phi;
  return xi;
}

// At the poses of its two vertices.
inline EdgeState EdgeStateAt(const Constraint& constraint, const Se3& T_ref_i, const Se3& T_ref_j) {
  EdgeState state;
  const Eigen::Quaterniond q_i_ref = T_ref_i.q.conjugate();
  state.T_i_j.q = q_i_ref * T_ref_j.q;
  state.T_i_j.p_m = q_i_ref._transformVector(T_ref_j.p_m - T_ref_i.p_m);
  const Eigen::Quaterniond q = constraint.T_j_i.q * state.T_i_j.q;
  const Eigen::Vector3d p_m = constraint.T_j_i.q._transformVector(state.T_i_j.p_m) + constraint.T_j_i.p_m;
  const double sine2 = q.vec().squaredNorm();
  state.e = sine2 < series::kSineBelow2 ? SmallLog(p_m, q, sine2) : Se3{p_m, q}.Log();
  return state;
}

// Jr^-1(e)^T * force.
inline Vector6d JacobianTransposedTimes(const Vector6d& e, const Vector6d& force) {
  const Eigen::Vector3d rho = e.head<3>(), phi = e.tail<3>();
  const double t2 = phi.squaredNorm();
  if (t2 >= series::kAngleBelow2) return RightJacobianInverse(e).transpose() * force;
  const double h = series::Polynomial(series::kHalfCotangentRestOver2, t2);
  const auto turn = [&phi, h](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    const Eigen::Vector3d across = phi.cross(v);
    return v - 0.5 * across + h * phi.cross(across);
  };
  const Eigen::Vector3d f = turn(force.head<3>());
  // Q^T f of Barfoot & Furgale 2014, eq. 102, with P = [phi]x, U = [rho]x and P U P = -(phi . rho) P.
  const double a = series::Polynomial(series::kThetaMinusSineOver3, -t2),
               b = series::Polynomial(series::kCosineRestOver4, -t2);
  const double c = series::Polynomial(series::kSineCosineRestOver5, -t2), d = phi.dot(rho);
  const Eigen::Vector3d Pf = phi.cross(f), PPf = phi.cross(Pf), Uf = rho.cross(f), PUf = phi.cross(Uf);
  const Eigen::Vector3d Q_f = 0.5 * Uf + a * (rho.cross(Pf) + PUf - d * Pf) +
                              b * (rho.cross(PPf) + phi.cross(PUf) + 3.0 * d * Pf) - 2.0 * c * d * PPf;
  Vector6d result;
  result.head<3>() = f;
  result.tail<3>() = turn(force.tail<3>() - Q_f);
  return result;
}

// Jr^-1(e).
inline UpperBlocks JacobianOf(const Vector6d& e) {
  const Eigen::Vector3d rho = e.head<3>(), phi = e.tail<3>();
  const double t2 = phi.squaredNorm();
  if (t2 >= series::kAngleBelow2) {
    const Matrix6d J = RightJacobianInverse(e);
    return {J.topLeftCorner<3, 3>(), J.topRightCorner<3, 3>()};
  }
  const double a = series::Polynomial(series::kThetaMinusSineOver3, -t2),
               b = series::Polynomial(series::kCosineRestOver4, -t2);
  const double c = series::Polynomial(series::kSineCosineRestOver5, -t2), d = phi.dot(rho);
  const Eigen::Matrix3d P = Hat(phi);
  const Eigen::Matrix3d PP = phi * phi.transpose() - t2 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d outer = rho * phi.transpose(), turned = phi.cross(rho) * phi.transpose();
  const Eigen::Matrix3d Q = -0.5 * Hat(rho) + a * (outer + outer.transpose() - 2.0 * d * Eigen::Matrix3d::Identity()) -
                            b * (turned - turned.transpose()) + (a - b) * d * P - 2.0 * c * d * PP;
  UpperBlocks J;
  J.D = Eigen::Matrix3d::Identity() + 0.5 * P + series::Polynomial(series::kHalfCotangentRestOver2, t2) * PP;
  J.U.noalias() = -J.D * (Q * J.D).eval();
  return J;
}

// Ad(T_j_i)^T * force: a force on j as a force on i.
inline Vector6d ForceOnI(const Se3& T_i_j, const Vector6d& force) {
  Vector6d result;
  result.head<3>() = T_i_j.q._transformVector(force.head<3>());
  result.tail<3>() = T_i_j.q._transformVector(force.tail<3>()) + T_i_j.p_m.cross(result.head<3>());
  return result;
}

}  // namespace rigcal::graph
