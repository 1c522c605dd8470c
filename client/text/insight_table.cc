#include "client/text/insight_table.h"

#include <algorithm>
#include <string>
#include <vector>

#include "client/text/edge_table.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kRowsMax = 10, kLoopNamesMax = 8;

// Those that are checked, the most influential first; the order of the document settles ties.
std::vector<Document> ByInfluence(const Document& revision) {
  std::vector<Document> edges;
  for (const Document& edge : revision["edges"].Items())
    if (edge["influence"]["move_sigmas"].Number()) edges.push_back(edge);
  std::stable_sort(edges.begin(), edges.end(), [](const Document& a, const Document& b) {
    return a["influence"]["move_sigmas"].Number() > b["influence"]["move_sigmas"].Number();
  });
  return edges;
}

void PrintWhyNot(const Document& state, std::ostream& out) {
  if (!state["why_not"].IsNull()) out << "  " << Plain(state["why_not"].Text()) << '\n';
}

// "left - top - right - left"
std::string WalkOf(const Document& loop) {
  std::string text;
  const std::vector<Document> sensors = loop["sensors"].Items();
  for (std::size_t i = 0; i < std::min(sensors.size(), kLoopNamesMax); ++i) text += sensors[i].Text("?") + " - ";
  if (sensors.size() > kLoopNamesMax) text += "... (" + std::to_string(sensors.size()) + " edges) - ";
  return text + (sensors.empty() ? "?" : sensors.front().Text("?"));
}

std::string TestOf(const Document& loop) {
  if (!loop["tested"].Flag()) return "no test";
  const std::string t_squared = Fixed(loop["t_squared"].Number(), 1);
  return t_squared + " (" + (loop["limit"].IsNull() ? "too few captures" : Fixed(loop["limit"].Number(), 1)) + ")";
}

std::string CountText(const Document& cycles) {
  const auto count = [&](const char* key) { return cycles[key].Integer().value_or(0); };
  if (count("examined") == 0) return "none: nothing checks the edges";
  return std::to_string(count("examined")) + " worked out, " + std::to_string(count("tested")) + " tested, " +
         (count("tested") == 0 ? "nothing says whether they close"
          : count("failing") == 0
              ? "all of these close"
              : std::to_string(count("failing")) + (count("failing") == 1 ? " does not close" : " do not close"));
}

}  // namespace

void PrintInfluence(const Document& revision, std::ostream& out) {
  const Document state = revision["influence"];
  if (state.IsNull()) return;
  out << "\nInfluence: what leaving out one edge changes\n";
  PrintWhyNot(state, out);
  const std::vector<Document> edges = ByInfluence(revision);
  Table table({{"WITHOUT"}, {"MOVES"}, {"mm", Align::kRight}, {"deg", Align::kRight}, {"in sigmas", Align::kRight}});
  for (std::size_t i = 0; i < std::min(edges.size(), kRowsMax); ++i) {
    const Document influence = edges[i]["influence"];
    table.Add({PairOf(edges[i]), influence["sensor"].Text("?"), Scaled(LengthOf(influence["move"], 0), kMmPerM, 3),
               Scaled(LengthOf(influence["move"], 3), kDegPerRad, 4), Fixed(influence["move_sigmas"].Number(), 2)});
  }
  if (!table.empty()) table.Print(out);
  if (edges.size() > kRowsMax) out << "  and " << edges.size() - kRowsMax << " edges of less influence\n";
}

void PrintLoops(const Document& revision, std::ostream& out) {
  const Document cycles = revision["cycles"];
  if (cycles.IsNull()) return;
  out << "\nLoops";
  if (cycles["judged"].Flag()) out << ": " << CountText(cycles);
  out << '\n';
  PrintWhyNot(cycles, out);
  Table table({{"LOOP"}, {"mm", Align::kRight}, {"deg", Align::kRight}, {"T^2 (limit)", Align::kRight}, {""}});
  const std::vector<Document> worst = cycles["worst"].Items();
  for (std::size_t i = 0; i < std::min(worst.size(), kRowsMax); ++i)
    table.Add({WalkOf(worst[i]), Scaled(LengthOf(worst[i]["e"], 0), kMmPerM, 3),
               Scaled(LengthOf(worst[i]["e"], 3), kDegPerRad, 4), TestOf(worst[i]),
               worst[i]["fails"].Flag() ? "FAILS" : ""});
  if (!table.empty()) table.Print(out);
}

}  // namespace rigcal::client
