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

// As the revision names them.
Result<std::vector<SessionEstimate>> LoadNamed(storage::Store& store, const FusedSessions& fused) {
  std::vector<SessionEstimate> estimates;
  for (std::size_t s = 0; s < fused.sessions.size(); ++s) {
    RIGCAL_ASSIGN(auto estimate, storage::LoadSessionEstimate(store, fused.sessions[s], fused.made_by[s]));
    if (estimate) estimates.push_back(std::move(*estimate));
  }
  return IslandsApart(std::move(estimates));
}

// Of the sessions that the revision's poses were fused from, the newest first.
Result<std::vector<SessionEstimate>> LoadFused(storage::Store& store, const formats::RevisionInput& revision) {
  if (!revision.solution.fused.made_by.empty()) return LoadNamed(store, revision.solution.fused);
  const std::vector<SessionId>& fused = revision.solution.fused.sessions;
  std::vector<SessionEstimate> estimates;
  if (fused.empty()) return estimates;
  RIGCAL_ASSIGN(auto rows, storage::LoadSessionEstimates(store, revision.robot, kSessionEstimator, kSessionsFused));
  for (storage::SessionEstimateRow& row : rows)
    if (row.estimate && std::find(fused.begin(), fused.end(), row.session) != fused.end())
      estimates.push_back(std::move(*row.estimate));
  return IslandsApart(std::move(estimates));
}

// Of the newest session that tells this camera's pose; nothing where that held it.
const RefinedLens* LensOf(const std::vector<SessionEstimate>& newest_first, const formats::RevisionInput& revision,
                          const SensorId& camera, SessionId& session) {
  for (const SessionEstimate& estimate : newest_first) {
    const bool tells = std::any_of(estimate.poses.begin(), estimate.poses.end(),
                                   [&](const RefinedPose& pose) { return pose.sensor == camera; });
    if (!tells || !Counts(revision, estimate.session, camera)) continue;
    session = estimate.session;
    const auto lens = std::find_if(estimate.lenses.begin(), estimate.lenses.end(),
                                   [&](const RefinedLens& one) { return one.camera == camera; });
    return lens == estimate.lenses.end() ? nullptr : &*lens;
  }
  return nullptr;
}

}  // namespace

Status TakeRefinedLenses(storage::Store& store, const formats::RevisionInput& revision,
                         std::vector<report::CameraReport>& cameras) {
  RIGCAL_ASSIGN(const auto estimates, LoadFused(store, revision));
  for (report::CameraReport& camera : cameras) {
    SessionId session;
    const RefinedLens* lens = LensOf(estimates, revision, camera.fit.camera, session);
    if (lens == nullptr || camera.fit.source == IntrinsicsSource::kNone ||
        camera.fit.source == IntrinsicsSource::kGiven || camera.fit.intrinsics.model != lens->intrinsics.model)
      continue;
    Take(*lens, session, camera);
  }
  return {};
}

Result<std::map<SessionId, std::vector<RefinedLens>>> LoadRefinedLenses(storage::Store& store,
                                                                        const formats::RevisionInput& revision) {
  RIGCAL_ASSIGN(const auto estimates, LoadFused(store, revision));
  std::map<SessionId, std::vector<RefinedLens>> lenses;
  for (const SessionEstimate& estimate : estimates) {
    std::vector<RefinedLens>& of_session = lenses[estimate.session];
    of_session.insert(of_session.end(), estimate.lenses.begin(), estimate.lenses.end());
  }
  return lenses;
}

}  // namespace rigcal::pipeline
