#include "server/report/sections/change_section.h"

#include <algorithm>

#include "server/report/frame/banner.h"
#include "server/report/text/edge_state.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kMovesMax = 6, kNamesMax = 8;

void AddLine(Dictionary& changes, const std::string& text) { ShowValue(changes, "LINE", "TEXT", text); }

std::string Listed(std::vector<std::string> names) {
  const std::size_t left = names.size() > kNamesMax ? names.size() - kNamesMax : 0;
  std::string text;
  for (std::size_t i = 0; i < names.size() - left; ++i) text += (i == 0 ? "" : ", ") + names[i];
  return left > 0 ? text + " and " + std::to_string(left) + " more" : text;
}

std::vector<std::string> NamesOf(const std::vector<SensorId>& sensors) {
  std::vector<std::string> names;
  for (const SensorId& sensor : sensors) names.push_back(sensor.str());
  return names;
}

std::string PairNameOf(const Edge& edge) { return edge.frame_a.str() + " \xE2\x86\x92 " + edge.frame_b.str(); }

std::vector<std::string> PairsOf(const std::vector<const Edge*>& edges) {
  std::vector<std::string> names;
  for (const Edge* edge : edges) names.push_back(PairNameOf(*edge));
  return names;
}

// With the state of those that are not good.
std::vector<std::string> NamesOf(const std::vector<const Edge*>& edges) {
  std::vector<std::string> names;
  for (const Edge* edge : edges) {
    const bool good = edge->state == EdgeState::kGood;
    names.push_back(PairNameOf(*edge) + (good ? "" : std::string(" (") + StateWord(*edge) + ")"));
  }
  return names;
}

void FillVerdictLine(Dictionary& changes, const Verdict& before, const Verdict& now) {
  AddLine(changes, before.level == now.level
                       ? "The verdict is still " + NameOf(now.level) + "."
                       : "The verdict went from " + NameOf(before.level) + " to " + NameOf(now.level) + ".");
}

void FillEdgeLines(Dictionary& lines, const Changes& changes) {
  if (!changes.edges_gained.empty())
    AddLine(lines, Count(changes.edges_gained.size(), "edge", "edges") +
                       " new: " + Listed(NamesOf(changes.edges_gained)) + ".");
  if (!changes.edges_lost.empty())
    AddLine(lines,
            Count(changes.edges_lost.size(), "edge", "edges") + " gone: " + Listed(NamesOf(changes.edges_lost)) + ".");
  if (!changes.edges_past.empty())
    AddLine(lines, Count(changes.edges_past.size(), "edge does", "edges do") +
                       " not count any more: " + Listed(PairsOf(changes.edges_past)) + ".");
  if (!changes.sensors_gained.empty()) AddLine(lines, "Now known: " + Listed(NamesOf(changes.sensors_gained)) + ".");
  if (!changes.sensors_lost.empty()) AddLine(lines, "No longer known: " + Listed(NamesOf(changes.sensors_lost)) + ".");
  if (!changes.sensors_retired.empty()) AddLine(lines, "Retired: " + Listed(NamesOf(changes.sensors_retired)) + ".");
}

void FillMoves(Dictionary& section, const Changes& changes) {
  if (!changes.same_reference) return AddLine(section, "The reference sensor is another one: poses are not compared.");
  const auto moved =
      static_cast<std::size_t>(std::count_if(changes.moves.begin(), changes.moves.end(),
                                             [](const SensorMove& move) { return move.in_sigmas >= kOff_sigmas; }));
  if (changes.moves.empty()) return;
  AddLine(section, moved == 0 ? "No pose changed by more than 3 \xCF\x83."
                              : Count(moved, "pose", "poses") + " changed by more than 3 \xCF\x83.");
  Dictionary* list = section.AddSectionDictionary("MOVES");
  for (std::size_t i = 0; i < std::min(changes.moves.size(), kMovesMax); ++i)
    FillMove(*list->AddSectionDictionary("MOVE"), changes.moves[i]);
}

// A told pose is the mean of visits: it may change less than the sensor moved.
void FillElsewhere(Dictionary& section, const std::optional<AsFound>& found) {
  std::vector<std::string> names;
  if (found)
    for (const SensorFound& sensor : found->sensors)
      if (sensor.state == FoundState::kDrifted || sensor.state == FoundState::kNotToldApart)
        names.push_back(sensor.sensor.str());
  if (names.empty()) return;
  const bool one = names.size() == 1;
  AddLine(section, Listed(names) + (one ? " sat" : " each sat") +
                       " elsewhere in the newest session than in the calibration that was in use (as found, below): " +
                       (one ? "its pose is" : "their poses are") + " the mean of all visits that count.");
}

}  // namespace

void FillMove(Dictionary& row, const SensorMove& move) {
  row.SetValue("SENSOR", move.sensor.str());
  row.SetValue("MM", Significant(move.distance_m * kMmPerMetre, 3));
  row.SetValue("DEG", Significant(move.angle_rad * kDegPerRad, 3));
  row.SetValue("SIGMA_MM", SigmaMm(move.sigma.head<3>().maxCoeff()));
  row.SetValue("SIGMA_DEG", SigmaDeg(move.sigma.tail<3>().maxCoeff()));
  row.SetValue("IN_SIGMAS", SigmasText(move.in_sigmas));
  row.SetValue("LEVEL", SigmasClass(move.in_sigmas));
}

void FillChanges(Dictionary& page, const ReportInput& input) {
  if (!input.previous) return page.ShowSection("FIRST");
  Dictionary* section = page.AddSectionDictionary("CHANGES");
  section->SetValue("PREVIOUS", std::to_string(input.previous->number));
  section->SetValue("NUMBER", std::to_string(input.number));
  const Changes changes = Compare(input.previous->revision, input.revision);
  FillVerdictLine(*section, input.previous->revision.verdict, input.revision.verdict);
  FillEdgeLines(*section, changes);
  FillMoves(*section, changes);
  if (changes.same_reference) FillElsewhere(*section, input.as_found);
}

}  // namespace rigcal::report
