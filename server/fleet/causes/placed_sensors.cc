#include "server/fleet/causes/placed_sensors.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace rigcal::fleet {
namespace {

constexpr double kPlaceMaxSigmas = 5.0;
constexpr int kStepsMax = 20;
constexpr double kShortestStep = 1e-3, kNearer = 1.0 - 1e-9;

using Directions = Eigen::Matrix<double, 6, Eigen::Dynamic>;

std::optional<Placed> PlacedOf(const SensorPose& pose, const SensorId& reference,
                               const std::vector<const SessionHeader*>& newest) {
  for (const SessionHeader* header : newest) {
    const Sensor *from = SensorOf(*header, reference), *sensor = SensorOf(*header, pose.sensor);
    const auto drawn = from && sensor ? NominalPose(*header, *from, *sensor) : std::nullopt;
    if (!drawn) continue;
    const Matrix6d& covariance = pose.known ? pose.covariance : pose.measured_part->covariance;
    const double variance_m2 = covariance.diagonal().head<3>().maxCoeff();
    return Placed{pose.sensor,
                  sensor->kind,
                  *pose.Placed(),
                  *drawn,
                  std::sqrt(std::max(variance_m2, 0.0)),
                  pose.unobservable_basis};
  }
  return std::nullopt;
}

PlaceLimit AtLeastFiveSigmas(const Placed& placed, const PlaceLimit& limit) {
  return {std::max(limit.place_m, kPlaceMaxSigmas * placed.sigma_m), limit.turn_rad};
}

// Away(), in limits.
Vector6d Scaled(const Vector6d& away, const PlaceLimit& limit) {
  return away.cwiseQuotient(EachAxis(limit.place_m, limit.turn_rad));
}

// Of Away(place, T) by a step of T, right tangent.
Matrix6d ByStep(const Se3& T, const Vector6d& away) {
  Vector6d turn = Vector6d::Zero();
  turn.tail<3>() = away.tail<3>();
  Matrix6d by_step = Matrix6d::Zero();
  by_step.topLeftCorner<3, 3>() = T.R();
  by_step.bottomRightCorner<3, 3>() = RightJacobianInverse(turn).bottomRightCorner<3, 3>();
  return by_step;
}

// Slides a sensor along what is open towards a place.
struct Slide {
  const Se3 &from, &place;
  const PlaceLimit& limit;
  Directions open;
  Eigen::VectorXd along = Eigen::VectorXd::Zero(open.cols());

  [[nodiscard]] Se3 At(const Eigen::VectorXd& there) const { return from * Se3::Exp(open * there); }
  [[nodiscard]] Vector6d Off(const Eigen::VectorXd& there) const { return Scaled(Away(place, At(there)), limit); }
  // The full step of Gauss and Newton, or the part of it that comes nearer; false: none does.
  bool Step() {
    const Se3 T = At(along);
    const Directions by_along = ByStep(T, Away(place, T)) * RightJacobian(open * along) * open;
    const Directions scaled = EachAxis(1 / limit.place_m, 1 / limit.turn_rad).asDiagonal() * by_along;
    const Vector6d off = Off(along);
    if (!scaled.allFinite()) return false;
    const Eigen::VectorXd step = -scaled.completeOrthogonalDecomposition().solve(off);
    for (double part = 1.0; part > kShortestStep; part /= 2) {
      const Eigen::VectorXd tried = along + part * step;
      if (!(Off(tried).norm() < kNearer * off.norm())) continue;
      along = tried;
      return true;
    }
    return false;
  }
};

Directions AsColumns(const std::vector<Vector6d>& directions) {
  Directions columns(6, static_cast<Eigen::Index>(directions.size()));
  for (std::size_t k = 0; k < directions.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = directions[k];
  return columns;
}

}  // namespace

Vector6d Away(const Se3& drawn, const Se3& measured) {
  Vector6d away;
  away << measured.p_m - drawn.p_m, (drawn.Inverse() * measured).Log().tail<3>();
  return away;
}

Se3 NearestTo(const Placed& placed, const Se3& place, const PlaceLimit& limit) {
  if (placed.open.empty()) return placed.measured;
  const PlaceLimit by = AtLeastFiveSigmas(placed, limit);
  Slide slide{placed.measured, place, by, AsColumns(placed.open)};
  for (int step = 0; step < kStepsMax && slide.Step(); ++step) {
  }
  return slide.At(slide.along);
}

double TimesTooFar(const Placed& placed, const Se3& place, const PlaceLimit& limit) {
  const Vector6d off = Scaled(Away(place, NearestTo(placed, place, limit)), AtLeastFiveSigmas(placed, limit));
  return std::max(off.head<3>().norm(), off.tail<3>().norm());
}

bool IsFar(const Placed& placed, const PlaceLimit& limit) { return TimesTooFar(placed, placed.drawn, limit) > 1; }

std::string OffNominalText(const Placed& placed, const PlaceLimit& limit) {
  return OffText(Away(placed.drawn, NearestTo(placed, placed.drawn, limit)));
}

std::string ByMeasuredText(const Placed& placed) { return placed.open.empty() ? "" : ", by what was measured of it"; }

std::vector<Placed> PlacedSensors(const GraphSolution& solution, const SessionHeaders& headers,
                                  const SensorId& reference) {
  const std::vector<const SessionHeader*> newest = NewestFirst(headers);
  std::vector<Placed> placed;
  for (const SensorPose& pose : solution.poses)
    if (pose.Placed() != nullptr)
      if (const auto one = PlacedOf(pose, reference, newest)) placed.push_back(*one);
  return placed;
}

std::vector<EdgeId> TakeMatchedFromDrawing(CauseSearch& search, const std::set<SensorId>& misplaced) {
  return IdsOf(search.Take([&](const Edge& edge) {
    return FailedFor(edge, {"low_overlap", "poor_fit", "starts_disagree", "ambiguous_pose", "not_converged"}) &&
           edge.method == "lidar_lidar" && (misplaced.contains(edge.frame_a) || misplaced.contains(edge.frame_b));
  }));
}

std::set<SensorId> MisplacedBy(const std::vector<RootCause>& causes) {
  std::set<SensorId> misplaced;
  for (const RootCause& cause : causes)
    if (cause.kind == CauseKind::kExchanged || cause.kind == CauseKind::kFarFromNominal ||
        cause.kind == CauseKind::kNominalUnit)
      misplaced.insert(cause.sensors.begin(), cause.sensors.end());
  return misplaced;
}

}  // namespace rigcal::fleet
