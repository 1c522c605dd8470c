#include "storage/sites/superseded_there.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string SupersedingSubject(const SessionId& session) { return "what supersedes session " + session.str(); }

// A session's newest word by which it was current.
std::string NewestWordOf(const std::string& session) {
  return "(SELECT max(t.number) FROM standing t WHERE t.session_number = " + session +
         ".number AND t.how <> 'retired')";
}

Result<bool> IsSupersedingNoted(Store& store, const SessionId& session) {
  return Load<bool>(store, SupersedingSubject(session), [&]() -> Result<bool> {
    return Query(store, "SELECT 1 FROM waiting_superseded WHERE session_id = ? LIMIT 1").Bind(session).Step();
  });
}

int ForgetSuperseding(Store& store, const SessionId& session) {
  return Query(store, "DELETE FROM waiting_superseded WHERE session_id = ?").Bind(session).Run();
}

// Of the two the one that came last here may hold less than half of the other, so that InsertRepeats saw none.
void InsertRepeatsNoted(Store& store, const SessionId& session) {
  Query(store,
        "INSERT INTO session_repeat SELECT old.robot_id, old.number, later.number FROM waiting_superseded w "
        "CROSS JOIN session later ON later.session_id = w.session_id "
        "CROSS JOIN session old ON old.session_id = w.by_id AND old.robot_id = later.robot_id "
        "WHERE w.session_id = ? AND old.number < later.number AND EXISTS (SELECT 1 FROM payload p "
        "CROSS JOIN payload q ON q.digest = p.digest WHERE p.session_number = later.number AND q.session_number = "
        "old.number) ON CONFLICT DO NOTHING")
      .Bind(session)
      .Run();
}

}  // namespace

Result<std::vector<SessionId>> LoadSuperseding(Store& store, const SessionId& session) {
  using Ids = std::vector<SessionId>;
  return Load<Ids>(store, SupersedingSubject(session), [&]() -> Result<Ids> {
    Query query(store,
                "SELECT other.session_id FROM session s CROSS JOIN session_repeat r ON r.robot_id = s.robot_id AND "
                "(r.earlier_number = s.number OR r.later_number = s.number) CROSS JOIN session other ON other.number = "
                "r.earlier_number + r.later_number - s.number WHERE s.session_id = ? AND " +
                    NewestWordOf("other") + " > " + NewestWordOf("s") + " ORDER BY other.number DESC LIMIT " +
                    std::to_string(kSupersedingMax));
    query.Bind(session);
    Ids ids;
    while (query.Step()) ids.push_back(query.IdAt<SessionId>(0));
    return ids;
  });
}

Status NoteSuperseding(Store& store, const SessionId& session, const std::vector<SessionId>& by) {
  RIGCAL_ASSIGN(const bool is_noted, IsSupersedingNoted(store, session));
  if (by.empty() && !is_noted) return {};
  return store.connection().Append(SupersedingSubject(session), [&]() -> Status {
    ForgetSuperseding(store, session);
    for (const SessionId& one : by)
      Query(store, "INSERT INTO waiting_superseded VALUES (?, ?) ON CONFLICT DO NOTHING").Bind(session, one).Run();
    InsertRepeatsNoted(store, session);
    return {};
  });
}

Result<bool> TakeSupersedingNoted(Store& store, const SessionId& session) {
  return Append<bool>(store, SupersedingSubject(session),
                      [&]() -> Result<bool> { return ForgetSuperseding(store, session) > 0; });
}

}  // namespace rigcal::storage
