#include "server/calib/joint/misfit/lens_misfit.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib::joint {
namespace {

using Eigen::MatrixXd;

constexpr double kSameVariance = 0.1;  // ratio

bool IsNamed(const FoundMisfits& found, std::size_t camera) {
  return found.components.variance[camera] > 0 && found.components.evidence[camera] >= kMisfitEvidence;
}

// Of all control points; those that no corner reaches are left as they are.
Eigen::VectorXd MeanOf(const SessionProblem& problem, const FoundMisfits& found, std::size_t camera) {
  const RandomEffects& effects = found.equations.effects;
  const std::vector<int>& seen_points = found.equations.seen_points[camera];
  const Eigen::Index seen = effects.size(camera) / 2, all = FieldGridOf(problem.cameras[camera].picture).points();
  Eigen::VectorXd coefficients_px = Eigen::VectorXd::Zero(2 * all);
  coefficients_px.head(all)(seen_points) = found.components.mean.segment(effects.at[camera], seen);
  coefficients_px.tail(all)(seen_points) = found.components.mean.segment(effects.at[camera] + seen, seen);
  return coefficients_px;
}

// Of a field where the camera saw corners, of u and of v.
double RmsOf_px(const SessionProblem& problem, int camera, const Eigen::VectorXd& coefficients_px) {
  const FieldGrid grid = FieldGridOf(problem.cameras[static_cast<std::size_t>(camera)].picture);
  double squares = 0.0, numbers = 0.0;
  for (const CornersSeen& seen : problem.corners) {
    if (seen.camera != camera) continue;
    for (const Eigen::Vector2d& uv_px : seen.corners.uv_px) {
      squares += FieldAt(grid, coefficients_px, uv_px).squaredNorm();
      numbers += 2;
    }
  }
  return numbers > 0 ? std::sqrt(squares / numbers) : 0.0;
}

int SensorOf(const SessionProblem& problem, int camera) {
  const auto seen = std::find_if(problem.corners.begin(), problem.corners.end(),
                                 [&](const CornersSeen& look) { return look.camera == camera; });
  return seen == problem.corners.end() ? kNone : seen->sensor;
}

// Variance of each row of the poses' covariance by the field of one camera.
Eigen::VectorXd AddedBy(const FoundMisfits& found, std::size_t camera, const Layout& layout,
                        const PoseCovariance& covariance) {
  const RandomEffects& effects = found.equations.effects;
  MatrixXd by(covariance.joint.rows(), effects.size(camera));
  for (std::size_t s = 0; s < covariance.row_of_sensor.size(); ++s)
    if (const int row = covariance.row_of_sensor[s]; row != kNone)
      by.middleRows(row, 6) =
          found.equations.by_unknowns.block(layout.pose[s], effects.at[camera], 6, effects.size(camera));
  return PosteriorThrough(found.components, camera, by).diagonal().cwiseMax(0.0);
}

void TellPoses(const Eigen::VectorXd& added, const PoseCovariance& covariance, LensMisfit& told) {
  for (const int row : covariance.row_of_sensor) {
    if (row == kNone) continue;
    told.pose_sigma_m = std::max(told.pose_sigma_m, std::sqrt(added.segment<3>(row).maxCoeff()));
    told.pose_sigma_rad = std::max(told.pose_sigma_rad, std::sqrt(added.segment<3>(row + 3).maxCoeff()));
  }
  told.sigma_ratio = std::sqrt(1 + added.cwiseQuotient(covariance.without_beside.diagonal()).maxCoeff());
}

}  // namespace

bool FoundMisfits::any() const {
  for (std::size_t camera = 0; camera < components.variance.size(); ++camera)
    if (IsNamed(*this, camera)) return true;
  return false;
}

FoundMisfits FindMisfits(const SessionProblem& problem, const Refined& refined) {
  FoundMisfits found;
  found.equations = FieldEquationsOf(problem, refined);
  found.components = EstimateComponents(found.equations.effects);
  found.held = !refined.state.field_px.empty();
  return found;
}

SessionState WithFields(const SessionProblem& problem, const FoundMisfits& found, SessionState state) {
  state.field_px.assign(problem.cameras.size(), {});
  state.field_dof.assign(problem.cameras.size(), 0.0);
  for (std::size_t camera = 0; camera < problem.cameras.size(); ++camera) {
    if (!(found.components.variance[camera] > 0)) continue;
    state.field_px[camera] = MeanOf(problem, found, camera);
    state.field_dof[camera] = found.components.dof[camera];
  }
  return state;
}

bool SameFields(const FoundMisfits& x, const FoundMisfits& y) {
  for (std::size_t camera = 0; camera < x.components.variance.size(); ++camera) {
    const double a = x.components.variance[camera], b = y.components.variance[camera];
    if ((IsNamed(x, camera) || IsNamed(y, camera)) && std::abs(a - b) > kSameVariance * std::max(a, b)) return false;
  }
  return true;
}

// A variance counts whether or not it is beyond chance: sigmas after a test would be too small wherever it just fails.
MatrixXd CovarianceByFields(const FoundMisfits& found) {
  return found.held ? PosteriorThrough(found.components, found.equations.by_unknowns)
                    : PriorThrough(found.components, found.equations.by_unknowns);
}

std::vector<LensMisfit> MisfitsTold(const SessionProblem& problem, const Refined& refined, const FoundMisfits& found,
                                    const PoseCovariance& covariance) {
  std::vector<LensMisfit> told;
  for (std::size_t camera = 0; camera < problem.cameras.size(); ++camera) {
    const int sensor = SensorOf(problem, static_cast<int>(camera));
    if (!IsNamed(found, camera) || sensor == kNone) continue;
    const SensorId& name = problem.sensors[static_cast<std::size_t>(sensor)];
    if (std::any_of(told.begin(), told.end(), [&](const LensMisfit& before) { return before.camera == name; }))
      continue;  // it changed
    LensMisfit one;
    one.camera = name;
    one.model = problem.cameras[camera].model;
    one.rms_px = RmsOf_px(problem, static_cast<int>(camera), MeanOf(problem, found, camera));
    one.evidence = found.components.evidence[camera];
    TellPoses(AddedBy(found, camera, refined.layout, covariance), covariance, one);
    told.push_back(std::move(one));
  }
  std::sort(told.begin(), told.end(), [](const LensMisfit& x, const LensMisfit& y) { return x.camera < y.camera; });
  return told;
}

}  // namespace rigcal::calib::joint
