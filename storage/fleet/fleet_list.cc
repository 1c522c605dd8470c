#include "storage/fleet/fleet_list.h"

#include <algorithm>

#include "server/formats/json/json_writer.h"
#include "storage/fleet/robot_status.h"
#include "storage/fleet/summary_row.h"
#include "storage/fleet/summary_text.h"

namespace rigcal::storage {
namespace {

// ?1, ?2, ?3: what is valid until before is overdue, or will be this week, or by the end of the next; ?4: the choice;
// ?5: a session before is long ago; ?6: sigmas from which an edge is off; ?7: the cause; ?8: the status; ?9: the
// site; ?10, ?11: the first word and the others.
const std::string kIsOverdue = "(revision_number > 0 AND (calibrated_ns IS NULL OR calibrated_ns + max_age_ns < ?1))";
const std::string kIsDueThisWeek = "(revision_number > 0 AND calibrated_ns + max_age_ns >= ?1 AND calibrated_ns + max_age_ns < ?2)";
const std::string kIsDueNextWeek = "(revision_number > 0 AND calibrated_ns + max_age_ns >= ?2 AND calibrated_ns + max_age_ns < ?3)";
const std::string kIsDueLater = "(revision_number > 0 AND calibrated_ns + max_age_ns >= ?3)";
// As DriveRuleOf (model/robots/drive_rule.h) has it of the newest revision.
const std::string kDriveKind =
    "(CASE WHEN verdict = 'fail' THEN 'do_not_drive' WHEN runs_trouble <> '' THEN 'not_applied' WHEN verdict = 'unknown' "
    "THEN 'not_verified' WHEN revision_number > 0 AND coalesce(usable_number, 0) <> revision_number THEN 'to_approve' WHEN " +
    kIsOverdue + " THEN 'not_verified' WHEN verdict = 'warn' THEN 'ok_with_action' ELSE 'ok' END)";
const std::string kIsLike =
    "CASE ?4 WHEN '' THEN 1 WHEN 'overdue' THEN " + kIsOverdue + " WHEN 'this_week' THEN " + kIsDueThisWeek +
    " WHEN 'next_week' THEN " + kIsDueNextWeek + " WHEN 'later' THEN " + kIsDueLater +
    " WHEN 'off' THEN worst_ratio >= ?6 WHEN 'quiet' THEN last_session_ns IS NULL OR last_session_ns < ?5 "
    "ELSE ?4 IN (verdict, " + kDriveKind + ") END AND "
    "(?7 = '' OR number IN (SELECT robot_number FROM summary_cause WHERE cause_key = ?7)) AND (?8 = '' OR " +
    StatusSql() + " = ?8) AND (?9 = '' OR site = ?9)";

// "overdue" stands in a row, but comes with the time.
std::string HasWord(const std::string& word) {
  return "(instr(search, " + word + ") > 0 OR (" + word + " = 'overdue' AND " + kIsOverdue + "))";
}
const std::string kHasWords = " AND " + HasWord("?10") +
                              " AND (?11 = '' OR NOT EXISTS (SELECT 1 FROM json_each(?11, '$.words') AS word WHERE NOT " +
                              HasWord("word.value") + "))";

// What is overdue is relied on no more: it goes before warnings. Of what passes that goes first
// which is due by the end of next week.
const std::string kUrgency = "CASE verdict WHEN 'fail' THEN 1 - " + kIsOverdue + " WHEN 'unknown' THEN 3 - " +
                             kIsOverdue + " WHEN 'warn' THEN 6 - 2 * " + kIsOverdue + " ELSE CASE WHEN " + kIsOverdue +
                             " THEN 5 WHEN calibrated_ns + max_age_ns < ?3 THEN 7 ELSE 8 END END";

void BindDue(Query& query, Stamp now) {
  const std::int64_t this_week_ns = NextMonday(now).ns;
  query.Bind(now.ns, this_week_ns, this_week_ns + kWeek_ns);
}

// What is worst comes first.
std::string StatusRankSql() {
  return "instr(' failed out-of-tolerance unknown overdue drifted due ok', ' ' || " + StatusSql() + ")";
}

// A number to sort by, the smallest first.
std::string SortKeyOf(const std::string& sort) {
  if (sort == "status") return StatusRankSql();
  if (sort == "calibrated") return "coalesce(calibrated_ns, 0)";
  if (sort == "session") return "coalesce(last_session_ns, 0)";
  // A thousandth of sigma tells edges apart; beyond 1e12 sigma all are alike.
  if (sort == "worst") return "coalesce(-CAST(round(min(worst_ratio, 1e12) * 1e3) AS INTEGER), 1)";
  if (sort == "revision") return "-revision_number";
  if (sort == "sessions") return "-sessions";
  if (sort == "edges") return "-edges";
  return kUrgency;
}

// Only a list by name is turned; elsewhere equal ones keep one order.
std::string OrderOf(const FleetQuery& asked) {
  const std::string direction = asked.descending ? " DESC" : "";
  if (asked.sort == "robot") return " ORDER BY name_key" + direction;
  return " ORDER BY " + SortKeyOf(asked.sort) + direction + ", name_key";
}

std::string OtherWords(const std::vector<std::string>& words) {
  if (words.size() < 2) return "";
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.List("words", [&] {
      for (std::size_t i = 1; i < words.size(); ++i) out.Text(words[i]);
    });
  });
}

