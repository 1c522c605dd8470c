#include <algorithm>
#include <cmath>
#include <map>

#include "server/formats/edges/camera_fit.h"
#include "server/report/cameras/lens_section.h"
#include "server/report/frame/assets.h"
#include "server/report/frame/banner.h"
#include "server/report/frame/choices.h"
#include "server/report/robot_pages.h"
#include "server/report/sections/change_section.h"
#include "server/report/text/edge_moves.h"
#include "server/report/text/figure_words.h"
#include "server/report/text/moved_text.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr double kFar_m = 10.0, kMradPerRad = 1000.0;
constexpr std::size_t kRowsMax = 3000;
constexpr const char* kAveraged =
    "The poses below are a mean of old and new measurements: of these alone no sensor seems to have moved.";
constexpr const char* kStillWhereMeasured = "Nothing moved of what was measured anew.";

// The focal length on the axis that the newer revision's edges estimated for a camera.
std::map<SensorId, double> FocalLengths(const formats::RevisionInput& revision) {
  std::map<SensorId, double> focal_px;
  for (const Edge& edge : revision.edges) {
    const auto take = [&](const std::string& side, const SensorId& sensor) {
      const auto focal = edge.figures.find("fx" + side + "_px"), xi = edge.figures.find("xi" + side + "_ratio");
      if (focal == edge.figures.end()) return;
      focal_px.emplace(sensor, focal->second / (1 + (xi == edge.figures.end() ? 0.0 : xi->second)));
    };
    take("_a", edge.frame_a);
    take("_b", edge.frame_b);
    for (const Evidence& evidence : edge.evidence)  // of the only camera of the edge
      if (evidence.suffix == formats::kCameraFitSuffix) take("", evidence.sensor);
  }
  return focal_px;
}

// How far the image of a point 10 m ahead moves: by the turn across the axis, and by the shift over the distance.
double Pixels(const SensorMove& move, double focal_px) {
  const double across_x = std::abs(move.d(tangent::kRy)) + std::abs(move.d(tangent::kX)) / kFar_m;
  const double across_y = std::abs(move.d(tangent::kRx)) + std::abs(move.d(tangent::kY)) / kFar_m;
  return focal_px * std::hypot(across_x, across_y);
}

void FillMore(Dictionary& page, const char* section, std::size_t count) {
  if (count > kRowsMax) ShowValue(page, section, "COUNT", std::to_string(count - kRowsMax));
}

void FillSensors(Dictionary& page, const CompareInput& input, const Changes& changes) {
  if (changes.moves.empty()) return;
  const auto focal_px = FocalLengths(*input.now.revision);
  Dictionary* sensors = page.AddSectionDictionary("SENSORS");
  for (std::size_t i = 0; i < std::min(changes.moves.size(), kRowsMax); ++i) {
    const SensorMove& move = changes.moves[i];
    Dictionary* row = sensors->AddSectionDictionary("MOVE");
    FillMove(*row, move);
    row->SetValue("MRAD", Significant(move.angle_rad * kMradPerRad, 3));
    const auto focal = focal_px.find(move.sensor);
    row->SetValue("PIXELS", focal == focal_px.end() ? "" : Significant(Pixels(move, focal->second), 2));
  }
  FillMore(*sensors, "MORE", changes.moves.size());
}

// Of three axes. What one of the measurements leaves free is no movement: it is named beside the sigma.
void FillAxes(Dictionary& row, const EdgeMove& move, int first_axis, double scale) {
  std::vector<std::string> free;
  for (int axis = first_axis; axis < first_axis + 3; ++axis)
    if (!move.known[static_cast<std::size_t>(axis)]) free.emplace_back(tangent::kNames[static_cast<std::size_t>(axis)]);
  Dictionary* axes = row.AddSectionDictionary(first_axis == tangent::kTranslation ? "TRANSLATION" : "ROTATION");
  if (free.size() == 3) return axes->ShowSection("FREE");
  Dictionary* known = axes->AddSectionDictionary("KNOWN");
  known->SetValue("MOVED", Significant(move.d.segment<3>(first_axis).norm() * scale, 3));
  known->SetValue("SIGMA", Significant(move.sigma.segment<3>(first_axis).maxCoeff() * scale, 2));
  if (!free.empty()) ShowValue(*known, "PARTLY", "NAMES", free.size() == 1 ? free[0] : free[0] + " " + free[1]);
}

