#include "client/companion/standing.h"

#include <algorithm>

#include "client/check/capture_names.h"
#include "client/check/words.h"
#include "client/companion/placement_words.h"

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

std::string EnoughText(const RigSoFar& so_far, const calib::placement::PlacementAdvice& advice) {
  if (advice.out_of_reach.empty()) return "Enough, close the session.";
  return "Enough of what a carried board can tell, close the session: " +
         check::NamesText(NamesOf(so_far, advice.out_of_reach)) + " cannot be reached by it.";
}

// Of a rig whose cameras all have a place.
std::string HeadlineOf(const Standing& standing) {
  const RigSoFar& so_far = standing.so_far;
  if (!so_far.unplaced.empty())
    return "Hold the board where " + UnplacedText(so_far.unplaced) +
           (so_far.unplaced.size() == 1 ? " and a camera beside it see" : " and cameras beside them see") +
           " it whole: nothing is known of where " + (so_far.unplaced.size() == 1 ? "it sits." : "they sit.");
  if (so_far.rig.cameras.empty()) return "The session has no camera that may see a board: there is nothing to advise.";
  if (standing.is_enough) return EnoughText(so_far, standing.advice);
  if (standing.advice.next) return PlacementText(so_far.rig, *standing.advice.next);
  return "No further place of the board helps: compare with `rigcal check`.";
}

void AddMissing(const Standing& standing, std::vector<std::string>& remarks) {
  for (const auto& [sensor, captures] : standing.captured.files) {
    const std::vector<CaptureId> present(captures.begin(), captures.end());
    const std::string text = check::MissingText(sensor, "files", present, standing.captures);
    if (!text.empty()) remarks.push_back(text + ".");
  }
}

std::vector<std::string> RemarksOf(const Standing& standing) {
  std::vector<std::string> remarks = standing.captured.refusals;
  AddMissing(standing, remarks);
  const auto& out_of_reach = standing.advice.out_of_reach;
  if (!out_of_reach.empty())
    remarks.push_back("No place of a carried board is seen by " +
                      check::NamesText(NamesOf(standing.so_far, out_of_reach)) +
                      " and by a camera that leads to the reference: nothing is expected of them here.");
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
  standing.is_enough =
      standing.so_far.unplaced.empty() && !standing.so_far.rig.cameras.empty() && standing.advice.is_enough;
  standing.headline = HeadlineOf(standing);
  standing.remarks = RemarksOf(standing);
  return standing;
}

}  // namespace rigcal::companion
