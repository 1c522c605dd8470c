#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "server/report/frame/assets.h"
#include "server/report/pages/fleet_row.h"
#include "server/report/pages/site_fleet.h"
#include "server/report/pages/work_lists.h"
#include "server/report/render.h"
#include "server/report/text/cause_words.h"
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
  for (const DriveKind kind : kDriveKinds)
    if (const auto found = fleet.kinds.find(kind); found != fleet.kinds.end())
      add(NameOf(kind), WordsFor(kind), found->second);
  add("not_calibrated", "of these not calibrated", fleet.not_calibrated);
  add("overdue", "of these overdue", fleet.overdue);
}

constexpr std::array<std::pair<const char*, const char*>, 18> kChoices = {
    {{"", "all"},
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
     {"not_calibrated", "not calibrated"},
     {"overdue", "overdue"},
     {"this_week", "due this week"},
     {"next_week", "due next week"},
     {"later", "due later"},
     {"off", "an edge beyond 3 \xCF\x83"},
     {"quiet", "no session for 30 days"}}};
// The headings of one column, each with what it sorts by: what stands below each other in a cell.
using Headings = std::vector<std::pair<const char*, const char*>>;

// What no robot has has no heading.
std::vector<Headings> ColumnsOf(const FleetCounts& fleet) {
  std::vector<Headings> columns = {{{"robot", "Robot"}}, {{"", "Verdict"}}, {{"status", "Status"}}};
  Headings placed;
  if (!fleet.models.empty()) placed.emplace_back("model", "Rig model");
  if (fleet.with_site > 0) placed.emplace_back("site", "Site");
  if (!placed.empty()) columns.push_back(placed);
  columns.push_back({{"calibrated", "Calibrated"}, {"due", "Due"}});
  Headings visited = {{"session", "Last session"}};
  if (fleet.with_operator > 0) visited.emplace_back("operator", "Operator");
  columns.push_back(visited);
  columns.push_back({{"worst", "Worst edge"}});
  columns.push_back({{"revision", "Revision"}, {"sessions", "Sessions"}, {"edges", "Edges"}});
  return columns;
}

void FillStatusChoices(Dictionary& list, const FleetQuery& query) {
  const auto add = [&](const std::string& value, const std::string& name) {
    Dictionary* choice = list.AddSectionDictionary("STATUS_CHOICE");
    choice->SetValue("VALUE", value);
    choice->SetValue("NAME", name);
    if (query.status == value) choice->ShowSection("CHOSEN");
  };
  add("", "all");
  add(kStatusWithWork, "all but ok");
  for (const StatusWord word : kStatusWords) add(NameOf(word), NameOf(word));
}

void FillForm(Dictionary& list, const FleetQuery& query) {
  list.SetValue("SEARCH", query.search);
  list.SetValue("SORT", query.sort);
  list.SetValue("ORDER", query.descending ? "down" : "");
  if (!query.cause.empty()) ShowValue(list, "FORM_CAUSE", "KEY", query.cause);
  for (const auto& [value, name] : kChoices) {
    Dictionary* choice = list.AddSectionDictionary("CHOICE");
    choice->SetValue("VALUE", value);
    choice->SetValue("NAME", name);
    if (query.verdict == value) choice->ShowSection("CHOSEN");
  }
  FillStatusChoices(list, query);
  if (!query.site.empty()) ShowValue(list, "FORM_SITE", "PLACE", query.site);
  if (!query.model.empty()) ShowValue(list, "FORM_MODEL", "NAME", query.model);
}

// The address of another view of the same fleet: SEARCH, VERDICT, SORT, ORDER, PAGE, and CAUSE with its KEY, likewise
// the others.
void FillAddress(Dictionary& link, const FleetQuery& query) {
  link.SetValue("SEARCH", InAddress(query.search));
  link.SetValue("VERDICT", InAddress(query.verdict));
  link.SetValue("SORT", InAddress(query.sort));
  link.SetValue("ORDER", query.descending ? "down" : "");
  link.SetValue("PAGE", std::to_string(query.page));
  if (!query.cause.empty()) ShowValue(link, "CAUSE", "KEY", InAddress(query.cause));
  if (!query.status.empty()) ShowValue(link, "ONLY_STATUS", "WORD", InAddress(query.status));
  if (!query.site.empty()) ShowValue(link, "ONLY_SITE", "PLACE", InAddress(query.site));
  if (!query.model.empty()) ShowValue(link, "ONLY_MODEL", "NAME", InAddress(query.model));
}

