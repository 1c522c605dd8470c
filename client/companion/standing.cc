#include "client/companion/standing.h"

#include <algorithm>

#include "client/check/capture_names.h"
#include "client/check/words.h"
#include "client/companion/placement_words.h"
#include "server/calib/core/diagnoses.h"

namespace rigcal::companion {
namespace {

std::vector<std::string> NamesOf(const RigSoFar& so_far, const std::vector<std::size_t>& cameras) {
  std::vector<std::string> names;
  for (const std::size_t camera : cameras) names.push_back(so_far.rig.cameras[camera].id.str());
  return names;
}

std::vector<std::string> NamesOfKind(const SessionHeader& header, bool lidars) {
  std::vector<std::string> names;
  for (const Sensor& sensor : header.sensors)
    if (sensor.kind != SensorKind::kCamera && (sensor.kind == SensorKind::kLidar) == lidars)
      names.push_back(sensor.id.str());
  return names;
}

std::string UnplacedText(const std::vector<SensorId>& unplaced) {
  std::vector<std::string> names;
  for (const SensorId& sensor : unplaced) names.push_back(sensor.str());
  return check::NamesText(names);
}

// What else may tie cameras that a carried board cannot: this page looks at none of it.
std::string OtherWay(const SessionHeader& header) {
  const std::vector<std::string> lidars = NamesOfKind(header, true), streams = NamesOfKind(header, false);
  std::string way = "Move the robot before a board that stands still, with " +
                    (streams.empty() ? std::string("a tracker or odometry") : check::NamesText(streams)) +
                    " in the session";
  if (!lidars.empty()) way += ", or hold the board where " + check::NamesText(lidars) + " and the camera see it";
  return way;
}

std::string OutOfReachText(const Standing& standing) {
  const RigSoFar& so_far = standing.so_far;
  return "Not done: a carried board cannot tie " + check::NamesText(NamesOf(so_far, standing.advice.out_of_reach)) +
         " to " + so_far.rig.cameras[so_far.rig.reference].id.str() + ". " + OtherWay(standing.captured.header) +
         ": `rigcal check` judges that, not this page.";
}

bool HasOnlyCameras(const SessionHeader& header) {
  return std::all_of(header.sensors.begin(), header.sensors.end(),
                     [](const Sensor& sensor) { return sensor.kind == SensorKind::kCamera; });
}

// Of cameras that a carried board has told all of that it can.
std::string DoneText(const Standing& standing) {
  const SessionHeader& header = standing.captured.header;
  if (!standing.advice.out_of_reach.empty()) return OutOfReachText(standing);
  if (standing.is_enough) return "Enough, close the session.";
  const std::string start = standing.so_far.captures.empty()
                                ? "The one camera's lens is given: a carried board tells nothing more of it here"
                                : "The cameras have enough";
  if (HasOnlyCameras(header)) return start + ".";
  std::vector<std::string> others = NamesOfKind(header, true);
  for (const std::string& name : NamesOfKind(header, false)) others.push_back(name);
  return start + ". Not done: " + check::NamesText(others) + (others.size() == 1 ? " is" : " are") +
         " not judged here: see by `rigcal check` before you close the session.";
}

// Of a rig whose cameras all have a place.
std::string HeadlineOf(const Standing& standing) {
  const RigSoFar& so_far = standing.so_far;
  if (!so_far.unplaced.empty())
    return "Hold the board where " + UnplacedText(so_far.unplaced) +
           (so_far.unplaced.size() == 1 ? " and a camera beside it see" : " and cameras beside them see") +
           " it whole: nothing is known of where " + (so_far.unplaced.size() == 1 ? "it sits." : "they sit.");
  if (so_far.rig.cameras.empty()) return "The session has no camera that may see a board: there is nothing to advise.";
  if (standing.advice.is_enough) return DoneText(standing);
  if (standing.advice.next) return PlacementText(so_far.rig, *standing.advice.next);
  return "No further place of the board helps: compare with `rigcal check`.";
}

// Why more is wanted of a pose that is within its tolerance.
void AddFewTogether(const Standing& standing, std::vector<std::string>& remarks) {
  const auto& cameras = standing.so_far.rig.cameras;
  for (std::size_t c = 0; c < standing.advice.poses.size(); ++c) {
    const calib::placement::PoseSoFar& pose = standing.advice.poses[c];
    if (pose.tied_by == 0 || pose.tied_by >= static_cast<int>(calib::kCapturesEnough) || pose.pose_of_tolerance > 1)
      continue;
    remarks.push_back("The sigma of " + cameras[c].id.str() + " is small enough, but " + std::to_string(pose.tied_by) +
                      " of the " + std::to_string(calib::kCapturesEnough) +
                      " captures in which it and a camera beside it see the board are there: " +
                      "from fewer the server does not believe it.");
  }
}

// Why more is wanted of a pair though every pose is known well enough.
void AddUntested(const Standing& standing, std::vector<std::string>& remarks) {
  constexpr std::size_t kNamedMax = 3;
  const auto& untested = standing.advice.untested;
  const calib::placement::PlannedRig& rig = standing.so_far.rig;
  std::vector<std::string> pairs;
  for (std::size_t i = 0; i < std::min(untested.size(), kNamedMax); ++i)
    pairs.push_back(rig.cameras[untested[i].a].id.str() + " - " + rig.cameras[untested[i].b].id.str() + " (" +
                    std::to_string(rig.captures_to_test - untested[i].lacking) + ")");
  if (untested.size() > kNamedMax) pairs.push_back(std::to_string(untested.size() - kNamedMax) + " more pairs");
  if (!pairs.empty())
    remarks.push_back("Too few captures together to test whether pairs agree, of " + check::NamesText(pairs) + ": " +
                      std::to_string(rig.captures_to_test) + " of each are wanted.");
}

void AddMissing(const Standing& standing, std::vector<std::string>& remarks) {
  for (const auto& [sensor, captures] : standing.captured.files) {
    const std::vector<CaptureId> present(captures.begin(), captures.end());
    const std::string text = check::MissingText("files", present, standing.captures);
    if (!text.empty()) remarks.push_back(sensor.str() + " has " + text + ".");
  }
}

std::vector<std::string> RemarksOf(const Standing& standing) {
  std::vector<std::string> remarks;
  if (standing.is_enough)
    remarks.push_back(
        "This is what is expected. What the server tells of the session decides: keep the board at hand until "
        "it was pushed.");
  remarks.insert(remarks.end(), standing.captured.refusals.begin(), standing.captured.refusals.end());
  AddFewTogether(standing, remarks);
  AddUntested(standing, remarks);
  AddMissing(standing, remarks);
  const auto& out_of_reach = standing.advice.out_of_reach;
  if (!out_of_reach.empty())
    remarks.push_back("No place of a carried board is seen by " +
                      check::NamesText(NamesOf(standing.so_far, out_of_reach)) +
                      " and by a camera that leads to the reference: their poses stay unknown here.");
  const std::vector<std::string> lidars = NamesOfKind(standing.captured.header, true),
                                 streams = NamesOfKind(standing.captured.header, false);
  if (!lidars.empty())
    remarks.push_back("Clouds of " + check::NamesText(lidars) +
                      " are counted only: boards are not looked for in them.");
  if (!streams.empty()) remarks.push_back("Poses of " + check::NamesText(streams) + " are not looked at.");
  return remarks;
}

}  // namespace

std::optional<std::size_t> PlannedIndexOf(const RigSoFar& so_far, const SensorId& sensor) {
  for (std::size_t c = 0; c < so_far.rig.cameras.size(); ++c)
    if (so_far.rig.cameras[c].id == sensor) return c;
  return std::nullopt;
}

std::vector<CaptureId> MissingOf(const Standing& standing, const SensorId& sensor) {
  std::vector<CaptureId> missing;
  const auto present = standing.captured.files.find(sensor);
  if (present == standing.captured.files.end()) return missing;
  for (const CaptureId& capture : standing.captures)
    if (!present->second.contains(capture)) missing.push_back(capture);
  return missing;
}

Standing StandingOf(Captured captured) {
  Standing standing;
  standing.captured = std::move(captured);
  standing.captures = CapturesOf(standing.captured);
  standing.so_far = RigOf(standing.captured);
  if (!standing.so_far.rig.cameras.empty())
    standing.advice = calib::placement::AdviseOn(standing.so_far.rig, standing.so_far.captures);
  standing.is_enough = standing.so_far.unplaced.empty() && standing.advice.is_enough &&
                       standing.advice.out_of_reach.empty() && !standing.so_far.captures.empty() &&
                       HasOnlyCameras(standing.captured.header);
  standing.headline = HeadlineOf(standing);
  standing.remarks = RemarksOf(standing);
  return standing;
}

}  // namespace rigcal::companion
