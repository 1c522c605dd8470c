#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "server/report/frame/assets.h"
#include "server/report/frame/banner.h"
#include "server/report/pages/work_lists.h"
#include "server/report/render.h"
#include "server/report/text/age.h"
#include "server/report/text/cause_words.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {

namespace {

std::string CountOfRobots(const FleetCounts& fleet) {
  return Count(static_cast<std::size_t>(fleet.robots), "robot", "robots");
}

// Each count leads to the robots that it counts.
void FillSummary(Dictionary& page, const FleetCounts& fleet) {
  page.SetValue("SUMMARY", CountOfRobots(fleet));
  const auto add = [&](const std::string& value, const std::string& words, std::int64_t count) {
    if (count == 0) return;
    Dictionary* part = page.AddSectionDictionary("PART");
    part->SetValue("VALUE", value);
    part->SetValue("TEXT", std::to_string(count) + " " + words);
  };
  add("overdue", "overdue", fleet.overdue);
  for (const DriveKind kind : kDriveKinds)
    if (const auto found = fleet.kinds.find(kind); found != fleet.kinds.end())
      add(NameOf(kind), WordsFor(kind), found->second);
}

void FillWorst(Dictionary& row, const std::optional<WorstEdge>& worst) {
  if (!worst) return row.ShowSection("NO_WORST");
  Dictionary* one = row.AddSectionDictionary("WORST");
  one->SetValue("FROM", worst->frame_a.str());
  one->SetValue("TO", worst->frame_b.str());
  one->SetValue("SIGMAS", SigmasText(worst->in_sigmas));
  one->SetValue("LEVEL", SigmasClass(worst->in_sigmas));
}

// Red is what must not drive: of a robot that may, the status asks for work.
const char* LevelOfStatus(StatusWord word, const Verdict& verdict) {
  if (word == StatusWord::kOk) return "pass";
  if (word == StatusWord::kUnknown) return "unknown";
  return word == StatusWord::kFailed || !IsUsable(verdict) ? "fail" : "warn";
}

// Of what the verdict says by itself there is the word alone.
void FillStatus(Dictionary& row, const RobotSummary& robot, Stamp now) {
  const CalibrationStatus status = StatusAt(robot, now);
  row.SetValue("STATUS", NameOf(status.word));
  row.SetValue("STATUS_LEVEL", LevelOfStatus(status.word, robot.verdict));
  const bool found = status.word == StatusWord::kDrifted || status.word == StatusWord::kOutOfTolerance;
  if (found) ShowValue(row, "STATUS_WHY", "TEXT", status.why);
  if (found) ShowValue(row, "STATUS_DO", "TEXT", status.next_step);
  if (robot.drift_due && DueAt(robot.validity, robot.drift_due) == robot.drift_due->at)
    ShowValue(row, "DRIFT", "TEXT", DayText(robot.drift_due->at) + " by drift of " + robot.drift_due->sensor.str());
  if (!robot.site.empty()) ShowValue(row, "SITE", "TEXT", robot.site);
}

void FillRow(Dictionary& row, const RobotSummary& robot, Stamp now) {
  row.SetValue("ROBOT", robot.robot.str());
  FillOverdue(row, robot.verdict, robot.validity, robot.runs);
  FillDrive(row, robot.verdict, robot.validity, robot.runs);
  FillBadge(row, robot.verdict.level);
  row.SetValue("WHY", robot.verdict.why);
  const bool asks = robot.verdict.level != VerdictLevel::kPass || robot.state == RevisionState::kCandidate;
  if (const std::string action = WhatToDo(robot.robot, robot.revision, robot.state, robot.verdict); asks && !action.empty())
    ShowValue(row, "DO", "WHAT_TO_DO", action);
  if (robot.revision > 0 && !IsUsable(robot.verdict)) ShowValue(row, "KEEP", "TEXT", KeepText(robot.verdict.level, robot.validity.usable));
  if (robot.runs && !robot.runs->trouble.empty()) ShowValue(row, "RUNS", "TEXT", robot.runs->trouble);
  if (robot.jobs_waiting > 0)
    ShowValue(row, "WORKING", "TEXT",
              Count(static_cast<std::size_t>(robot.jobs_waiting), "pair", "pairs") + " being calibrated");
  row.SetValue("AGE", IsNever(robot) ? "never" : AgeOf(*robot.validity.calibrated_at, now));
  if (!IsNever(robot)) ShowValue(row, "DUE", "DAY", DayText(*ValidUntil(robot.validity)));
  row.SetValue("LAST", robot.last_session_at ? AgeOf(*robot.last_session_at, now) : "none");
  FillStatus(row, robot, now);
  FillWorst(row, robot.worst);
  row.SetValue("SESSIONS", std::to_string(robot.sessions));
  row.SetValue("EDGES", std::to_string(robot.edges));
  if (robot.revision == 0) return row.ShowSection("NO_REVISION");
  Dictionary* revision = row.AddSectionDictionary("REVISION");
  revision->SetValue("NUMBER", std::to_string(robot.revision));
  revision->SetValue("ROBOT", robot.robot.str());
}

constexpr std::array<std::pair<const char*, const char*>, 17> kChoices = {{{"", "all"},
                                                                          {"do_not_drive", "do not drive"},
                                                                          {"not_verified", "not verified"},
                                                                          {"not_applied", "not applied"},
                                                                          {"to_approve", "to be approved"},
                                                                          {"ok_with_action", "OK to drive, with a warning"},
                                                                          {"ok", "OK to drive"},
                                                                          {"fail", "fail"},
                                                                          {"unknown", "unknown"},
                                                                          {"warn", "warn"},
                                                                          {"pass", "pass"},
                                                                          {"overdue", "overdue"},
                                                                          {"this_week", "due this week"},
                                                                          {"next_week", "due next week"},
                                                                          {"later", "due later"},
                                                                          {"off", "an edge beyond 3 \xCF\x83"},
                                                                          {"quiet", "no session for 30 days"}}};
constexpr std::array<std::pair<const char*, const char*>, 9> kColumns = {{{"robot", "Robot"},
                                                                          {"", "Verdict"},
                                                                          {"status", "Status"},
                                                                          {"calibrated", "Calibrated"},
                                                                          {"session", "Last session"},
                                                                          {"worst", "Worst edge"},
                                                                          {"revision", "Revision"},
                                                                          {"sessions", "Sessions"},
                                                                          {"edges", "Edges"}}};

void FillStatusChoices(Dictionary& list, const FleetQuery& query) {
  const auto add = [&](const std::string& value, const std::string& name) {
    Dictionary* choice = list.AddSectionDictionary("STATUS_CHOICE");
    choice->SetValue("VALUE", value);
    choice->SetValue("NAME", name);
    if (query.status == value) choice->ShowSection("CHOSEN");
  };
  add("", "all");
  for (const StatusWord word : kStatusWords) add(NameOf(word), NameOf(word));
}

void FillForm(Dictionary& list, const FleetQuery& query) {
  list.SetValue("SEARCH", query.search);
  list.SetValue("SORT", query.sort);
  list.SetValue("ORDER", query.descending ? "down" : "");
  if (!query.cause.empty()) ShowValue(list, "CAUSE", "KEY", query.cause);
  for (const auto& [value, name] : kChoices) {
    Dictionary* choice = list.AddSectionDictionary("CHOICE");
    choice->SetValue("VALUE", value);
    choice->SetValue("NAME", name);
    if (query.verdict == value) choice->ShowSection("CHOSEN");
  }
  FillStatusChoices(list, query);
  if (!query.site.empty()) ShowValue(list, "FORM_SITE", "PLACE", query.site);
}

// The address of another view of the same fleet: SEARCH, VERDICT, SORT, ORDER, PAGE, and CAUSE with its KEY.
void FillAddress(Dictionary& link, const FleetQuery& query) {
  link.SetValue("SEARCH", query.search);
  link.SetValue("VERDICT", query.verdict);
  link.SetValue("SORT", query.sort);
  link.SetValue("ORDER", query.descending ? "down" : "");
  link.SetValue("PAGE", std::to_string(query.page));
  if (!query.cause.empty()) ShowValue(link, "CAUSE", "KEY", InAddress(query.cause));
  if (!query.status.empty()) ShowValue(link, "ONLY_STATUS", "WORD", InAddress(query.status));
  if (!query.site.empty()) ShowValue(link, "ONLY_SITE", "PLACE", InAddress(query.site));
}

// What is shown is of one cause: which, and the way back.
void FillOnly(Dictionary& list, FleetQuery query) {
  if (query.cause.empty()) return;
  Dictionary* only = list.AddSectionDictionary("ONLY");
  only->SetValue("TEXT", CauseText(query.cause));
  query.cause.clear();
  query.page = 1;
  FillAddress(*only, query);
}

bool IsNumber(std::string_view column) { return column == "revision" || column == "sessions" || column == "edges"; }

void FillColumns(Dictionary& list, const FleetQuery& query) {
  for (const auto& [sort, name] : kColumns) {
    Dictionary* column = list.AddSectionDictionary("COLUMN");
    const bool chosen = query.sort == sort;
    FleetQuery next = query;
    next.sort = sort;
    next.page = 1;
    next.descending = chosen && !query.descending;
    FillAddress(*column, next);
    column->SetValue("NAME", name);
    if (IsNumber(sort)) column->ShowSection("NUMERIC");
    if (chosen) ShowValue(*column, "SORTED", "DIRECTION", query.descending ? "descending" : "ascending");
    column->SetValue("ARROW", !chosen ? "\xE2\x86\x95" : query.descending ? "\xE2\x86\x93" : "\xE2\x86\x91");
  }
}

void FillPager(Dictionary& list, FleetQuery query, const FleetCounts& fleet, const FleetPage& shown) {
  const bool all = shown.matches == static_cast<std::size_t>(fleet.robots);
  list.SetValue("COUNT", (all ? "" : std::to_string(shown.matches) + " of ") + CountOfRobots(fleet));
  if (shown.matches == 0) list.ShowSection("NOTHING");
  if (shown.pages < 2) return;
  Dictionary* pager = list.AddSectionDictionary("PAGER");
  pager->SetValue("PAGE", std::to_string(shown.page));
  pager->SetValue("PAGES", std::to_string(shown.pages));
  query.page = shown.page - 1;
  if (shown.page > 1) FillAddress(*pager->AddSectionDictionary("BEFORE"), query);
  query.page = shown.page + 1;
  if (shown.page < shown.pages) FillAddress(*pager->AddSectionDictionary("NEXT"), query);
}

}  // namespace

