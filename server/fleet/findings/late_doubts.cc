// Sensors whose last captures took no part, as they contradict all others or as no board was where it should have been.
#include <set>

#include "server/fleet/findings/findings.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

std::string IfItWasMoved(const std::string& sensors, const std::string& flags) {
  return ", capture again, then `rigcal push FOLDER`; if " + sensors + " was moved, `rigcal push FOLDER --remounted " +
         flags + "`";
}

Finding FindingOf(const LostSight& loss, const SessionId& session, const SessionTimes& captured_at) {
  const std::string name = loss.sensor.str();
  return {name + " saw no board where the others saw one in " + std::to_string(loss.lost) +
              " captures of the session of " + NameOfSession(session, captured_at) + ", all from " +
              loss.first_lost.str() + " on: it was moved by more than 300 mm or 11 deg, or something hid the boards",
          "Check the mount of " + name + " and what stands before it" + IfItWasMoved("it", name),
          {loss.sensor},
          {"Captures without a board for " + name, std::to_string(loss.lost), ""}};
}

std::vector<SensorId> EitherOf(const LateContradiction& late) {
  return late.or_sensor.empty() ? std::vector{late.sensor} : std::vector{late.sensor, late.or_sensor};
}

Finding FindingOf(const LateContradiction& late, const SessionId& session, const SessionTimes& captured_at) {
  const std::vector<SensorId> either = EitherOf(late);
  const bool is_one = either.size() == 1;
  const std::string who = late.sensor.str() + (is_one ? "" : " or " + late.or_sensor.str());
  return {
      "what " + late.sensor.str() + " saw " + (late.captures == 1 ? "in its last capture, " : "from capture ") +
          late.first.str() + (late.captures == 1 ? "," : " on, its last,") + " of the session of " +
          NameOfSession(session, captured_at) + " contradicts the rest: " + who + " was moved before it, " +
          (late.or_board.empty() ? "" : "or board " + late.or_board.str() + " was, ") +
          (late.or_world ? "or it told its poses from another origin, " : "") +
          "or what was captured is of another instant",
      "Check the mount of " + List(either) +
          (late.or_board.empty() ? "" : " and that board " + late.or_board.str() + " is fastened") +
          (late.or_world ? " and that " + late.sensor.str() + " was not started anew" : "") +
          IfItWasMoved(is_one ? "it" : "one of them", late.sensor.str() + (is_one ? "" : "," + late.or_sensor.str())),
      either,
      {"Last captures of " + late.sensor.str() + " that contradict the rest", std::to_string(late.captures), ""}};
}

// Against a reference that may have been moved no pose is sure.
void AddDoubted(const SensorId& sensor, const SessionEstimate& estimate, std::vector<SensorId>& doubted) {
  if (sensor != estimate.reference) return doubted.push_back(sensor);
  for (const RefinedPose& pose : estimate.poses)
    if (pose.sensor != estimate.reference) doubted.push_back(pose.sensor);
}

}  // namespace

LateDoubts FindLateDoubts(const std::vector<SessionEstimate>& estimates, const SessionTimes& captured_at) {
  LateDoubts found;
  std::set<SensorId> asked;
  for (const SessionEstimate& estimate : estimates) {
    for (const LostSight& loss : estimate.lost_sights) {
      if (asked.contains(loss.sensor)) continue;  // it saw all that it should in a newer one
      found.findings.push_back(FindingOf(loss, estimate.session, captured_at));
      AddDoubted(loss.sensor, estimate, found.sensors);
    }
    for (const LateContradiction& late : estimate.late) {
      if (asked.contains(late.sensor)) continue;
      found.findings.push_back(FindingOf(late, estimate.session, captured_at));
      for (const SensorId& sensor : EitherOf(late)) AddDoubted(sensor, estimate, found.sensors);
    }
    for (const RefinedPose& pose : estimate.poses) asked.insert(pose.sensor);
  }
  return found;
}

}  // namespace rigcal::fleet
