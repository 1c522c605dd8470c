#include <algorithm>
#include <tuple>

#include "server/report/banner.h"
#include "server/report/render.h"
#include "server/report/text.h"

namespace rigcal::report {
namespace {

int Urgency(VerdictLevel level) {
  switch (level) {
    case VerdictLevel::kFail:
      return 0;
    case VerdictLevel::kUnknown:
      return 1;
    case VerdictLevel::kWarn:
      return 2;
    case VerdictLevel::kPass:
      break;
  }
  return 3;
}

std::string AgeOf(Stamp then, Stamp now) {
  return then.ns > now.ns ? "in the future: check the clock" : AgeText(now.ns - then.ns) + " ago";
}

std::string FleetSummary(const std::vector<FleetRow>& rows) {
  std::size_t overdue = 0;
  std::map<VerdictLevel, std::size_t> levels;
  for (const FleetRow& row : rows) {
    ++levels[row.verdict.level];
    overdue += row.overdue ? 1 : 0;
  }
  std::string text = Count(rows.size(), "robot", "robots");
  const char* separator = ": ";
  for (const VerdictLevel level :
       {VerdictLevel::kFail, VerdictLevel::kUnknown, VerdictLevel::kWarn, VerdictLevel::kPass}) {
    if (levels[level] == 0) continue;
    text += separator + std::to_string(levels[level]) + " " + NameOf(level);
    separator = ", ";
  }
  return text + (overdue > 0 ? "; " + std::to_string(overdue) + " overdue" : "");
}

// A revision may hold failed edges only.
bool IsNever(const FleetRow& robot) { return robot.revision == 0 || robot.calibrated_at.ns == 0; }

void FillRow(Dictionary& row, const FleetRow& robot, Stamp now) {
  row.SetValue("ROBOT", robot.robot.str());
  FillBadge(row, robot.verdict.level);
  row.SetValue("WHY", robot.verdict.why);
  row.SetValue("AGE", IsNever(robot) ? "never" : AgeOf(robot.calibrated_at, now));
  row.SetValue("SESSIONS", std::to_string(robot.sessions));
  row.SetValue("EDGES", std::to_string(robot.edges));
  if (robot.overdue) row.ShowSection("OVERDUE");
  if (robot.revision == 0) return row.ShowSection("NO_REVISION");
  Dictionary* revision = row.AddSectionDictionary("REVISION");
  revision->SetValue("NUMBER", std::to_string(robot.revision));
  revision->SetValue("ROBOT", robot.robot.str());
}

void FillRevisions(Dictionary& page, std::vector<Revision> revisions, Stamp now) {
  constexpr std::size_t kRevisionsMax = 500;
  if (revisions.empty()) return;
  std::stable_sort(revisions.begin(), revisions.end(),
                   [](const Revision& a, const Revision& b) { return a.number > b.number; });
  Dictionary* list = page.AddSectionDictionary("REVISIONS");
  for (std::size_t i = 0; i < std::min(revisions.size(), kRevisionsMax); ++i) {
    Dictionary* row = list->AddSectionDictionary("REVISION");
    row->SetValue("NUMBER", std::to_string(revisions[i].number));
    FillBadge(*row, revisions[i].verdict.level);
    row->SetValue("WHY", revisions[i].verdict.why);
    row->SetValue("TIME", TimeText(revisions[i].created_at));
    row->SetValue("AGE", AgeOf(revisions[i].created_at, now));
    row->SetValue("DIGEST", ShortDigest(revisions[i].digest.str()));
  }
  if (revisions.size() > kRevisionsMax)
    ShowValue(*list, "MORE", "COUNT", std::to_string(revisions.size() - kRevisionsMax));
}

}  // namespace

Result<std::string> RenderFleet(const std::vector<FleetRow>& rows, Stamp now) {
  Dictionary page("fleet");
  FillHead(page, "Fleet", "");
  if (rows.empty())
    page.ShowSection("EMPTY");
  else
    page.SetValue("SUMMARY", FleetSummary(rows));
  std::vector<FleetRow> sorted = rows;
  std::sort(sorted.begin(), sorted.end(), [](const FleetRow& a, const FleetRow& b) {
    return std::make_tuple(Urgency(a.verdict.level), !a.overdue, a.robot) <
           std::make_tuple(Urgency(b.verdict.level), !b.overdue, b.robot);
  });
  Dictionary* list = rows.empty() ? nullptr : page.AddSectionDictionary("ROBOTS");
  for (const FleetRow& row : sorted) FillRow(*list->AddSectionDictionary("ROW"), row, now);
  return Expand("fleet.tpl", page);
}

Result<std::string> RenderRobot(const FleetRow& row, const std::vector<Revision>& revisions, Stamp now) {
  Dictionary page("robot");
  FillHead(page, row.robot.str() + ": " + VerdictWord(row.verdict.level), "../../");
  page.SetValue("ROBOT", row.robot.str());
  page.SetValue("SUMMARY", (IsNever(row) ? std::string("Not calibrated yet")
                                              : "Calibrated " + AgeOf(row.calibrated_at, now)) +
                               ", " + Count(static_cast<std::size_t>(row.sessions), "session", "sessions") + ", " +
                               Count(static_cast<std::size_t>(row.edges), "edge", "edges"));
  if (row.overdue) page.ShowSection("OVERDUE");
  FillBanner(page, row.verdict);
  FillRevisions(page, revisions, now);
  return Expand("robot.tpl", page);
}

}  // namespace rigcal::report
