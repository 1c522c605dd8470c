#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "server/report/drawings/drawing.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr double kWidth_px = 700, kMargin_px = 16, kHeightMin_px = 160, kHeightMax_px = 700;

// Which axes of the reference frame lie in the drawing, and how metres become pixels.
struct View {
  int right = 0, up = 1, along = 2;
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  double px_per_m = 1.0, width_px = kWidth_px, height_px = kWidth_px;
};

View ViewOf(const std::vector<SensorPose>& poses) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(HUGE_VAL), high = -low;
  for (const SensorPose& pose : poses) {
    if (!pose.known) continue;
    low = low.cwiseMin(pose.T_ref_sensor.p_m);
    high = high.cwiseMax(pose.T_ref_sensor.p_m);
  }
  View view;
  const Eigen::Vector3d extent = (high - low).allFinite() ? Eigen::Vector3d(high - low) : Eigen::Vector3d::Ones();
  extent.minCoeff(&view.along);
  view.right = view.along == 0 ? 1 : 0;
  view.up = view.along == 2 ? 1 : 2;
  view.low = low.allFinite() ? low : Eigen::Vector3d::Zero();
  const double wide = std::max(extent(view.right), 1e-9), tall = std::max(extent(view.up), 1e-9);
  view.px_per_m = std::min((kWidth_px - 2 * kMargin_px) / wide, (kHeightMax_px - 2 * kMargin_px) / tall);
  view.height_px = std::max(kHeightMin_px, tall * view.px_per_m + 2 * kMargin_px);
  return view;
}

std::string PointIn(const View& view, const Eigen::Vector3d& p_ref) {
  const Eigen::Vector3d offset = (p_ref - view.low) * view.px_per_m;
  return Fixed(kMargin_px + offset(view.right), 1) + " " + Fixed(view.height_px - kMargin_px - offset(view.up), 1);
}

void Draw(Dictionary& svg, const char* state, const char* stroke, const char* thick, const std::string& path) {
  if (path.empty()) return;
  Dictionary* trace = svg.AddSectionDictionary("TRACE");
  trace->SetValue("STATE", state);
  trace->SetValue("STROKE", stroke);
  trace->SetValue("THICK", thick);
  trace->SetValue("D", path);
}

std::string LinesOf(const std::vector<ShownEdge>& edges, EdgeState state, const View& view,
                    const std::unordered_map<SensorId, const SensorPose*>& known) {
  std::string path;
  std::size_t drawn = 0;
  for (const ShownEdge& shown : edges) {
    const auto a = known.find(shown.edge->frame_a), b = known.find(shown.edge->frame_b);
    if (shown.edge->state != state || a == known.end() || b == known.end() || ++drawn > kTracesMax) continue;
    path.append("M").append(PointIn(view, a->second->T_ref_sensor.p_m));
    path.append("L").append(PointIn(view, b->second->T_ref_sensor.p_m));
  }
  return path;
}

}  // namespace

std::string FillMap(Dictionary& svg, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges) {
  constexpr std::array<const char*, 3> kAxis = {"x", "y", "z"};
  const auto& poses = revision.solution.poses;
  const View view = ViewOf(poses);
  std::unordered_map<SensorId, const SensorPose*> known;
  const std::size_t stride = 1 + poses.size() / kTracesMax;
  std::string dots, origin;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i].known) continue;
    known.emplace(poses[i].sensor, &poses[i]);
    const std::string dot = std::string("M").append(PointIn(view, poses[i].T_ref_sensor.p_m)).append("h0");
    if (i % stride == 0) dots += dot;
    if (poses[i].sensor == revision.reference) origin = dot;
  }
  svg.SetValue("WIDTH", Fixed(view.width_px, 0));
  svg.SetValue("HEIGHT", Fixed(view.height_px, 0));
  Draw(svg, "good", kGoodStroke, "0.6", LinesOf(edges, EdgeState::kGood, view, known));
  Draw(svg, "known", kKnownFill, "2.6", dots);
  Draw(svg, "failed", kFailedStroke, "1.6", LinesOf(edges, EdgeState::kFailed, view, known));
  Draw(svg, "known", kKnownFill, "11", origin);
  return "A map of the " + std::to_string(known.size()) +
         " known sensors at their solved positions: " + kAxis[static_cast<std::size_t>(view.right)] +
         " to the right, " + kAxis[static_cast<std::size_t>(view.up)] + " upwards, seen along " +
         kAxis[static_cast<std::size_t>(view.along)] +
         " of the reference frame; the large dot is the reference. Unknown sensors have no place on it.";
}

}  // namespace rigcal::report
