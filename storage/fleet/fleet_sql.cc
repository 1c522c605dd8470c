#include "storage/fleet/fleet_sql.h"

#include "server/formats/json/json_writer.h"
#include "storage/fleet/robot_status.h"

namespace rigcal::storage {
namespace {

std::string HasStatusSql() {
  return "(?8 = '' OR CASE ?8 WHEN '" + std::string(kStatusWithWork) + "' THEN " + HasWorkSql() + " ELSE " +
         StatusSql() + " = ?8 END)";
}

// ?4: the choice; ?5: a session before is long ago; ?6: sigmas from which an edge is off; ?7: the cause; ?8: the
// status; ?9: the site; ?10: the rig model; ?11, ?12: the first word and the others.
std::string IsLikeSql() {
  return "CASE ?4 WHEN '' THEN true WHEN 'not_calibrated' THEN " + kIsNotCalibrated + " WHEN 'overdue' THEN " +
         kIsOverdue + " WHEN 'this_week' THEN " + kIsDueThisWeek + " WHEN 'next_week' THEN " + kIsDueNextWeek +
         " WHEN 'later' THEN " + kIsDueLater +
         " WHEN 'off' THEN worst_ratio >= ?6 WHEN 'quiet' THEN last_session_ns IS NULL OR last_session_ns < ?5 "
         "ELSE ?4 IN (verdict, " +
         DriveKindSql() +
         ") END AND "
         "(?7 = '' OR number IN (SELECT robot_number FROM summary_cause WHERE cause_key = ?7)) AND " +
         HasStatusSql() + " AND (?9 = '' OR site = ?9) AND (?10 = '' OR rig_model = ?10)";
}

// "overdue" stands in a row, but comes with the time.
std::string HasWord(const std::string& word) {
  return "(instr(search, " + word + ") > 0 OR (" + word + " = 'overdue' AND " + kIsOverdue + "))";
}
std::string HasWordsSql() {
  return " AND " + HasWord("?11") +
         " AND (?12 = '' OR NOT EXISTS (SELECT 1 FROM json_each(?12, '$.words') AS word WHERE NOT " +
         HasWord("word.value") + "))";
}

std::string OtherWords(const std::vector<std::string>& words) {
  if (words.size() < 2) return "";
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.List("words", [&] {
      for (std::size_t i = 1; i < words.size(); ++i) out.Text(words[i]);
    });
  });
}

// What is overdue, or has a revision that counts nothing, is relied on no more: it goes before warnings. Of what passes
// that goes first which is due by the end of next week.
const std::string kUrgency =
    "CASE WHEN " + kIsOverdue +
    " OR (revision_number > 0 AND calibrated_ns IS NULL) THEN CASE verdict WHEN 'fail' THEN 0 WHEN 'unknown' THEN 2 "
    "WHEN 'warn' THEN 4 ELSE 5 END ELSE "
    "CASE WHEN verdict = 'fail' THEN 1 WHEN verdict = 'unknown' THEN 3 WHEN verdict = 'warn' THEN 6 "
    "WHEN " +
    kDue_ns + " < ?3 THEN 7 ELSE 8 END END";

// What is worst comes first.
std::string StatusRankSql() {
  return "instr(' failed out-of-tolerance unknown overdue not-applied drifted to-approve due ok', ' ' || " +
         StatusSql() + ")";
}

// A number to sort by, the smallest first.
std::string SortKeyOf(const std::string& sort) {
  if (sort == "status") return StatusRankSql();
  if (sort == "calibrated") return "coalesce(calibrated_ns, 0)";
  if (sort == "session") return "coalesce(last_session_ns, 0)";
  // A thousandth of sigma tells edges apart; beyond 1e12 sigma all are alike.
  if (sort == "worst") return "coalesce(-CAST(round(min(worst_ratio, 1e12) * 1e3) AS BIGINT), 1)";
  if (sort == "revision") return "-revision_number";
  if (sort == "sessions") return "-sessions";
  if (sort == "edges") return "-edges";
  return kUrgency;
}

// Those of which it is not known come last either way; upper case is sorted as lower case.
std::string NamesOrder(const std::string& column, const std::string& direction) {
  return column + " = '', lower(" + column + ")" + direction;
}

// Without the order of equal ones.
std::string FirstOrder(const std::string& sort, const std::string& direction) {
  if (sort == "model") return NamesOrder("rig_model", direction);
  if (sort == "site") return NamesOrder("site", direction);
  if (sort == "operator") return NamesOrder("operator_name", direction);
  if (sort == "due") return kDue_ns + " IS NULL, " + kDue_ns + direction;
  return SortKeyOf(sort) + direction;
}

}  // namespace

std::string DriveKindSql() {
  return "(CASE WHEN verdict = 'fail' THEN 'do_not_drive' WHEN runs_trouble <> '' THEN 'not_applied' WHEN verdict = "
         "'unknown' "
         "THEN 'not_verified' WHEN " +
         kIsNotInUse + " THEN 'to_approve' WHEN " + kIsNotCalibrated + " OR " + kIsOverdue +
         " THEN 'not_verified' WHEN verdict = 'warn' THEN 'ok_with_action' ELSE 'ok' END)";
}

void BindDue(Query& query, Stamp now) {
  const std::int64_t this_week_ns = NextMonday(now).ns;
  query.Bind(now.ns, this_week_ns, this_week_ns + kWeek_ns);
}

std::string MatchesSql(const std::vector<std::string>& words) {
  return "FROM summary_robot WHERE " + IsLikeSql() + (words.empty() ? "" : HasWordsSql());
}

void BindMatches(Query& query, const FleetQuery& asked, const std::vector<std::string>& words, Stamp now) {
  BindDue(query, now);
  query.Bind(asked.verdict, now.ns - kQuiet_ns, kOff_sigmas, asked.cause, asked.status, asked.site, asked.model);
  if (!words.empty()) query.Bind(words.front(), OtherWords(words));
}

// Only a list by name is turned; elsewhere equal ones keep one order.
std::string OrderSql(const FleetQuery& asked) {
  const std::string direction = asked.descending ? " DESC" : "";
  if (asked.sort == "robot") return " ORDER BY name_key" + direction;
  return " ORDER BY " + FirstOrder(asked.sort, direction) + ", name_key";
}

}  // namespace rigcal::storage
