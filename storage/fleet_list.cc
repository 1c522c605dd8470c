#include "storage/fleet_list.h"

#include <algorithm>

#include "server/formats/json_writer.h"
#include "storage/summary_row.h"
#include "storage/summary_text.h"

namespace rigcal::storage {
namespace {

// ?1: what is valid until before that is overdue; ?2: the choice; ?3: a session before is long ago; ?4: sigmas from
// which an edge is off; ?5, ?6: the first word and the others.
const std::string kIsOverdue = "(revision_number > 0 AND (calibrated_ns IS NULL OR calibrated_ns + max_age_ns < ?1))";
const std::string kIsLike =
    "CASE ?2 WHEN '' THEN 1 WHEN 'overdue' THEN " + kIsOverdue +
    " WHEN 'off' THEN worst_ratio >= ?4 WHEN 'quiet' THEN last_session_ns IS NULL OR last_session_ns < ?3 "
    "ELSE verdict = ?2 END";
constexpr const char* kHasWords =
    " AND instr(search, ?5) > 0 AND (?6 = '' OR NOT EXISTS "
    "(SELECT 1 FROM json_each(?6, '$.words') AS word WHERE instr(search, word.value) = 0))";

// What is overdue may be relied on no more than a warning allows: it goes before those.
const std::string kUrgency = "CASE verdict WHEN 'fail' THEN 1 - " + kIsOverdue + " WHEN 'unknown' THEN 3 - " + kIsOverdue +
                             " WHEN 'warn' THEN 6 - 2 * " + kIsOverdue + " ELSE 7 - 2 * " + kIsOverdue + " END";

// A number to sort by, the smallest first.
std::string SortKeyOf(const std::string& sort) {
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

  std::vector<std::int64_t> NumbersOf(std::size_t page) {
    Query query(store_, "SELECT number " + From() + OrderOf(asked_) + " LIMIT " + std::to_string(kFleetRowsMax) + " OFFSET ?");
    Bind(query);
    query.Bind((page - 1) * kFleetRowsMax);
    std::vector<std::int64_t> numbers;
    while (query.Step()) numbers.push_back(query.Int(0));
    return numbers;
  }

 private:
  [[nodiscard]] std::string From() const {
    return "FROM summary_robot WHERE " + kIsLike + (words_.empty() ? "" : kHasWords);
  }
  void Bind(Query& query) const {
    query.Bind(now_, asked_.verdict, now_.ns - kQuiet_ns, kOff_sigmas);
    if (!words_.empty()) query.Bind(words_.front(), OtherWords(words_));
  }

  Store& store_;
  const FleetQuery& asked_;
  Stamp now_;
  std::vector<std::string> words_;
};

}  // namespace

Result<FleetCounts> CountFleet(Store& store, Stamp now) {
  return Load<FleetCounts>(store, "counts of all robots", [&]() -> Result<FleetCounts> {
    Query query(store, "SELECT count(*), count(*) FILTER (WHERE " + kIsOverdue +
                           "), coalesce(sum(sessions), 0), coalesce(sum(edges), 0), coalesce(sum(jobs_waiting), 0), "
                           "count(*) FILTER (WHERE verdict = 'fail'), count(*) FILTER (WHERE verdict = 'unknown'), "
                           "count(*) FILTER (WHERE verdict = 'warn'), count(*) FILTER (WHERE verdict = 'pass') "
                           "FROM summary_robot");
    FleetCounts counts;
    if (!query.Bind(now).Step()) return counts;
    counts.robots = query.Int(0);
    counts.overdue = query.Int(1);
    counts.sessions = query.Int(2);
    counts.edges = query.Int(3);
    counts.jobs_waiting = query.Int(4);
    counts.verdicts = {{VerdictLevel::kFail, query.Int(5)},
                       {VerdictLevel::kUnknown, query.Int(6)},
                       {VerdictLevel::kWarn, query.Int(7)},
                       {VerdictLevel::kPass, query.Int(8)}};
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
    for (const std::int64_t number : matches.NumbersOf(page.page)) {
      Query query(store, std::string("SELECT ") + kSummaryColumns + " FROM summary_robot WHERE number = ?");
      if (query.Bind(number).Step()) page.rows.push_back(SummaryOf(query, now));
    }
    return page;
  });
}

Result<FleetSize> LoadFleetSize(Store& store) {
  return Load<FleetSize>(store, "size of the fleet", [&]() -> Result<FleetSize> {
    Query query(store,
                "SELECT robots, sessions, edges, (SELECT count(*) FROM waiting_revision) + "
                "(SELECT count(*) FROM waiting_verdict) + (SELECT count(*) FROM waiting_publication) "
                "FROM summary_fleet WHERE only_row = 1");
    if (!query.Step()) return FleetSize{};
    return FleetSize{query.Int(0), query.Int(1), query.Int(2), query.Int(3)};
  });
}

}  // namespace rigcal::storage
