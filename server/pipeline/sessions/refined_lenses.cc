#include "server/pipeline/sessions/refined_lenses.h"

#include <algorithm>

#include "server/pipeline/sessions/session_refinement.h"
#include "storage/sessions/session_estimates.h"

namespace rigcal::pipeline {
namespace {

void Take(const RefinedLens& lens, const SessionId& session, report::CameraReport& camera) {
  camera.fit.intrinsics = lens.intrinsics;
  // Where pictures tell how boards seem to move with the lens: what a report draws needs both.
  if (camera.fit.implied_motion.cols() == lens.covariance.cols()) camera.fit.covariance = lens.covariance;
  const Eigen::VectorXd sigma = lens.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  camera.fit.sigma.assign(sigma.begin(), sigma.end());
  camera.fit.sigma_by_jackknife = false;
  camera.refined_in = session;
}

}  // namespace

Status TakeRefinedLenses(storage::Store& store, const RobotId& robot, const FusedSessions& fused,
                         std::vector<report::CameraReport>& cameras) {
  if (fused.sessions.empty() || cameras.empty()) return {};
  RIGCAL_ASSIGN(const auto rows, storage::LoadSessionEstimates(store, robot, kSessionEstimator, kSessionsRefined));
  for (const storage::SessionEstimateRow& row : rows) {  // the newest first
    const bool counts = std::find(fused.sessions.begin(), fused.sessions.end(), row.session) != fused.sessions.end();
    if (!counts || !row.estimate) continue;
    for (const RefinedLens& lens : row.estimate->lenses)
      for (report::CameraReport& camera : cameras)
        if (camera.fit.camera == lens.camera && camera.refined_in.empty() &&
            camera.fit.intrinsics.model == lens.intrinsics.model)
          Take(lens, row.session, camera);
  }
  return {};
}

}  // namespace rigcal::pipeline
