#include "server/report/sections/loop_section.h"

#include <algorithm>
#include <set>

#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kNamesMax = 12;  // of one loop

std::string WalkOf(const CycleResidual& cycle) {
  const std::string arrow = " \xE2\x86\x92 ";
  std::string text;
  for (std::size_t i = 0; i < std::min(cycle.sensors.size(), kNamesMax); ++i) text += cycle.sensors[i].str() + arrow;
  if (cycle.sensors.size() > kNamesMax)
    text += "\xE2\x80\xA6 (" + std::to_string(cycle.sensors.size()) + " edges)" + arrow;
  return text + (cycle.sensors.empty() ? "" : cycle.sensors.front().str());
}

std::set<EdgeId> DeficientEdges(const std::vector<Edge>& edges) {
  std::set<EdgeId> deficient;
  for (const Edge& edge : edges)
    if (edge.uncertainty.rank < 6) deficient.insert(edge.id);
  return deficient;
}

std::string WhyUntested(const CycleResidual& cycle, const std::set<EdgeId>& deficient) {
  if (cycle.tested) return "too few captures";
  const bool blind =
      std::any_of(cycle.edges.begin(), cycle.edges.end(), [&](const EdgeId& edge) { return deficient.contains(edge); });
  return blind ? "no direction is seen by all of its edges"
               : "its edges share their errors, so it closes whatever they are";
}

void FillTest(Dictionary& row, const CycleResidual& cycle, const std::set<EdgeId>& deficient) {
  if (!cycle.tested || !(cycle.limit > 0.0)) {
    ShowValue(row, "NO_TEST", "WHY", WhyUntested(cycle, deficient));
    return row.ShowSection("UNTESTED");
  }
  Dictionary* test = row.AddSectionDictionary("TEST");
  test->SetValue("T2", Significant(cycle.t_squared, 3));
  test->SetValue("LIMIT", Significant(cycle.limit, 3));
  if (cycle.fails()) test->ShowSection("BEYOND");
  row.ShowSection(cycle.fails() ? "FAILS" : "CLOSES");
}

void FillLoop(Dictionary& row, const CycleResidual& cycle, const std::set<EdgeId>& deficient) {
  row.SetValue("WALK", WalkOf(cycle));
  row.SetValue("MM", Significant(cycle.e.head<3>().norm() * kMmPerMetre, 3));
  row.SetValue("DEG", Significant(cycle.e.tail<3>().norm() * kDegPerRad, 3));
  FillTest(row, cycle, deficient);
}

std::string SummaryOf(const Cycles& cycles) {
  if (!cycles.judged) return "Loops were not worked out.";
  if (cycles.examined == 0) return "There is no loop of edges: nothing checks them.";
  std::string text = Count(static_cast<std::size_t>(cycles.examined), "loop", "loops") + " worked out, " +
                     std::to_string(cycles.tested) + " tested: ";
  if (cycles.tested == 0) return text + "nothing says whether they close.";
  if (cycles.failing == 0) return text + "all of these close.";
  return text + std::to_string(cycles.failing) + (cycles.failing == 1 ? " does not close." : " do not close.");
}

}  // namespace

void FillLoops(Dictionary& page, const formats::RevisionInput& revision) {
  const Cycles& cycles = revision.solution.cycles;
  if (!cycles.judged && cycles.why_not.empty()) return;
  Dictionary* section = page.AddSectionDictionary("LOOPS_SECTION")->AddIncludeDictionary("LOOPS");
  section->SetFilename("loops.tpl");
  section->SetValue("SUMMARY", SummaryOf(cycles));
  if (!cycles.why_not.empty()) ShowValue(*section, "NOTE", "TEXT", cycles.why_not);
  if (static_cast<std::int64_t>(cycles.worst.size()) < cycles.examined)
    ShowValue(*section, "NOTE", "TEXT",
              "Shown are the " + std::to_string(cycles.worst.size()) + " that close worst for their uncertainty.");
  if (cycles.worst.empty()) return;
  Dictionary* table = section->AddSectionDictionary("TABLE");
  const std::set<EdgeId> deficient = DeficientEdges(revision.edges);
  for (const CycleResidual& cycle : cycles.worst) FillLoop(*table->AddSectionDictionary("LOOP"), cycle, deficient);
}

}  // namespace rigcal::report
