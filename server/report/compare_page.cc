#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "server/report/assets.h"
#include "server/report/change_section.h"
#include "server/report/robot_pages.h"
#include "server/report/text.h"

namespace rigcal::report {
namespace {

constexpr double kFar_m = 10.0;
constexpr std::size_t kRowsMax = 3000;

// The focal length that the newer revision's edges estimated for a camera.
std::map<SensorId, double> FocalLengths(const formats::RevisionInput& revision) {
  std::map<SensorId, double> focal_px;
  for (const Edge& edge : revision.edges) {
    const auto take = [&](const char* figure, const SensorId& sensor) {
      if (const auto found = edge.figures.find(figure); found != edge.figures.end())
        focal_px.emplace(sensor, found->second);
    };
    take("fx_a_px", edge.frame_a);
    take("fx_b_px", edge.frame_b);
  }
  return focal_px;
}

// How far the image of a point 10 m ahead moves: by the turn across the axis, and by the shift over the distance.
double Pixels(const SensorMove& move, double focal_px) {
  const double across_x = std::abs(move.d(tangent::kRy)) + std::abs(move.d(tangent::kX)) / kFar_m;
  const double across_y = std::abs(move.d(tangent::kRx)) + std::abs(move.d(tangent::kY)) / kFar_m;
  return focal_px * std::hypot(across_x, across_y);
}

void FillNumbers(Dictionary& page, const char* section, const std::vector<int>& numbers, int chosen) {
  for (const int number : numbers) {
    Dictionary* option = page.AddSectionDictionary(section);
    option->SetValue("NUMBER", std::to_string(number));
    if (number == chosen) option->ShowSection("CHOSEN");
  }
}

void FillSensors(Dictionary& page, const CompareInput& input, const Changes& changes) {
  const auto focal_px = FocalLengths(*input.now.revision);
  for (std::size_t i = 0; i < std::min(changes.moves.size(), kRowsMax); ++i) {
    const SensorMove& move = changes.moves[i];
    Dictionary* row = page.AddSectionDictionary("MOVE");
    FillMove(*row, move);
    row->SetValue("MRAD", Significant(move.angle_rad * 1e3, 3));
    const auto focal = focal_px.find(move.sensor);
    row->SetValue("PIXELS", focal == focal_px.end() ? "" : Significant(Pixels(move, focal->second), 2));
  }
}

using EdgeKey = std::tuple<SensorId, SensorId, std::string>;

std::map<EdgeKey, const Edge*> GoodEdges(const formats::RevisionInput& revision) {
  std::map<EdgeKey, const Edge*> edges;
  for (const Edge& edge : revision.edges)
    if (edge.state == EdgeState::kGood) edges[{edge.frame_a, edge.frame_b, edge.method}] = &edge;
  return edges;
}

double LargestSigma_m(const Edge& edge) {
  double largest_m = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    if (const AxisSigma sigma = SigmaOf(edge.uncertainty, axis); sigma.known)
      largest_m = std::max(largest_m, sigma.value);
  return largest_m;
}

void FillEdge(Dictionary& row, const Edge& edge, const Edge* before) {
  row.SetValue("FROM", edge.frame_a.str());
  row.SetValue("TO", edge.frame_b.str());
  row.SetValue("METHOD", edge.method);
  row.SetValue("SIGMA_NOW", SigmaMm(LargestSigma_m(edge)));
  if (!before) return row.ShowSection("NEW");
  Dictionary* both = row.AddSectionDictionary("BOTH");
  const Vector6d d = (before->T_a_b.Inverse() * edge.T_a_b).Log();
  both->SetValue("MM", Significant(d.head<3>().norm() * kMmPerMetre, 3));
  both->SetValue("MRAD", Significant(d.tail<3>().norm() * 1e3, 3));
  both->SetValue("SIGMA_BEFORE", SigmaMm(LargestSigma_m(*before)));
}

void FillEdges(Dictionary& page, const CompareInput& input) {
  const auto before = GoodEdges(*input.before.revision);
  std::size_t shown = 0;
  for (const auto& [key, edge] : GoodEdges(*input.now.revision)) {
    if (shown++ == kRowsMax) break;
    const auto found = before.find(key);
    FillEdge(*page.AddSectionDictionary("EDGE"), *edge, found == before.end() ? nullptr : found->second);
  }
}

}  // namespace

Result<std::string> RenderCompare(const CompareInput& input) {
  Dictionary page("compare");
  FillHead(page,
           input.robot.str() + ": revision " + std::to_string(input.before.number) + " and " +
               std::to_string(input.now.number),
           "../../");
  page.SetValue("ROBOT", input.robot.str());
  page.SetValue("BEFORE", std::to_string(input.before.number));
  page.SetValue("NOW", std::to_string(input.now.number));
  page.SetValue("VERDICT_BEFORE", VerdictWord(input.before.revision->verdict.level));
  page.SetValue("VERDICT_NOW", VerdictWord(input.now.revision->verdict.level));
  FillNumbers(page, "CHOICE_A", input.numbers, input.before.number);
  FillNumbers(page, "CHOICE_B", input.numbers, input.now.number);
  const Changes changes = Compare(*input.before.revision, *input.now.revision);
  if (!changes.same_reference) page.ShowSection("OTHER_REFERENCE");
  FillSensors(page, input, changes);
  FillEdges(page, input);
  AddScript(page, "../../" + AssetPath("tables.js"));
  return Expand("compare.tpl", page);
}

}  // namespace rigcal::report
