#include "storage/sessions/session_estimates.h"

#include "server/formats/revision/session_estimate.h"
#include "storage/database/query.h"

namespace rigcal::storage {

Status AppendSessionEstimate(Store& store, const SessionEstimate& estimate, const std::string& estimator, Stamp now) {
  return store.connection().Append("estimate of session " + estimate.session.str(), [&]() -> Status {
    const std::string document = formats::WriteSessionEstimate(estimate);
    RIGCAL_TRY(formats::ReadSessionEstimate(document));  // no number that is none, no name that is empty
    Query(store,
          "INSERT INTO session_estimate (session_number, estimator, made_ns, document) "
          "SELECT number, ?, ?, ? FROM session WHERE session_id = ? ON CONFLICT DO NOTHING")
        .Bind(estimator, now, document, estimate.session)
        .Run();
    return {};
  });
}

Result<std::vector<SessionEstimateRow>> LoadSessionEstimates(Store& store, const RobotId& robot,
                                                             const std::string& estimator, int sessions_max) {
  using Rows = std::vector<SessionEstimateRow>;
  return Load<Rows>(store, "session estimates of robot " + robot.str(), [&]() -> Result<Rows> {
    Query query(store,
                "SELECT session.session_id, session_estimate.document FROM session "
                "JOIN session_closed ON session_closed.session_number = session.number "
                "LEFT JOIN session_estimate ON session_estimate.session_number = session.number "
                "AND session_estimate.estimator = ? WHERE session.robot_id = ? "
                "ORDER BY session.captured_ns DESC, session.number DESC LIMIT ?");
    query.Bind(estimator, robot, sessions_max);
    Rows rows;
    while (query.Step()) {
      rows.push_back({query.IdAt<SessionId>(0), std::nullopt});
      if (query.IsNull(1)) continue;
      RIGCAL_ASSIGN(rows.back().estimate, formats::ReadSessionEstimate(query.Text(1)));
    }
    return rows;
  });
}

}  // namespace rigcal::storage