// The robots that are asked for.
class Matches {
 public:
  Matches(Store& store, const FleetQuery& asked, Stamp now)
      : store_(store), asked_(asked), now_(now), words_(SearchWordsOf(asked.search)) {}

  std::size_t Count() {
    Query query(store_, "SELECT count(*) " + From());
    Bind(query);
    return query.Step() ? static_cast<std::size_t>(query.Int(0)) : 0;
  }

  std::vector<std::int64_t> Numbers(std::int64_t max, std::size_t skipped) {
    Query query(store_, "SELECT number " + From() + OrderOf(asked_) + " LIMIT ? OFFSET ?");
    Bind(query);
    query.Bind(max, skipped);
    std::vector<std::int64_t> numbers;
    while (query.Step()) numbers.push_back(query.Int(0));
    return numbers;
  }

 private:
  [[nodiscard]] std::string From() const {
    return "FROM summary_robot WHERE " + kIsLike + (words_.empty() ? "" : kHasWords);
  }
  void Bind(Query& query) const {
    BindDue(query, now_);
    query.Bind(asked_.verdict, now_.ns - kQuiet_ns, kOff_sigmas, asked_.cause, asked_.status, asked_.site);
    if (!words_.empty()) query.Bind(words_.front(), OtherWords(words_));
  }

  Store& store_;
  const FleetQuery& asked_;
  Stamp now_;
  std::vector<std::string> words_;
};

std::optional<RobotSummary> LoadRow(Store& store, std::int64_t number, Stamp now) {
  Query query(store, std::string("SELECT ") + kSummaryColumns + " FROM summary_robot WHERE number = ?");
  return query.Bind(number).Step() ? std::optional(SummaryOf(query, now)) : std::nullopt;
}

std::map<DriveKind, std::int64_t> CountKinds(Store& store, Stamp now) {
  Query query(store, "SELECT " + kDriveKind + " AS kind, count(*) FROM summary_robot GROUP BY kind");
  query.Bind(now);
  std::map<DriveKind, std::int64_t> kinds;
  while (query.Step())
    if (const auto kind = DriveKindOf(query.Text(0))) kinds[*kind] = query.Int(1);
  return kinds;
}

// Each row's status is worked out once.
std::map<StatusWord, std::int64_t> CountStatuses(Store& store, Stamp now) {
  Query query(store, "SELECT " + StatusSql() + " AS word, count(*) FROM summary_robot GROUP BY word");
  query.Bind(now);
  std::map<StatusWord, std::int64_t> statuses;
  for (const StatusWord word : kStatusWords) statuses[word] = 0;
  while (query.Step()) statuses[StatusWordOf(query.Text(0))] = query.Int(1);
  return statuses;
}

}  // namespace

