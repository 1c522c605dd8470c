#include "storage/revisions/rejections_sql.h"

namespace rigcal::storage {

std::string DecidedUntil(const std::string& until, const std::string& other) {
  return until.empty() ? "" : " AND " + other + ".at_ns <= " + until;
}

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
  const std::string digest = "(SELECT digest FROM revision u WHERE u.robot_id = " + decision +
                             ".robot_id AND u.number = " + decision + ".revision_number)";
  return "NOT EXISTS (" + RejectionsOf("1", decision + ".robot_id", digest, until) + " AND r.number > " + decision +
         ".number)";
}

}  // namespace rigcal::storage
