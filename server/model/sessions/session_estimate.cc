#include "server/model/sessions/session_estimate.h"

#include <set>

namespace rigcal {

std::vector<LensMisfit> NewestMisfits(const std::vector<SessionEstimate>& estimates) {
  std::vector<LensMisfit> newest;
  std::set<SensorId> judged;
  for (const SessionEstimate& estimate : estimates) {
    if (!estimate.why_not.empty()) continue;
    for (const LensMisfit& misfit : estimate.misfits)
      if (!judged.contains(misfit.camera)) newest.push_back(misfit);
    for (const RefinedPose& pose : estimate.poses) judged.insert(pose.sensor);
  }
  return newest;
}

}  // namespace rigcal