Result<FleetCounts> CountFleet(Store& store, Stamp now) {
  return Load<FleetCounts>(store, "counts of all robots", [&]() -> Result<FleetCounts> {
    Query query(store, "SELECT count(*), count(*) FILTER (WHERE " + kIsOverdue +
                           "), coalesce(sum(sessions), 0), coalesce(sum(edges), 0), coalesce(sum(jobs_waiting), 0), "
                           "count(*) FILTER (WHERE verdict = 'fail'), count(*) FILTER (WHERE verdict = 'unknown'), "
                           "count(*) FILTER (WHERE verdict = 'warn'), count(*) FILTER (WHERE verdict = 'pass'), "
                           "count(*) FILTER (WHERE " +
                           kIsDueThisWeek + "), count(*) FILTER (WHERE " + kIsDueNextWeek +
                           "), count(*) FILTER (WHERE " + kIsDueLater + ") FROM summary_robot");
    FleetCounts counts;
    BindDue(query, now);
    if (!query.Step()) return counts;
    counts.robots = query.Int(0);
    counts.overdue = query.Int(1);
    counts.sessions = query.Int(2);
    counts.edges = query.Int(3);
    counts.jobs_waiting = query.Int(4);
    counts.verdicts = {{VerdictLevel::kFail, query.Int(5)},
                       {VerdictLevel::kUnknown, query.Int(6)},
                       {VerdictLevel::kWarn, query.Int(7)},
                       {VerdictLevel::kPass, query.Int(8)}};
    counts.due_this_week = query.Int(9);
    counts.due_next_week = query.Int(10);
    counts.due_later = query.Int(11);
    counts.kinds = CountKinds(store, now);
    counts.statuses = CountStatuses(store, now);
    RIGCAL_ASSIGN(counts.causes, LoadCauseCounts(store, kCausesListedMax + 1));
    return counts;
  });
}

Result<FleetPage> LoadFleetPage(Store& store, const FleetQuery& asked, Stamp now) {
  return Load<FleetPage>(store, "list of robots", [&]() -> Result<FleetPage> {
    Matches matches(store, asked, now);
    FleetPage page;
    page.matches = matches.Count();
    page.pages = std::max<std::size_t>(1, (page.matches + kFleetRowsMax - 1) / kFleetRowsMax);
    page.page = std::clamp<std::size_t>(asked.page, 1, page.pages);
    for (const std::int64_t number : matches.Numbers(kFleetRowsMax, (page.page - 1) * kFleetRowsMax))
      if (auto row = LoadRow(store, number, now)) page.rows.push_back(std::move(*row));
    return page;
  });
}

Status ForEachRobot(Store& store, const FleetQuery& asked, Stamp now,
                    const std::function<void(const RobotSummary&)>& take) {
  return store.connection().Load("list of robots", [&]() -> Status {
    constexpr std::int64_t kAll = -1;
    for (const std::int64_t number : Matches(store, asked, now).Numbers(kAll, 0))
      if (const auto row = LoadRow(store, number, now)) take(*row);
    return {};
  });
}

Result<std::vector<CauseCount>> LoadCauseCounts(Store& store, std::size_t max) {
  using Counts = std::vector<CauseCount>;
  return Load<Counts>(store, "causes that robots have in common", [&]() -> Result<Counts> {
    Query query(
        store,
        "SELECT cause_key, robots FROM summary_cause_count WHERE robots > 0 ORDER BY robots DESC, cause_key LIMIT ?");
    query.Bind(max);
    Counts counts;
    while (query.Step()) counts.push_back({query.Text(0), query.Int(1)});
    return counts;
  });
}

Result<FleetSize> LoadFleetSize(Store& store) {
  return Load<FleetSize>(store, "size of the fleet", [&]() -> Result<FleetSize> {
    Query query(store,
                "SELECT robots, sessions, edges, (SELECT count(*) FROM waiting_revision) + "
                "(SELECT count(*) FROM waiting_verdict) + (SELECT count(*) FROM waiting_rig_model) + "
                "(SELECT count(*) FROM waiting_publication) "
                "FROM summary_fleet WHERE only_row = 1");
    if (!query.Step()) return FleetSize{};
    return FleetSize{query.Int(0), query.Int(1), query.Int(2), query.Int(3)};
  });
}

}  // namespace rigcal::storage
