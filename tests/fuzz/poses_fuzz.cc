#include "server/formats/sessions/poses.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

void Check(const PoseTable& table, SensorKind kind) {
  fuzz::Require(!table.empty(), "a table has rows");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const TimedPose& pose = table[i];
    fuzz::RequireFinite(pose.T_world_body.p_m, "position");
    fuzz::Require(std::abs(pose.T_world_body.q.norm() - 1) < 1e-9, "a quaternion is of unit length");
    fuzz::Require(pose.stamp.ns >= 0, "a stamp is not negative");
    const bool tracker = kind == SensorKind::kTracker;
    fuzz::Require(pose.capture.empty() != tracker, "a tracker's row has a capture, a stream's has none");
    if (i == 0) continue;
    fuzz::Require(tracker ? table[i - 1].capture < pose.capture : table[i - 1].stamp < pose.stamp, "rows are sorted");
  }
}

}  // namespace

// Each input is read as both kinds.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::TextOf(data, size);
  for (const SensorKind kind : {SensorKind::kTracker, SensorKind::kPoseStream}) {
    const auto table = formats::ReadPoses(text, kind, "tracker/poses.csv");
    if (fuzz::RequireGoodError(table)) Check(*table, kind);
  }
  if (const auto path = formats::ReadTrackerPath(text, "tracker/poses.csv"); fuzz::RequireGoodError(path))
    for (std::size_t i = 0; i < path->size(); ++i) {
      fuzz::Require((*path)[i].capture.empty(), "a row of a path has no capture");
      if (i > 0) fuzz::Require((*path)[i - 1].stamp < (*path)[i].stamp, "a path is sorted");
    }
  const auto known = formats::ReadPosesOf({CaptureId("000"), CaptureId("001")}, text, "tracker/poses.csv");
  if (fuzz::RequireGoodError(known)) fuzz::Require(known->size() <= 2, "only known captures have rows");
  return 0;
}
