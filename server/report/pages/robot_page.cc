#include <algorithm>

#include "server/report/frame/assets.h"
#include "server/report/frame/banner.h"
#include "server/report/frame/choices.h"
#include "server/report/frame/page.h"
#include "server/report/frame/retired_section.h"
#include "server/report/models/model_pages.h"
#include "server/report/pages/robot_figures.h"
#include "server/report/robot_pages.h"
#include "server/report/text/age.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kOpenSessionsMax = 5;
constexpr std::size_t kEpochsMax = 50;

// The ways to other pages of a list.
void FillPages(Dictionary& list, bool is_newest, const std::string& last_shown) {
  if (is_newest && last_shown.empty()) return;
  Dictionary* pages = list.AddSectionDictionary("PAGES");
  if (!is_newest) pages->ShowSection("NEWEST_PAGE");
  if (!last_shown.empty()) ShowValue(*pages, "OLDER", "BEFORE", last_shown);
}

// Of what is unusable the verdict says it.
void FillLife(Dictionary& row, const std::map<int, RevisionState>& states, int number) {
  const auto found = states.find(number);
  if (found != states.end() && found->second != RevisionState::kUnusable)
    ShowValue(row, "STATE", "WORD", WordFor(found->second));
}

void FillRevisions(Dictionary& page, const RobotInput& input, Stamp now) {
  std::vector<Revision> revisions = input.revisions;
  if (revisions.empty()) return;
  std::stable_sort(revisions.begin(), revisions.end(),
                   [](const Revision& a, const Revision& b) { return a.number > b.number; });
  Dictionary* list = page.AddSectionDictionary("REVISIONS");
  for (const Revision& revision : revisions) {
    Dictionary* row = list->AddSectionDictionary("REVISION");
    row->SetValue("NUMBER", std::to_string(revision.number));
    FillBadge(*row, revision.verdict.level);
    row->SetValue("WHY", revision.verdict.why);
    FillLife(*row, input.states, revision.number);
    row->SetValue("TIME", TimeText(revision.created_at));
    row->SetValue("AGE", AgeOf(revision.created_at, now));
    if (revision.number <= 1) {
      row->ShowSection("FIRST");
      continue;
    }
    Dictionary* changed = row->AddSectionDictionary("CHANGED");
    changed->SetValue("NUMBER", std::to_string(revision.number));
    changed->SetValue("BEFORE", std::to_string(revision.number - 1));
  }
  FillPages(*list, input.newest_revisions, input.older_revisions ? std::to_string(revisions.back().number) : "");
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
void FillOpenOnes(Dictionary& page, const std::vector<SessionRow>& open) {
  for (std::size_t i = 0; i < std::min(open.size(), kOpenSessionsMax); ++i) FillOpen(page, open[i]);
  if (open.size() > kOpenSessionsMax)
    ShowValue(page, "MORE_OPEN", "COUNT", Count(open.size() - kOpenSessionsMax, "older session", "older sessions"));
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

void FillRetired(Dictionary& row, const SessionRow& session) {
  Dictionary* part = row.AddSectionDictionary("RETIRED");
  part->SetValue("WHY", RetiredText(*session.retired));
  part->SetValue("COMMAND", RestoreCommand(session.id));
}

// Of a session that came whole; the others stand above the list, with their progress.
void FillResult(Dictionary& row, const SessionRow& session) {
  if (session.retired) return FillRetired(row, session);
  if (session.superseded_by) return FillSuperseded(row, session);
  if (!session.closed || session.pairs_waiting > 0)
    return ShowValue(row, "WORKING", "WORD", session.closed ? "being calibrated" : "arriving");
  if (session.pairs == 0) return ShowValue(row, "WORKING", "WORD", "no pair of sensors to calibrate");
  row.SetValue("GOOD", std::to_string(session.good) + " of " +
                           Count(static_cast<std::size_t>(session.pairs), "pair", "pairs") + " good");
  if (session.past > 0) ShowValue(row, "PAST", "COUNT", std::to_string(session.past));
  if (session.failed > 0) ShowValue(row, "FAILED", "COUNT", std::to_string(session.failed));
}

void FillSessions(Dictionary& page, const RobotInput& input, Stamp now) {
  if (input.sessions.empty()) return;
  Dictionary* list = page.AddSectionDictionary("SESSIONS");
  for (const SessionRow& session : input.sessions) {
    Dictionary* row = list->AddSectionDictionary("SESSION");
    row->SetValue("ID", session.id.str());
    row->SetValue("SHORT", ShortDigest(session.id.str()));
    row->SetValue("TIME", TimeText(session.captured_at));
    row->SetValue("AGE", AgeOf(session.captured_at, now));
    row->SetValue("OPERATOR", session.operator_name);
    row->SetValue("FILES", std::to_string(session.files));
    FillResult(*row, session);
  }
  FillPages(*list, input.newest_sessions, input.older_sessions ? input.sessions.back().id.str() : "");
}

void FillGoneSensors(Dictionary& page, const RobotInput& input) {
  if (!input.retired.empty()) FillGone(*page.AddSectionDictionary("GONE_SENSORS"), input.row.robot, input.retired);
}

void FillEpochs(Dictionary& page, const RobotId& robot, const std::vector<Epoch>& epochs) {
  if (epochs.empty()) return;
  Dictionary* list = page.AddSectionDictionary("EPOCHS");
  const std::size_t shown = std::min(epochs.size(), kEpochsMax);
  for (std::size_t i = 0; i < shown; ++i) {
    const Epoch& epoch = epochs[epochs.size() - 1 - i];
    Dictionary* row = list->AddSectionDictionary("EPOCH");
    row->SetValue("TIME", TimeText(epoch.begins_at));
    row->SetValue("TEXT", TextOf(epoch));
    if (epoch.session.empty()) continue;
    Dictionary* session = row->AddSectionDictionary("SESSION");
    session->SetValue("ID", epoch.session.str());
    session->SetValue("SHORT", ShortDigest(epoch.session.str()));
  }
  if (shown < epochs.size())
    ShowValue(*list, "MORE", "TEXT",
              std::to_string(epochs.size() - shown) + " older ones: `rigcal history " + robot.str() + "` lists all.");
}

void FillRigModel(Dictionary& page, const std::string& rig_model) {
  if (rig_model.empty()) return;
  Dictionary* model = page.AddSectionDictionary("MODEL");
  model->SetValue("NAME", rig_model);
  model->SetValue("PATH", PathOfRigModel(rig_model));
}

// The way on: the newest report, and what is different in it.
void FillNewest(Dictionary& page, int number, const Verdict& verdict) {
  if (number == 0) return;
  Dictionary* newest = page.AddSectionDictionary("NEWEST");
  newest->SetValue("NUMBER", std::to_string(number));
  newest->SetValue("SHEET", IsUsable(verdict) ? "Certificate" : "Record");
  if (number < 2) return;
  Dictionary* since = newest->AddSectionDictionary("SINCE");
  since->SetValue("NUMBER", std::to_string(number));
  since->SetValue("BEFORE", std::to_string(number - 1));
}

// Two revisions to compare: the newest and the one before it.
void FillCompare(Dictionary& page, int newest) {
  if (newest < 2) return;
  Dictionary* compare = page.AddSectionDictionary("COMPARE");
  FillChoices(*compare, "CHOICE_A", newest, newest - 1);
  FillChoices(*compare, "CHOICE_B", newest, newest);
}

// The first action with what its state asks for.
VerdictBasis BasisWithWhatToDo(const RobotSummary& row) {
  VerdictBasis basis = row.basis;
  if (basis.reasons.empty()) return basis;
  Verdict first = row.verdict;
  first.what_to_do = basis.reasons.front().what_to_do;
  basis.reasons.front().what_to_do = WhatToDo(row.robot, row.revision, row.state, first);
  return basis;
}

const char* LateWord(const Validity& validity) {
  if (!validity.overdue) return "";
  return validity.calibrated_at ? "Overdue, " : "Not calibrated, ";
}

}  // namespace

Result<std::string> RenderRobot(const RobotInput& input, Stamp now) {
  Dictionary page("robot");
  const RobotSummary& row = input.row;
  FillHead(page, row.robot.str() + ": " + LateWord(row.validity) + VerdictWord(row.verdict.level), "../../");
  page.SetValue("ROBOT", row.robot.str());
  page.SetValue("SUMMARY", (IsNever(row) ? std::string("Not calibrated yet")
                                         : "Calibrated " + AgeOf(*row.validity.calibrated_at, now)) +
                               ", " + Count(static_cast<std::size_t>(row.sessions), "session", "sessions") + ", " +
                               Count(static_cast<std::size_t>(row.edges), "edge", "edges"));
  FillRigModel(page, input.rig_model);
  if (!row.site.empty()) ShowValue(page, "SITE", "NAME", row.site);
  Verdict verdict = row.verdict;
  verdict.what_to_do = WhatToDo(row.robot, row.revision, row.state, row.verdict);
  FillBanner(page, verdict, row.validity, row.revision > 0, row.runs, BasisWithWhatToDo(row));
  FillRobotFigures(page, row, now);
  if ((row.validity.calculating || !row.validity.given_up.empty()) && row.revision > 0) {
    Dictionary* newer = page.AddSectionDictionary("NEWER");
    newer->SetValue("TEXT", row.validity.given_up.empty() ? kCalculatingText : row.validity.given_up);
    newer->SetValue("NUMBER", std::to_string(row.revision));
  }
  if (const std::string text = ApprovalText(row.robot, row.revision, input.approval); row.revision > 0 && !text.empty())
    ShowValue(page, "APPROVAL", "TEXT", text + ".");
  if (row.runs && !row.runs->trouble.empty()) ShowValue(page, "RUNS", "TEXT", row.runs->trouble);
  FillNewest(page, row.revision, row.verdict);
  FillOpenOnes(page, input.open);
  FillSessions(page, input, now);
  FillEpochs(page, input.row.robot, input.epochs);
  FillGoneSensors(page, input);
  FillRevisions(page, input, now);
  FillCompare(page, row.revision);
  AddScript(page, "../../" + AssetPath("live.js"));
  if (row.revision < 2 || input.sensors.empty()) return Expand("robot.tpl", page);
  Dictionary* trends = page.AddSectionDictionary("TRENDS");
  for (const SensorId& sensor : input.sensors) ShowValue(*trends, "TREND", "SENSOR", sensor.str());
  AddScriptsLater(page, "../../" + AssetPath("later.js"), {"trend.js", "../../" + AssetPath("charts.js")});
  return Expand("robot.tpl", page);
}

}  // namespace rigcal::report