// One of the ways in which what is shown is not all: which, and the way back, to `without`.
void FillOnly(Dictionary& list, const std::string& text, const char* back, FleetQuery without) {
  Dictionary* only = list.AddSectionDictionary("ONLY");
  only->SetValue("TEXT", text);
  only->SetValue("BACK", back);
  without.page = 1;
  FillAddress(*only, without);
}

void FillAllOnly(Dictionary& list, const FleetQuery& query) {
  const auto without = [&](std::string FleetQuery::*part) {
    FleetQuery other = query;
    (other.*part).clear();
    return other;
  };
  if (!query.cause.empty()) FillOnly(list, CauseText(query.cause), "all causes", without(&FleetQuery::cause));
  if (!query.model.empty()) FillOnly(list, "Rig model " + query.model, "all rig models", without(&FleetQuery::model));
  if (!query.site.empty()) FillOnly(list, "Site " + query.site, "all sites", without(&FleetQuery::site));
}

// Its headings lead to the list that is sorted by them; the one that is chosen turns it.
void FillSortLink(Dictionary& column, const FleetQuery& query, const std::string& sort, const char* name) {
  const bool chosen = query.sort == sort;
  FleetQuery next = query;
  next.sort = sort;
  next.page = 1;
  next.descending = chosen && !query.descending;
  Dictionary* heading = column.AddSectionDictionary("HEADING");
  FillAddress(*heading, next);
  heading->SetValue("NAME", name);
  if (chosen) heading->ShowSection("CHOSEN");
  if (chosen) ShowValue(column, "SORTED", "DIRECTION", query.descending ? "descending" : "ascending");
  heading->SetValue("ARROW", !chosen ? "\xE2\x86\x95" : query.descending ? "\xE2\x86\x93" : "\xE2\x86\x91");
}

void FillColumns(Dictionary& list, const FleetQuery& query, const FleetCounts& fleet) {
  for (const Headings& headings : ColumnsOf(fleet)) {
    Dictionary* column = list.AddSectionDictionary("COLUMN");
    for (const auto& [sort, name] : headings) FillSortLink(*column, query, sort, name);
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

// What waits for the centre, and why; empty: nothing does.
std::string ForwardText(const ForwardState& state) {
  const std::int64_t waiting = state.sessions_waiting + state.batches_waiting;
  if (waiting == 0) return "";
  std::string text = "Not at the centre " + state.url +
                     " yet: " + Count(static_cast<std::size_t>(state.sessions_waiting), "session", "sessions") +
                     " and " +
                     Count(static_cast<std::size_t>(state.batches_waiting), "batch of edges", "batches of edges");
  if (state.oldest_at) text += ", the oldest since " + TimeText(*state.oldest_at);
  if (state.failing_since)
    return text + ". Nothing can be sent since " + TimeText(*state.failing_since) + ": " + state.last_error;
  if (state.refused > 0) return text + ". " + std::to_string(state.refused) + " of them refused: " + state.last_error;
  return text + ".";
}

}  // namespace

Result<std::string> RenderFleet(const FleetCounts& fleet, const FleetPage& list, Stamp now, const FleetQuery& query,
                                std::size_t experiments, std::size_t boards) {
  return RenderSiteFleet(fleet, list, now, query, experiments, boards, {});
}

Result<std::string> RenderSiteFleet(const FleetCounts& fleet, const FleetPage& list, Stamp now, const FleetQuery& query,
                                    std::size_t experiments, std::size_t boards, const ForwardState& forward) {
  Dictionary page("fleet");
  FillHead(page, "Fleet", "");
  const std::string not_at_centre = ForwardText(forward);
  if (!not_at_centre.empty()) ShowValue(page, "CENTRE", "TEXT", not_at_centre);
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
  FillColumns(*robots, query, fleet);
  FillAllOnly(*robots, query);
  FillPager(*robots, query, fleet, list);
  Dictionary* downloads = robots->AddSectionDictionary("CSV");
  FillAddress(*downloads, query);
  if (!query.site.empty()) ShowValue(*downloads, "CALENDAR_SITE", "PLACE", InAddress(query.site));
  const bool has_places = !fleet.models.empty() || fleet.with_site > 0;
  for (const RobotSummary& row : list.rows) FillFleetRow(*robots->AddSectionDictionary("ROW"), row, now, has_places);
  const auto is_drawn = [](const RobotSummary& row) { return row.calibrations.size() > 1; };
  if (std::any_of(list.rows.begin(), list.rows.end(), is_drawn)) robots->ShowSection("DRAWN");
  return Expand("fleet.tpl", page);
}

}  // namespace rigcal::report
