#include "storage/sessions/counting_sessions_sql.h"

namespace rigcal::storage {
namespace {

// The newest word by which a session of this number is current.
std::string NewestStanding(const std::string& number) {
  return "(SELECT max(x.number) FROM standing x WHERE x.session_number = " + number + " AND x.how <> 'retired')";
}

// Of a session that repeats it, or that it repeats: that it is the current one of the two.
std::string RepeatedBy(const std::string& own, const std::string& other) {
  return "NOT EXISTS (SELECT 1 FROM session_repeat r WHERE r.robot_id = session.robot_id AND r." + own +
         " = session.number AND " + NewestStanding("r." + other) + " > " + NewestStanding("session.number") + ")";
}

}  // namespace

const std::string& SessionCounts() {
  static const std::string counts =
      RepeatedBy("earlier_number", "later_number") + " AND " + RepeatedBy("later_number", "earlier_number") +
      " AND NOT EXISTS (SELECT 1 FROM standing t WHERE t.session_number = session.number AND t.how = 'retired' "
      "AND NOT EXISTS (SELECT 1 FROM standing later WHERE later.session_number = session.number AND later.number > "
      "t.number AND later.how = 'restored'))";
  return counts;
}

}  // namespace rigcal::storage
