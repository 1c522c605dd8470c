#include <algorithm>

#include "server/report/age.h"
#include "server/report/assets.h"
#include "server/report/banner.h"
#include "server/report/choices.h"
#include "server/report/page.h"
#include "server/report/robot_pages.h"
#include "server/report/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kSessionsMax = 200, kOpenSessionsMax = 5;

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
    if (i + 1 == revisions.size()) {
      row->ShowSection("FIRST");
      continue;
    }
    Dictionary* changed = row->AddSectionDictionary("CHANGED");
    changed->SetValue("NUMBER", std::to_string(revisions[i].number));
    changed->SetValue("BEFORE", std::to_string(revisions[i + 1].number));
  }
  if (revisions.size() > kRevisionsMax)
    ShowValue(*list, "MORE", "COUNT", std::to_string(revisions.size() - kRevisionsMax));
}

void FillOpen(Dictionary& page, const SessionRow& session) {
  Dictionary* open = page.AddSectionDictionary("OPEN");
  open->SetValue("ID", session.id.str());
  open->SetValue("SHORT", ShortDigest(session.id.str()));
  const bool arriving = !session.closed;
  open->SetValue("STATE", arriving ? "is arriving (or its push broke off)" : "is being calibrated");
  open->SetValue("DONE", std::to_string(arriving ? session.files_held : session.pairs - session.pairs_waiting));
  open->SetValue("ALL", std::to_string(arriving ? session.files : session.pairs));
  open->SetValue("UNIT", arriving ? "files" : "pairs");
}

// Pushes that broke off and were never taken up again stay: the newest stand for all.
void FillOpenOnes(Dictionary& page, const std::vector<SessionRow>& sessions) {
  std::size_t open = 0;
  for (const SessionRow& session : sessions)
    if ((!session.closed || session.pairs_waiting > 0) && open++ < kOpenSessionsMax) FillOpen(page, session);
  if (open > kOpenSessionsMax) ShowValue(page, "MORE_OPEN", "COUNT", Count(open - kOpenSessionsMax, "older session", "older sessions"));
}

// By which, since when and by whom; and how it is taken back.
void FillSuperseded(Dictionary& row, const SessionRow& session) {
  const Superseding& by = *session.superseded_by;
  Dictionary* part = row.AddSectionDictionary("SUPERSEDED");
  part->SetValue("BY", by.by.str());
  part->SetValue("SHORT", ShortDigest(by.by.str()));
  part->SetValue("TIME", TimeText(by.captured_at));
  if (!by.operator_name.empty()) ShowValue(*part, "PEOPLE", "NAME", by.operator_name);
  part->SetValue("SINCE", TimeText(by.standing.word.at));
  part->SetValue("HOW", HowText(by.standing));
  part->SetValue("OLD", session.id.str().substr(0, 16));
}

// Of a session that came whole; the others stand above the list, with their progress.
void FillResult(Dictionary& row, const SessionRow& session) {
  if (session.superseded_by) return FillSuperseded(row, session);
  if (!session.closed || session.pairs_waiting > 0)
    return ShowValue(row, "WORKING", "WORD", session.closed ? "being calibrated" : "arriving");
  if (session.pairs == 0) return ShowValue(row, "WORKING", "WORD", "no pair of sensors to calibrate");
  row.SetValue("GOOD", std::to_string(session.good) + " of " +
                           Count(static_cast<std::size_t>(session.pairs), "pair", "pairs") + " good");
  if (session.past > 0) ShowValue(row, "PAST", "COUNT", std::to_string(session.past));
  if (session.failed > 0) ShowValue(row, "FAILED", "COUNT", std::to_string(session.failed));
}