Result<std::string> RenderFleet(const FleetCounts& fleet, const FleetPage& list, Stamp now, const FleetQuery& query,
                                std::size_t experiments, std::size_t boards) {
  Dictionary page("fleet");
  FillHead(page, "Fleet", "");
  if (experiments > 0) ShowValue(page, "EXPERIMENTS", "COUNT", Count(experiments, "experiment", "experiments"));
  AddScript(page, AssetPath("live.js"));
  if (fleet.robots == 0) {
    page.ShowSection("EMPTY");
    return Expand("fleet.tpl", page);
  }
  FillSummary(page, fleet);
  page.ShowSection("RIG_MODELS");
  ShowValue(page, "BOARDS", "TEXT", boards == 0 ? "boards" : Count(boards, "board", "boards"));
  FillWorkLists(page, fleet);
  Dictionary* robots = page.AddSectionDictionary("ROBOTS");
  FillForm(*robots, query);
  FillColumns(*robots, query);
  FillOnly(*robots, query);
  FillPager(*robots, query, fleet, list);
  Dictionary* downloads = robots->AddSectionDictionary("CSV");
  FillAddress(*downloads, query);
  if (!query.site.empty()) ShowValue(*downloads, "CALENDAR_SITE", "PLACE", InAddress(query.site));
  for (const RobotSummary& row : list.rows) FillRow(*robots->AddSectionDictionary("ROW"), row, now);
  return Expand("fleet.tpl", page);
}

}  // namespace rigcal::report
