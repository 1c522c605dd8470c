#include "storage/sessions/standing.h"

#include <algorithm>
#include <limits>

#include "server/base/text.h"
#include "storage/audit.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing_row.h"
#include "storage/sites/superseded_there.h"

namespace rigcal::storage {
namespace {

std::string StandingSubject(const std::string& thing) { return "standing of " + thing; }

struct CurrentRow {
  SessionId id;
  Stamp captured_at;
  std::string operator_name;
  Standing standing;
};

// Of each closed session that repeats another or is repeated the newest word by which it was current, by the session's
// row number. That it was retired makes nothing else current.
std::map<std::int64_t, CurrentRow> LoadCurrent(Store& store, const RobotId& robot) {
  const std::string of_robot = robot.empty() ? "" : " WHERE robot_id = ?1";
  Query query(
      store,
      "SELECT s.number, s.session_id, s.captured_ns, s.operator_name, t.number, t.how, t.at_ns, t.who, t.reason "
      "FROM (SELECT earlier_number AS number FROM session_repeat" +
          of_robot + " UNION SELECT later_number FROM session_repeat" + of_robot +
          ") r JOIN session s ON s.number = r.number JOIN standing t ON t.number = "
          "(SELECT max(number) FROM standing x WHERE x.session_number = s.number AND x.how <> 'retired')");
  if (!robot.empty()) query.Bind(robot);
  std::map<std::int64_t, CurrentRow> rows;
  while (query.Step())
    rows[query.Int(0)] = {query.IdAt<SessionId>(1), query.Time(2), query.Text(3), StandingAt(query, 4)};
  return rows;
}

struct Repeat {
  std::int64_t earlier = 0, later = 0;  // row numbers of sessions
};

std::vector<Repeat> LoadRepeats(Store& store, const RobotId& robot) {
  Query query(store, "SELECT earlier_number, later_number FROM session_repeat" +
                         std::string(robot.empty() ? "" : " WHERE robot_id = ?"));
  if (!robot.empty()) query.Bind(robot);
  std::vector<Repeat> repeats;
  while (query.Step()) repeats.push_back({query.Int(0), query.Int(1)});
  return repeats;
}

// Row numbers of those that repeat each other, one by way of another too, with `session` among them.
std::set<std::int64_t> RepeatingWith(const std::vector<Repeat>& repeats, std::int64_t session) {
  std::set<std::int64_t> same = {session};
  for (std::size_t before = 0; before < same.size();) {
    before = same.size();
    for (const Repeat& repeat : repeats)
      if (same.contains(repeat.earlier) || same.contains(repeat.later)) same.insert({repeat.earlier, repeat.later});
  }
  return same;
}

// What supersedes a session where robots pushed it (storage/sites/superseded_there.h), as far as it is known here.
std::vector<Repeat> SupersedingNoted(Store& store, const SessionId& id) {
  Query query(store,
              "SELECT s.number, other.number FROM waiting_superseded w CROSS JOIN session s ON s.session_id = "
              "w.session_id CROSS JOIN session other ON other.session_id = w.by_id WHERE w.session_id = ?");
  query.Bind(id);
  std::vector<Repeat> noted;
  while (query.Step()) noted.push_back({query.Int(0), query.Int(1)});
  return noted;
}

// In the order of their words: as if the session had come just before the first of those that supersede it there.
std::map<std::int64_t, CurrentRow> ToStayCurrent(Store& store, const RobotId& robot, const std::vector<Repeat>& noted) {
  const std::int64_t session = noted.front().earlier;
  const std::set<std::int64_t> same = RepeatingWith(LoadRepeats(store, robot), session);
  std::map<std::int64_t, CurrentRow> by_word;
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (const auto& [number, row] : LoadCurrent(store, robot)) {
    if (number == session || !same.contains(number)) continue;
    by_word.emplace(row.standing.number, row);
    if (std::any_of(noted.begin(), noted.end(), [&, at = number](const Repeat& one) { return one.later == at; }))
      first = std::min(first, row.standing.number);
  }
  by_word.erase(by_word.begin(), by_word.lower_bound(first));
  return by_word;
}

// The number of the word.
std::optional<std::int64_t> InsertCurrent(Store& store, const SessionId& id, const std::string& how, const Word& word) {
  return Query(store,
               "INSERT INTO standing (robot_id, at_ns, how, session_number, who, reason) "
               "SELECT robot_id, ?, ?, number, ?, ? FROM session WHERE session_id = ? RETURNING number")
      .Bind(word.at, how, word.who, word.reason, id)
      .RunForKey();
}

Result<SessionRow> RequiredClosed(Store& store, const SessionId& id) {
  RIGCAL_ASSIGN(const std::optional<SessionRow> row, LoadSession(store, id));
  if (!row) return Fail(ErrorCode::kNotFound, "session " + id.str() + " is not known", "Push the session folder.");
  if (row->closed) return *row;
  return Fail(ErrorCode::kConflict, "session " + id.str() + " did not come whole",
              "Push its folder again: what is here already is not sent twice.");
}

Status CheckPrefix(const std::string& kind, const std::string& prefix) {
  constexpr std::size_t kPrefixMin = 8, kDigestDigits = 64;
  if (prefix.size() >= kPrefixMin && prefix.size() <= kDigestDigits &&
      prefix.find_first_not_of("0123456789abcdef") == std::string::npos)
    return {};
  return Fail(ErrorCode::kInvalidInput, Quoted(prefix) + " is no id of " + kind,
              "Give the id, or at least its first 8 digits (0-9, a-f).");
}

// 'g' comes after every hex digit.
template <typename AnId>
Result<std::vector<AnId>> FindIds(Store& store, const std::string& kind, const std::string& table,
                                  const std::string& prefix, const RobotId& robot) {
  RIGCAL_TRY(CheckPrefix(kind, prefix));
  return Load<std::vector<AnId>>(store, kind + " " + prefix, [&]() -> Result<std::vector<AnId>> {
    const std::string column = table + "_id";
    Query query(store, "SELECT " + column + " FROM " + table + " WHERE " + column + " >= ? AND " + column +
                           " < ? AND (robot_id = ?3 OR ?3 = '') ORDER BY " + column);
    query.Bind(prefix, prefix + "g", robot);
    std::vector<AnId> ids;
    while (query.Step()) ids.push_back(query.IdAt<AnId>(0));
    return ids;
  });
}

}  // namespace

Status CheckWord(const Word& word) {
  constexpr std::size_t kWordBytesMax = 500;
  for (const std::string* text : {&word.who, &word.reason})
    if (text->size() > kWordBytesMax || !IsPrintableUtf8(*text))
      return Fail(ErrorCode::kInvalidInput, Quoted(*text) + " is not one line of readable text",
                  "Use at most " + std::to_string(kWordBytesMax) + " bytes of UTF-8 without control characters.");
  return {};
}

Status AppendPushed(Store& store, const RobotId& robot, const SessionId& id, Stamp now) {
  return store.connection().Append(StandingSubject("session " + id.str()), [&]() -> Status {
    static_cast<void>(InsertCurrent(store, id, "pushed", {now, "robot " + robot.str(), ""}));
    return {};
  });
}

Status KeepSuperseding(Store& store, const RobotId& robot, const SessionId& id, Stamp now) {
  return store.connection().Append(StandingSubject("session " + id.str()), [&]() -> Status {
    const std::vector<Repeat> noted = SupersedingNoted(store, id);
    if (!noted.empty())
      for (const auto& [number, row] : ToStayCurrent(store, robot, noted)) {
        const Word word{now, row.standing.word.who, row.standing.word.reason};
        const AuditedRow kept{AuditedKind::kStanding, InsertCurrent(store, row.id, "pushed_again", word).value()};
        RIGCAL_TRY(AppendAudit(store, now, word.who,
                               "kept session " + row.id.str() + " of robot " + robot.str() + " current: session " +
                                   id.str() + ", which is older at its site, came after it",
                               robot, kept));
      }
    return TakeSupersedingNoted(store, id).map([](bool) {});
  });
}

Result<std::set<SessionId>> LoadMadeCurrentSince(Store& store, const RobotId& robot, std::int64_t standing) {
  using Ids = std::set<SessionId>;
  return Load<Ids>(store, "newer sessions of robot " + robot.str(), [&]() -> Result<Ids> {
    Query query(store,
                "SELECT s.session_id FROM standing t JOIN session s ON s.number = t.session_number "
                "WHERE t.robot_id = ? AND t.number > ? AND t.how <> 'retired'");
    query.Bind(robot, standing);
    Ids ids;
    while (query.Step()) ids.insert(query.IdAt<SessionId>(0));
    return ids;
  });
}

Result<std::map<SessionId, Superseding>> LoadSuperseded(Store& store, const RobotId& robot) {
  std::map<SessionId, Superseding> superseded;
  RIGCAL_TRY(store.connection().Load("sessions of robot " + robot.str(), [&] {
    return store.Read([&]() -> Status {
      const auto current = LoadCurrent(store, robot);
      for (const Repeat& repeat : LoadRepeats(store, robot)) {
        const auto earlier = current.find(repeat.earlier), later = current.find(repeat.later);
        if (earlier == current.end() || later == current.end()) continue;
        const bool later_holds = later->second.standing.number > earlier->second.standing.number;
        const CurrentRow &old = (later_holds ? earlier : later)->second, &by = (later_holds ? later : earlier)->second;
        Superseding& known = superseded[old.id];
        if (by.standing.number > known.standing.number) known = {by.id, by.captured_at, by.operator_name, by.standing};
      }
      return {};
    });
  }));
  return superseded;
}

namespace {

// What a session was that is made current, for the audit; empty: it is current already.
Result<std::string> WhatItWas(Store& store, const SessionRow& row, MadeCurrent how) {
  RIGCAL_ASSIGN(const auto retired, LoadRetiredSessions(store, row.robot));
  if (retired.contains(row.id)) return how == MadeCurrent::kRestored ? std::string(", retired") : std::string();
  RIGCAL_ASSIGN(const auto superseded, LoadSuperseded(store, row.robot));
  const auto found = superseded.find(row.id);
  return found == superseded.end() ? std::string() : ", superseded by session " + found->second.by.str();
}

}  // namespace

Result<bool> MakeCurrent(Store& store, const SessionId& id, MadeCurrent how, const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  return Append<bool>(store, StandingSubject("session " + id.str()), [&]() -> Result<bool> {
    RIGCAL_ASSIGN(const SessionRow row, RequiredClosed(store, id));
    RIGCAL_ASSIGN(const std::string was, WhatItWas(store, row, how));
    if (was.empty()) return false;
    const bool restored = how == MadeCurrent::kRestored;
    const auto number = InsertCurrent(store, id, restored ? "restored" : "pushed_again", word);
    const AuditedRow standing{AuditedKind::kStanding, number.value()};
    RIGCAL_TRY(AppendAudit(store, word.at, word.who,
                           (restored ? "restored session " : "pushed again session ") + id.str() + " of robot " +
                               row.robot.str() + was + Because(word),
                           row.robot, standing));
    return true;
  });
}

Result<std::optional<Standing>> LoadStanding(Store& store, const SessionId& id) {
  const std::string subject = StandingSubject("session " + id.str());
  return Load<std::optional<Standing>>(store, subject, [&]() -> Result<std::optional<Standing>> {
    Query query(store,
                "SELECT t.number, t.how, t.at_ns, t.who, t.reason FROM session s "
                "JOIN standing t ON t.session_number = s.number WHERE s.session_id = ? ORDER BY t.number DESC LIMIT 1");
    if (!query.Bind(id).Step()) return std::nullopt;
    return StandingAt(query, 0);
  });
}

Result<std::int64_t> LoadStandingWatermark(Store& store, const RobotId& robot) {
  return Load<std::int64_t>(store, StandingSubject("robot " + robot.str()), [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT coalesce(max(number), 0) FROM standing WHERE robot_id = ?");
    return query.Bind(robot).Step() ? query.Int(0) : 0;
  });
}

Result<std::vector<SessionId>> FindSessions(Store& store, const std::string& prefix, const RobotId& robot) {
  return FindIds<SessionId>(store, "a session", "session", prefix, robot);
}

Result<std::vector<EdgeId>> FindEdges(Store& store, const std::string& prefix, const RobotId& robot) {
  return FindIds<EdgeId>(store, "an edge", "edge", prefix, robot);
}

}  // namespace rigcal::storage
