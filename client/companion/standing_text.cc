#include <ostream>

#include "client/check/words.h"
#include "client/companion/placement_words.h"
#include "client/companion/standing.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/calib/core/wording.h"

namespace rigcal::companion {
namespace {

using client::Align;
using client::Fixed;
using client::Scaled;

// "9.1 mm, 0.12 deg" of the worst axes; "-" where nothing ties it.
std::string SigmaText(const RigSoFar& so_far, const calib::placement::PlacementAdvice& advice, std::size_t camera) {
  const calib::placement::PoseSoFar& pose = advice.poses[camera];
  if (camera == so_far.rig.reference) return "reference";
  if (pose.tied_by == 0) return "not known";
  return Scaled(pose.sigma.head<3>().maxCoeff(), client::kMmPerM, 1) + " mm, " +
         Scaled(pose.sigma.tail<3>().maxCoeff(), client::kDegPerRad, 2) + " deg";
}

std::string TiltsText(const check::CameraFound& found) {
  std::string text;
  for (const double tilt_rad : found.ring.largest_rad)
    text += (text.empty() ? "" : " ") + Scaled(tilt_rad, client::kDegPerRad, 0);
  return found.distances ? text : "-";
}

void AddCamera(const Standing& standing, const Sensor& sensor, client::Table& table) {
  const check::CameraFound& found = standing.captured.cameras.at(sensor.id).found;
  const auto planned = PlannedIndexOf(standing.so_far, sensor.id);
  table.Add({sensor.id.str(), std::to_string(found.with_board.size()), std::to_string(found.without_board.size()),
             std::to_string(MissingOf(standing, sensor.id).size()), Fixed(100 * found.coverage.share_ratio, 0),
             TiltsText(found), std::to_string(found.blurred.size()),
             planned ? SigmaText(standing.so_far, standing.advice, *planned) : "not known"});
}

}  // namespace

void PrintStanding(const Standing& standing, std::ostream& out) {
  const Captured& captured = standing.captured;
  out << captured.header.robot.str() << ": " << calib::CountText(standing.captures.size(), "capture") << '\n'
      << "next     " << client::Plain(standing.headline) << '\n';
  for (std::size_t i = 0; i < standing.remarks.size(); ++i)
    out << (i == 0 ? "notes    " : "         ") << client::Plain(standing.remarks[i]) << '\n';
  out << "limits   Judged by the default limits, " << check::DefaultLimitsText()
      << ": the server's policy may want more.\n\n";
  client::Table table({{"CAMERA"},
                       {"board in", Align::kRight},
                       {"not in", Align::kRight},
                       {"missing", Align::kRight},
                       {"covered %", Align::kRight},
                       {"tilts l r u d deg", Align::kRight},
                       {"blurred", Align::kRight},
                       {"sigma so far"}});
  for (const Sensor& sensor : captured.header.sensors)
    if (sensor.kind == SensorKind::kCamera) AddCamera(standing, sensor, table);
  if (!table.empty()) table.Print(out);
}

}  // namespace rigcal::companion
