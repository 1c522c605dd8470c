#include "server/calib/core/pair_edge.h"
#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"

namespace rigcal::calib {
namespace {

Edge EdgeOf(const LidarLidarProblem& problem) {
  return UnsolvedEdge(problem.lidar_a.id, problem.lidar_b.id, Method::kLidarLidar, problem.captures.size());
}

Edge FailedEdge(const LidarLidarProblem& problem, const Diagnosis& diagnosis) {
  Edge edge = EdgeOf(problem);
  for (const LidarLidarCapture& capture : problem.captures)
    edge.captures.push_back(
        {capture.capture, 0.0, false, capture.why_not.empty() ? "the pair was not solved" : capture.why_not});
  return FailedFor({diagnosis}, std::move(edge));
}

Vector6d MovedByPolish(const LidarLidarEstimate& estimate) {
  return (estimate.T_a_b_ndt.Inverse() * estimate.T_a_b_polished).Log();
}

// "held_out_captures_...": of each capture by the pose without it; "held_out_halves_...": of each half of one capture's
// points by the pose from the other half.
void AddMetrics(const LidarLidarEstimate& estimate, Edge& edge) {
  double used = 0;
  for (const CaptureResidual& residual : estimate.residuals) used += residual.used ? 1 : 0;
  edge.figures["captures_used"] = used;
  edge.figures["voxel_m"] = estimate.voxel_m;
  edge.figures["overlap_ratio"] = estimate.overlap_ratio;
  edge.figures["match_ratio"] = estimate.match_ratio;
  edge.figures["starts_agreeing_ratio"] = estimate.agreeing_ratio;
  const std::string held_out = estimate.check_on_captures ? "held_out_captures_" : "held_out_halves_";
  edge.figures[held_out + "pairs"] = static_cast<double>(estimate.check.pairs);
  edge.figures[held_out + "normals"] = static_cast<double>(estimate.check.normals);
  if (estimate.check.normals > 0) {
    edge.figures[held_out + "D_ratio"] = estimate.check.D;
    edge.figures[held_out + "D_angle_rad"] = estimate.check.angle_rad;
  }
  edge.figures[held_out + "E_l_m"] = estimate.check.E_l_m;
  edge.figures[held_out + "E_l_rms_m"] = estimate.check.rms_m;
  if (!estimate.check_on_captures) {
    edge.figures["halves_differ_m"] = estimate.halves_m;
    edge.figures["halves_differ_rad"] = estimate.halves_rad;
  }
  edge.figures["polished_ratio"] = estimate.polished ? 1 : 0;
  const Vector6d moved = MovedByPolish(estimate);
  edge.figures["polish_moved_m"] = moved.head<3>().norm();
  edge.figures["polish_moved_rad"] = moved.tail<3>().norm();
}

Edge EdgeOrReason(const LidarLidarProblem& problem) {
  std::vector<Diagnosis> notes;
  auto estimate = EstimateLidarLidar(problem, &notes);
  if (!estimate) return FailedEdge(problem, estimate.error());
  Edge edge = Good(estimate->T_a_b, std::move(estimate->uncertainty), std::move(notes), EdgeOf(problem));
  edge.captures = estimate->residuals;
  if (estimate->polished) edge.diagnoses.push_back(PolishedPose(problem, MovedByPolish(*estimate)));
  AddMetrics(*estimate, edge);
  return edge;
}

}  // namespace

Edge EstimateLidarLidarEdge(const LidarLidarProblem& problem) {
  return Guarded([&] { return EdgeOrReason(problem); },
                 [&](const Error& error) { return FailedEdge(problem, LidarLidarError(problem, error)); });
}

}  // namespace rigcal::calib
