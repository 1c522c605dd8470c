#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "client/sim/rig/rig_yaml.h"
#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {

sim::Experiment MarsMapper(const sim::Options& options) {
  auto rig = sim::LoadRig("mars-mapper");
  auto experiment = rig ? sim::Prepare(std::move(*rig), options) : Result<sim::Experiment>(Fail(rig.error()));
  if (experiment) return std::move(*experiment);
  std::fprintf(stderr, "%s\n", Sentence(experiment.error()).c_str());
  std::exit(1);
}

RigCase Calibrated(FeatureSession session) {
  RigCase rig{std::move(session), {}, {}};
  rig.edges = EdgesOf(rig.session);
  rig.solution = SolveRig(rig.edges, rig.session.header.reference);
  return rig;
}

Vector6d EdgeError(const RigCase& rig, const Edge& edge) {
  const sim::Experiment& experiment = rig.session.experiment;
  const Se3 truth = experiment.T_ref_sensor(edge.frame_a).Inverse() * experiment.T_ref_sensor(edge.frame_b);
  return (edge.T_a_b.Inverse() * truth).Log();
}

Vector6d PoseError(const RigCase& rig, const SensorPose& pose) {
  return (pose.T_ref_sensor.Inverse() * rig.session.experiment.T_ref_sensor(pose.sensor)).Log();
}

double WorstAxis(const Vector6d& error, const Matrix6d& covariance) {
  return error.cwiseAbs().cwiseQuotient(covariance.diagonal().cwiseSqrt()).maxCoeff();
}

double WorstKnownAxis(const Vector6d& error, const Uncertainty& uncertainty) {
  double worst = 0;
  for (int axis = 0; axis < 6; ++axis)
    if (const AxisSigma sigma = SigmaOf(uncertainty, axis); sigma.known)
      worst = std::max(worst, std::abs(error[axis]) / sigma.value);
  return worst;
}

// Directions are those of the information with its diagonal scaled to one, so that metres and radians compare.
Eigen::VectorXd ClaimedSigmas(const Vector6d& error, const Uncertainty& uncertainty) {
  const Vector6d scale = uncertainty.Omega.diagonal().cwiseMax(1e-12).cwiseSqrt();
  const Matrix6d scaled = scale.cwiseInverse().asDiagonal() * uncertainty.Omega * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scaled);
  const Vector6d along = solver.eigenvectors().transpose() * (scale.asDiagonal() * error);
  return along.cwiseAbs().cwiseProduct(solver.eigenvalues().cwiseMax(0).cwiseSqrt()).tail(uncertainty.rank);
}

int CountFailed(const std::vector<Edge>& edges) {
  return static_cast<int>(
      std::count_if(edges.begin(), edges.end(), [](const Edge& edge) { return edge.state != EdgeState::kGood; }));
}

}  // namespace rigcal
