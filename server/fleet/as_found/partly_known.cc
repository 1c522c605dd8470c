#include "server/fleet/as_found/partly_known.h"

#include <algorithm>
#include <cmath>

namespace rigcal::fleet {
namespace {

constexpr double kSameDirection = 0.08715574274765817;  // the sine of 5 degrees
constexpr double kBesideOpen = 0.17364817766693033;     // of 10 degrees
constexpr double kHeldApart = 0.1;                      // m or rad
constexpr double kNoDirection = 1e-9;

// Directions that either side leaves open, and by how much those of both that are taken for one are apart.
struct OpenOfBoth {
  std::vector<Vector6d> basis;                               // orthonormal
  std::vector<std::pair<std::size_t, Vector6d>> misaligned;  // of a direction of the basis, the rest of the other's

  [[nodiscard]] Vector6d Across(Vector6d v) const {
    for (const Vector6d& q : basis) v -= q * q.dot(v);
    return v;
  }
};

void AddOpen(const Vector6d& direction, OpenOfBoth& open) {
  if (!(direction.norm() > kNoDirection)) return;
  const Vector6d unit = direction.normalized(), rest = open.Across(unit);
  if (open.basis.empty() || rest.norm() > kSameDirection) {
    open.basis.push_back(rest.normalized());
    return;
  }
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < open.basis.size(); ++k)
    if (std::abs(open.basis[k].dot(unit)) > std::abs(open.basis[nearest].dot(unit))) nearest = k;
  open.misaligned.emplace_back(nearest, rest);
}

OpenOfBoth DirectionsOpenIn(const PartOfBoth& part) {
  OpenOfBoth open;
  for (const PartlyKnown* side : {&part.in_use, &part.session})
    for (const Vector6d& direction : side->open) AddOpen(direction, open);
  return open;
}

// Of both sides, the frame's own included, and of what nobody tells.
struct PartErrors {
  Matrix6d in_use, session;
  Vector6d assumed;
};
PartErrors ErrorsOfPart(const PartOfBoth& part, const FrameOfBoth& frame, const Se3& T_frame_sensor,
                        const PoseLimit& scatter) {
  const Matrix6d by_frame = Adjoint(T_frame_sensor.Inverse());
  PartErrors errors{part.in_use.covariance + by_frame * frame.covariance_in_use * by_frame.transpose(),
                    part.session.covariance + by_frame * frame.covariance_session * by_frame.transpose(),
                    Vector6d::Zero()};
  errors.assumed.head<3>().setConstant(2 * scatter.m * scatter.m);  // of a visit in use, and of this one
  errors.assumed.tail<3>().setConstant(2 * scatter.rad * scatter.rad);
  return errors;
}

}  // namespace

std::optional<PartlyKnown> PartOf(const SensorId& sensor, const GraphSolution& solution,
                                  const std::vector<Edge>& edges) {
  const auto pose = std::find_if(solution.poses.begin(), solution.poses.end(),
                                 [&](const SensorPose& one) { return one.sensor == sensor; });
  if (pose == solution.poses.end() || pose->Placed() == nullptr) return std::nullopt;
  PartlyKnown part{sensor, *pose->Placed(), pose->known ? pose->covariance : pose->measured_part->covariance, {}, 0.0};
  if (!pose->known) part.open = pose->unobservable_basis;
  for (const Edge& edge : edges)
    if (edge.state == EdgeState::kGood && edge.uncertainty.dof > 0 &&
        (edge.frame_a == sensor || edge.frame_b == sensor))
      part.dof = part.dof > 0 ? std::min<double>(part.dof, edge.uncertainty.dof) : edge.uncertainty.dof;
  return part;
}

std::optional<ChangeSeen> ChangeOfPart(const PartOfBoth& part, const FrameOfBoth& frame, const PoseLimit& scatter) {
  const Se3 was = frame.T_ref_in_use.Inverse() * part.in_use.T_ref_sensor,
            is = frame.T_ref_session.Inverse() * part.session.T_ref_sensor;
  const Vector6d change = (was.Inverse() * is).Log();
  const OpenOfBoth open = DirectionsOpenIn(part);
  Matrix6d P = Matrix6d::Identity();
  for (const Vector6d& q : open.basis) {
    if (!(std::abs(q.dot(change)) <= kHeldApart)) return std::nullopt;
    P -= q * q.transpose();
  }
  PartErrors errors = ErrorsOfPart(part, frame, was, scatter);
  for (const auto& [at, rest] : open.misaligned)
    errors.session += std::pow(open.basis[at].dot(change), 2) * rest * rest.transpose();
  errors.in_use = P * errors.in_use * P;
  errors.session = P * errors.session * P;
  const Matrix6d assumed = P * errors.assumed.asDiagonal() * P;
  ChangeSeen seen{frame.frame,
                  {part.session.sensor},
                  {was},
                  P * change,
                  errors.in_use + errors.session + assumed,
                  assumed.diagonal(),
                  {}};
  for (Eigen::Index row = 0; row < 6; ++row) {
    seen.dof.push_back(WelchDof(errors.in_use(row, row), part.in_use.dof, errors.session(row, row), part.session.dof));
    if (P.row(row).norm() <= kBesideOpen) seen.change(row) = 0.0, seen.covariance(row, row) = kNothingKnown;
  }
  return seen;
}

}  // namespace rigcal::fleet
