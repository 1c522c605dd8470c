#include "storage/sessions/session_estimates.h"

#include "server/formats/revision/session_estimate.h"
#include "storage/database/query.h"
#include "storage/revisions/rejections_sql.h"
#include "storage/sessions/counting_sessions_sql.h"

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

std::string EstimatorNamed(const std::string& estimator, const std::string& sizes) {
  return sizes.empty() ? estimator : estimator + " " + sizes;
}

Result<bool> HasSessionEstimate(Store& store, const SessionId& session, const std::string& estimator) {
  return Load<bool>(store, "estimate of session " + session.str(), [&]() -> Result<bool> {
    return Query(store,
                 "SELECT 1 FROM session JOIN session_estimate e ON e.session_number = session.number WHERE "
                 "session.session_id = ? "
                 "AND e.estimator = ?")
        .Bind(session, estimator)
        .Step();
  });
}

namespace {

// Of a candidate `d`: somebody rolled the robot back behind it since it, or a copy of it, was approved last, and nobody
// has put to use again what was there before that.
const std::string kRolledBackBehind =
    "EXISTS (SELECT 1 FROM decision b WHERE b.robot_id = d.robot_id AND b.how = 'rolled_back' "
    "AND b.revision_number < d.revision_number AND b.number > (" +
    ApprovalsOf("max(t.number)", "d") +
    ") AND NOT EXISTS (SELECT 1 FROM decision u JOIN revision v "
    "ON v.robot_id = u.robot_id AND v.number = u.revision_number WHERE u.robot_id = b.robot_id AND u.number > b.number "
    "AND u.how <> 'rejected' AND u.revision_number > d.revision_number AND v.created_ns <= b.at_ns))";

// Of a closed session, joined: `i` and `f` are what the newest re-computation in effect, or of run ?1, said of it, if
// any did.
const std::string kClosedWithBasis =
    "FROM session JOIN session_closed ON session_closed.session_number = session.number "
    "LEFT JOIN recomputation_session i ON i.number = (SELECT j.number FROM recomputation_session j "
    "JOIN recomputed_session g ON g.item_number = j.number JOIN recomputation_robot r ON r.number = j.robot_number "
    "LEFT JOIN recomputed_robot d ON d.robot_number = r.number WHERE j.session_number = session.number AND g.how <> "
    "'failed' "
    "AND (r.run_number = ?1 OR d.how = 'unchanged' OR (EXISTS (" +
    ApprovalsOf("1", "d") + " AND " + NotRejectedSince("t") + ") AND NOT " + kRolledBackBehind +
    ")) "
    "ORDER BY j.number DESC LIMIT 1) "
    "LEFT JOIN recomputed_session f ON f.item_number = i.number ";

// Sessions of one time by their ids: which came first changes nothing.
const std::string kNewestOfRobot = "WHERE session.robot_id = ?2 AND " + SessionCounts() +
                                   " ORDER BY session.captured_ns DESC, session.session_id DESC LIMIT ?3";

// By `?4`, with the sizes in effect, or as it was kept.
const std::string kMadeBy =
    "coalesce(f.kept_estimator, ?4 || CASE WHEN coalesce(i.sizes, '') = '' THEN '' ELSE ' ' || i.sizes END)";

Result<SessionEstimate> ReadEstimate(const std::string& document, const std::string& made_by) {
  RIGCAL_ASSIGN(SessionEstimate estimate, formats::ReadSessionEstimate(document));
  estimate.made_by = made_by;
  return estimate;
}

}  // namespace

Result<std::vector<SessionBasis>> LoadSessionBases(Store& store, const RobotId& robot, int sessions_max) {
  using Bases = std::vector<SessionBasis>;
  return Load<Bases>(store, "sessions of robot " + robot.str(), [&]() -> Result<Bases> {
    Query query(store, "SELECT session.session_id, coalesce(i.sizes, '') " + kClosedWithBasis + kNewestOfRobot);
    query.Bind(0, robot, sessions_max);
    Bases bases;
    while (query.Step()) bases.push_back({query.IdAt<SessionId>(0), query.Text(1)});
    return bases;
  });
}

Result<std::vector<SessionEstimateRow>> LoadSessionEstimates(Store& store, const RobotId& robot,
                                                             const std::string& estimator, int sessions_max,
                                                             std::int64_t run) {
  using Rows = std::vector<SessionEstimateRow>;
  return Load<Rows>(store, "session estimates of robot " + robot.str(), [&]() -> Result<Rows> {
    Query query(store, "SELECT session.session_id, e.document, coalesce(i.sizes, ''), e.estimator " + kClosedWithBasis +
                           "LEFT JOIN session_estimate e ON e.session_number = session.number AND e.estimator = " +
                           kMadeBy + " " + kNewestOfRobot);
    query.Bind(run, robot, sessions_max, estimator);
    Rows rows;
    while (query.Step()) {
      rows.push_back({query.IdAt<SessionId>(0), std::nullopt, query.Text(2)});
      if (query.IsNull(1)) continue;
      RIGCAL_ASSIGN(rows.back().estimate, ReadEstimate(query.Text(1), query.Text(3)));
    }
    return rows;
  });
}

Result<std::vector<SessionEstimate>> LoadSessionEstimatesSince(Store& store, const RobotId& robot,
                                                               const std::string& estimator, std::int64_t standing) {
  using Estimates = std::vector<SessionEstimate>;
  return Load<Estimates>(store, "newer session estimates of robot " + robot.str(), [&]() -> Result<Estimates> {
    Query query(store,
                "SELECT e.document, e.estimator " + kClosedWithBasis +
                    "JOIN session_estimate e ON e.session_number = session.number AND e.estimator = "
                    "coalesce((SELECT o.estimator FROM session_estimate o WHERE o.session_number = session.number "
                    "AND o.estimator = " +
                    kMadeBy +
                    "), (SELECT l.estimator FROM session_estimate l WHERE l.session_number = session.number "
                    "ORDER BY l.made_ns DESC, l.estimator DESC LIMIT 1)) "
                    "WHERE session.number IN (SELECT n.session_number FROM standing n WHERE n.robot_id = ?2 "
                    "AND n.number > ?3 AND n.how <> 'retired') AND " +
                    SessionCounts() + " ORDER BY session.number");
    query.Bind(0, robot, standing, estimator);
    Estimates estimates;
    while (query.Step()) {
      RIGCAL_ASSIGN(SessionEstimate estimate, ReadEstimate(query.Text(0), query.Text(1)));
      estimates.push_back(std::move(estimate));
    }
    return estimates;
  });
}

Result<std::optional<SessionEstimate>> LoadSessionEstimate(Store& store, const SessionId& session,
                                                           const std::string& estimator) {
  using Found = std::optional<SessionEstimate>;
  return Load<Found>(store, "estimate of session " + session.str(), [&]() -> Result<Found> {
    Query query(store,
                "SELECT e.document FROM session JOIN session_estimate e ON e.session_number = session.number "
                "WHERE session.session_id = ? AND e.estimator = ?");
    if (!query.Bind(session, estimator).Step()) return Found();
    RIGCAL_ASSIGN(SessionEstimate estimate, formats::ReadSessionEstimate(query.Text(0)));
    estimate.made_by = estimator;
    return Found(std::move(estimate));
  });
}

}  // namespace rigcal::storage
