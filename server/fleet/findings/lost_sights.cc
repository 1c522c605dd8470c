// Lidars whose later captures took no part, as no board was where it should have been.
#include <set>

#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

Finding FindingOf(const LostSight& loss, const SessionId& session, const SessionTimes& captured_at) {
  const std::string name = loss.sensor.str();
  return {name + " saw no board where the others saw one in " + std::to_string(loss.lost) +
              " captures of the session of " + NameOfSession(session, captured_at) + ", all from " +
              loss.first_lost.str() + " on: it was moved by more than 300 mm or 11 deg, or something hid the boards",
          "Check the mount of " + name +
              " and what stands before it, capture again, then `rigcal push FOLDER`; if it " +
              "was moved, `rigcal push FOLDER --remounted " + name + "`",
          {loss.sensor},
          {"Captures without a board for " + name, std::to_string(loss.lost), ""}};
}

}  // namespace

LostSights FindLostSights(const std::vector<SessionEstimate>& estimates, const SessionTimes& captured_at) {
  LostSights found;
  std::set<SensorId> asked;
  for (const SessionEstimate& estimate : estimates) {
    for (const LostSight& loss : estimate.lost_sights) {
      if (asked.contains(loss.sensor)) continue;  // it saw all that it should in a newer one
      found.findings.push_back(FindingOf(loss, estimate.session, captured_at));
      found.sensors.push_back(loss.sensor);
    }
    for (const RefinedPose& pose : estimate.poses) asked.insert(pose.sensor);
  }
  return found;
}

}  // namespace rigcal::fleet
