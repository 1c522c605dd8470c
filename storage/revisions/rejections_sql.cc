#include "storage/revisions/rejections_sql.h"

namespace rigcal::storage {

std::string DecidedUntil(const std::string& until, const std::string& other) {
  return until.empty() ? "" : " AND " + other + ".at_ns <= " + until;
}

namespace {

// Of what a decision or candidate by this name is about.
std::string DigestOfNamed(const std::string& named) {
  return "(SELECT digest FROM revision u WHERE u.robot_id = " + named + ".robot_id AND u.number = " + named +
         ".revision_number)";
}

}  // namespace

std::string RejectionsOf(const std::string& columns, const std::string& robot, const std::string& digest,
                         const std::string& until) {
  return "SELECT " + columns +
         " FROM decision r CROSS JOIN revision v ON v.robot_id = r.robot_id AND v.number = r.revision_number WHERE "
         "r.robot_id = " +
         robot + " AND r.how <> 'approved' AND r.how = 'rejected' AND v.digest = " + digest + DecidedUntil(until, "r") +
         " AND NOT EXISTS (SELECT 1 FROM decision later WHERE later.robot_id = r.robot_id AND later.revision_number = "
         "r.revision_number AND later.number > r.number" +
         DecidedUntil(until, "later") + ")";
}

std::string NotRejectedSince(const std::string& decision, const std::string& until) {
  return "NOT EXISTS (" + RejectionsOf("1", decision + ".robot_id", DigestOfNamed(decision), until) +
         " AND r.number > " + decision + ".number)";
}

std::string ApprovalsOf(const std::string& columns, const std::string& candidate) {
  return "SELECT " + columns +
         " FROM decision t CROSS JOIN revision w ON w.robot_id = t.robot_id AND w.number = t.revision_number WHERE "
         "t.robot_id = " +
         candidate + ".robot_id AND t.revision_number >= " + candidate +
         ".revision_number AND t.how <> 'rejected' AND w.digest = " + DigestOfNamed(candidate);
}

}  // namespace rigcal::storage