void FillSessions(Dictionary& page, const std::vector<SessionRow>& sessions, Stamp now) {
  FillOpenOnes(page, sessions);
  if (sessions.empty()) return;
  Dictionary* list = page.AddSectionDictionary("SESSIONS");
  for (std::size_t i = 0; i < std::min(sessions.size(), kSessionsMax); ++i) {
    const SessionRow& session = sessions[i];
    Dictionary* row = list->AddSectionDictionary("SESSION");
    row->SetValue("ID", session.id.str());
    row->SetValue("SHORT", ShortDigest(session.id.str()));
    row->SetValue("TIME", TimeText(session.captured_at));
    row->SetValue("AGE", AgeOf(session.captured_at, now));
    row->SetValue("OPERATOR", session.operator_name);
    row->SetValue("FILES", std::to_string(session.files));
    FillResult(*row, session);
  }
  if (sessions.size() > kSessionsMax)
    ShowValue(*list, "MORE", "COUNT", std::to_string(sessions.size() - kSessionsMax));
}

// The way on: the newest report, and what is different in it.
void FillNewest(Dictionary& page, const std::vector<Revision>& revisions) {
  std::vector<int> numbers;
  for (const Revision& revision : revisions) numbers.push_back(revision.number);
  if (numbers.empty()) return;
  std::sort(numbers.rbegin(), numbers.rend());
  Dictionary* newest = page.AddSectionDictionary("NEWEST");
  newest->SetValue("NUMBER", std::to_string(numbers[0]));
  if (numbers.size() < 2) return;
  Dictionary* since = newest->AddSectionDictionary("SINCE");
  since->SetValue("NUMBER", std::to_string(numbers[0]));
  since->SetValue("BEFORE", std::to_string(numbers[1]));
}

// Two revisions to compare: the newest and the one before it.
void FillCompare(Dictionary& page, const std::vector<Revision>& revisions) {
  if (revisions.size() < 2) return;
  std::vector<int> numbers;
  for (const Revision& revision : revisions) numbers.push_back(revision.number);
  std::sort(numbers.rbegin(), numbers.rend());
  Dictionary* compare = page.AddSectionDictionary("COMPARE");
  FillChoices(*compare, "CHOICE_A", numbers, numbers[1]);
  FillChoices(*compare, "CHOICE_B", numbers, numbers[0]);
}

}  // namespace

Result<std::string> RenderRobot(const RobotInput& input, Stamp now) {
  Dictionary page("robot");
  const RobotSummary& row = input.row;
  FillHead(page, row.robot.str() + ": " + (row.validity.overdue ? "Overdue, " : "") + VerdictWord(row.verdict.level),
           "../../");
  page.SetValue("ROBOT", row.robot.str());
  page.SetValue("SUMMARY", (IsNever(row) ? std::string("Not calibrated yet")
                                         : "Calibrated " + AgeOf(*row.validity.calibrated_at, now)) +
                               ", " + Count(static_cast<std::size_t>(row.sessions), "session", "sessions") + ", " +
                               Count(static_cast<std::size_t>(row.edges), "edge", "edges"));
  FillBanner(page, row.verdict, row.validity, row.revision > 0);
  if ((row.validity.calculating || !row.validity.given_up.empty()) && row.revision > 0) {
    Dictionary* newer = page.AddSectionDictionary("NEWER");
    newer->SetValue("TEXT", row.validity.given_up.empty() ? kCalculatingText : row.validity.given_up);
    newer->SetValue("NUMBER", std::to_string(row.revision));
  }
  FillNewest(page, input.revisions);
  FillSessions(page, input.sessions, now);
  FillRevisions(page, input.revisions, now);
  FillCompare(page, input.revisions);
  AddScript(page, "../../" + AssetPath("live.js"));
  if (input.revisions.size() < 2 || input.sensors.empty()) return Expand("robot.tpl", page);
  Dictionary* trends = page.AddSectionDictionary("TRENDS");
  for (const SensorId& sensor : input.sensors) ShowValue(*trends, "TREND", "SENSOR", sensor.str());
  AddScript(page, "trend.js");
  AddScript(page, "../../" + AssetPath("charts.js"));
  return Expand("robot.tpl", page);
}

}  // namespace rigcal::report