// Both, where they differ: then not all that changed is movement.
std::string MethodsText(const EdgeMove& move) {
  const std::string now = MethodText(move.now ? *move.now : *move.before);
  const std::string before = MethodText(move.before ? *move.before : *move.now);
  return before == now ? now : before + " \xE2\x86\x92 " + now;
}

void FillEdgeMove(Dictionary& row, const EdgeMove& move) {
  const Edge& edge = move.now ? *move.now : *move.before;
  row.SetValue("FROM", edge.frame_a.str());
  row.SetValue("TO", edge.frame_b.str());
  row.SetValue("METHOD", MethodsText(move));
  if (!move.measured_again) {
    const char* why = !move.before ? "new" : !move.now ? "gone" : "not measured again";
    return ShowValue(row, "ALONE", "WHY", why);
  }
  Dictionary* both = row.AddSectionDictionary("BOTH");
  FillAxes(*both, move, tangent::kTranslation, kMmPerMetre);
  FillAxes(*both, move, tangent::kRotation, kMradPerRad);
  both->SetValue("IN_SIGMAS", SigmasText(move.in_sigmas));
  both->SetValue("LEVEL", SigmasClass(move.in_sigmas));
}

void FillEdges(Dictionary& page, const std::vector<EdgeMove>& moves) {
  for (std::size_t i = 0; i < std::min(moves.size(), kRowsMax); ++i)
    FillEdgeMove(*page.AddSectionDictionary("EDGE"), moves[i]);
  FillMore(page, "MORE_EDGES", moves.size());
}

bool IsAnyMeasuredAgain(const std::vector<EdgeMove>& edges) {
  return std::any_of(edges.begin(), edges.end(), [](const EdgeMove& edge) { return edge.measured_again; });
}

void FillWhatMoved(Dictionary& page, const CompareInput& input, const Changes& changes,
                   const std::vector<EdgeMove>& edges) {
  const MovedText text = WhatMoved(changes, input.now.revision->reference);
  const std::string measured = WhatMeasured(edges);
  const bool averaged = !text.moved && !measured.empty();
  const std::string unseen = changes.moves.empty() ? "" : WhatWasNotMeasured(changes, edges);
  const bool still = !text.moved && !averaged;
  page.SetValue("MOVED", averaged ? measured : still && !unseen.empty() ? unseen : text.sentence);
  page.SetValue("MOVED_LEVEL", !still ? "off" : unseen.empty() ? "still" : "");
  if (!measured.empty()) ShowValue(page, "MEASURED", "TEXT", averaged ? kAveraged : measured);
  if (!unseen.empty() && (!still || IsAnyMeasuredAgain(edges)))
    ShowValue(page, "MEASURED", "TEXT", still ? kStillWhereMeasured : unseen);
  if (text.moved || !measured.empty()) page.ShowSection("LOOK");
}

void FillVerdict(Dictionary& page, const char* section, const SolvedRevision& solved) {
  Dictionary* one = page.AddSectionDictionary(section);
  one->SetValue("NUMBER", std::to_string(solved.number));
  FillBadge(*one, solved.revision->verdict.level);
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
  FillVerdict(page, "VERDICT_BEFORE", input.before);
  FillVerdict(page, "VERDICT_NOW", input.now);
  FillChoices(page, "CHOICE_A", input.newest, input.before.number);
  FillChoices(page, "CHOICE_B", input.newest, input.now.number);
  const Changes changes = Compare(*input.before.revision, *input.now.revision);
  const std::vector<EdgeMove> edges = EdgeMoves(*input.before.revision, *input.now.revision, input.captured_at);
  FillWhatMoved(page, input, changes, edges);
  FillSensors(page, input, changes);
  FillLenses(page, input.lenses);
  FillEdges(page, edges);
  AddScript(page, "../../" + AssetPath("tables.js"));
  return Expand("compare.tpl", page);
}

}  // namespace rigcal::report
