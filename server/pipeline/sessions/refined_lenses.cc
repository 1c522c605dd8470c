#include "server/pipeline/sessions/refined_lenses.h"

#include <algorithm>

#include "server/pipeline/sessions/session_refinement.h"
#include "storage/sessions/session_estimates.h"

namespace rigcal::pipeline {
namespace {

void Take(const RefinedLens& lens, const SessionId& session, report::CameraReport& camera) {
  camera.fit.intrinsics = lens.intrinsics;
  // Where pictures tell how boards seem to move with the lens: what a report draws needs both.
  const bool is_drawn = camera.fit.implied_motion.cols() == lens.covariance.cols();
  camera.fit.covariance = is_drawn ? lens.covariance : Eigen::MatrixXd();
  const Eigen::VectorXd sigma = lens.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  camera.fit.sigma.assign(sigma.begin(), sigma.end());
  camera.fit.sigma_by_jackknife = false;
  camera.refined_in = session;
}

bool Counts(const formats::RevisionInput& revision, const SessionId& session, const SensorId& camera) {
  return std::any_of(revision.edges.begin(), revision.edges.end(), [&](const Edge& edge) {
    return edge.session == session && edge.state == EdgeState::kGood &&
           (edge.frame_a == camera || edge.frame_b == camera);
  });
}

// Of the newest session that tells this camera's pose; nothing where that held it.
const RefinedLens* LensOf(const std::vector<storage::SessionEstimateRow>& newest_first,
                          const formats::RevisionInput& revision, const SensorId& camera, SessionId& session) {
  const std::vector<SessionId>& fused = revision.solution.fused.sessions;
  for (const storage::SessionEstimateRow& row : newest_first) {
    if (!row.estimate || std::find(fused.begin(), fused.end(), row.session) == fused.end()) continue;
    const SessionEstimate& estimate = *row.estimate;
    const bool tells = std::any_of(estimate.poses.begin(), estimate.poses.end(),
                                   [&](const RefinedPose& pose) { return pose.sensor == camera; });
    if (!tells || !Counts(revision, row.session, camera)) continue;
    session = row.session;
    const auto lens = std::find_if(estimate.lenses.begin(), estimate.lenses.end(),
                                   [&](const RefinedLens& one) { return one.camera == camera; });
    return lens == estimate.lenses.end() ? nullptr : &*lens;
  }
  return nullptr;
}

}  // namespace

Status TakeRefinedLenses(storage::Store& store, const formats::RevisionInput& revision,
                         std::vector<report::CameraReport>& cameras) {
  if (revision.solution.fused.sessions.empty() || cameras.empty()) return {};
  RIGCAL_ASSIGN(const auto rows,
                storage::LoadSessionEstimates(store, revision.robot, kSessionEstimator, kSessionsFused));
  for (report::CameraReport& camera : cameras) {
    SessionId session;
    const RefinedLens* lens = LensOf(rows, revision, camera.fit.camera, session);
    if (lens == nullptr || camera.fit.source == IntrinsicsSource::kNone ||
        camera.fit.source == IntrinsicsSource::kGiven || camera.fit.intrinsics.model != lens->intrinsics.model)
      continue;
    Take(*lens, session, camera);
  }
  return {};
}

}  // namespace rigcal::pipeline
