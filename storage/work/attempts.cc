#include "storage/work/attempts.h"

#include <optional>

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string AttemptSubject(const std::string& work) { return "attempt at " + work; }

std::string EndName(AttemptEnd end) {
  switch (end) {
    case AttemptEnd::kDone:
      return "done";
    case AttemptEnd::kFailed:
      return "failed";
    case AttemptEnd::kGivenBack:
      return "given_back";
    case AttemptEnd::kCutOff:
      return "cut_off";
  }
  return "failed";
}

struct Begun {
  int attempts = 0;
  std::optional<std::int64_t> open_number;
};

std::optional<Begun> BegunOf(Store& store, const std::string& work) {
  Query query(store, "SELECT attempts, open_number FROM waiting_attempt WHERE work = ?");
  if (!query.Bind(work).Step()) return std::nullopt;
  Begun begun{static_cast<int>(query.Int(0)), std::nullopt};
  if (!query.IsNull(1)) begun.open_number = query.Int(1);
  return begun;
}

void InsertEnd(Store& store, std::int64_t number, AttemptEnd end, const std::string& why, Stamp now) {
  Query(store, "INSERT INTO attempt_ended VALUES (?, ?, ?, ?)").Bind(number, now, EndName(end), why).Run();
}

void EndOne(Store& store, const std::string& work, AttemptEnd end, const std::string& why, Stamp now) {
  const auto begun = BegunOf(store, work);
  if (!begun) return;
  if (begun->open_number) InsertEnd(store, *begun->open_number, end, why, now);
  const int counted = begun->attempts - (begun->open_number && end == AttemptEnd::kGivenBack ? 1 : 0);
  if (end == AttemptEnd::kDone || counted == 0)
    Query(store, "DELETE FROM waiting_attempt WHERE work = ?").Bind(work).Run();
  else
    Query(store, "UPDATE waiting_attempt SET attempts = ?, open_number = NULL WHERE work = ?")
        .Bind(counted, work)
        .Run();
}

void BeginOne(Store& store, const std::string& work, Stamp now) {
  const auto begun = BegunOf(store, work);
  if (begun && begun->open_number) InsertEnd(store, *begun->open_number, AttemptEnd::kCutOff, "", now);
  const auto number =
      Query(store, "INSERT INTO attempt (work, started_ns) VALUES (?, ?) RETURNING number").Bind(work, now).RunForKey();
  Query(store,
        "INSERT INTO waiting_attempt VALUES (?, ?, ?) ON CONFLICT (work) DO UPDATE SET attempts = excluded.attempts, "
        "open_number = excluded.open_number")
      .Bind(work, (begun ? begun->attempts : 0) + 1, number)
      .Run();
}

constexpr const char* kKilled = "killed from outside";

int TimesKilled(Store& store, const std::string& work) {
  Query query(store,
              "SELECT count(*) FROM attempt a JOIN attempt_ended e ON e.attempt_number = a.number "
              "WHERE a.work = ? AND e.why = ?");
  return query.Bind(work, std::string(kKilled)).Step() ? static_cast<int>(query.Int(0)) : 0;
}

void EndKilled(Store& store, const std::string& work, Stamp now) {
  const auto begun = BegunOf(store, work);
  if (!begun || !begun->open_number) return;
  if (TimesKilled(store, work) + 1 >= kKillsMax) return EndOne(store, work, AttemptEnd::kCutOff, "", now);
  InsertEnd(store, *begun->open_number, AttemptEnd::kGivenBack, kKilled, now);
  Query(store, "UPDATE waiting_attempt SET attempts = ?, open_number = NULL WHERE work = ?")
      .Bind(begun->attempts - 1, work)
      .Run();
}

std::vector<std::string> OpenWorks(Store& store) {
  Query query(store, "SELECT work FROM waiting_attempt WHERE open_number IS NOT NULL ORDER BY open_number");
  std::vector<std::string> works;
  while (query.Step()) works.push_back(query.Text(0));
  return works;
}

// Of one robot, by what the works are called.
std::vector<std::string> OpenWorks(Store& store, const RobotId& robot) {
  Query query(store,
              "SELECT t.work FROM waiting_attempt t WHERE t.open_number IS NOT NULL AND (t.work IN ("
              "SELECT 'job ' || w.job_number FROM waiting_job w WHERE w.robot_id = ?1 UNION ALL "
              "SELECT 'resolve robot ' || r.number FROM recomputation_robot r WHERE r.robot_id = ?1 UNION ALL "
              "SELECT 'resolve ' || s.item_number FROM recomputation_robot r JOIN waiting_recomputed_session s ON "
              "s.robot_number = r.number "
              "WHERE r.robot_id = ?1) "
              "OR substr(t.work, 1, length(?2)) = ?2 OR substr(t.work, 1, length(?3)) = ?3) ORDER BY t.open_number");
  query.Bind(robot, "report " + robot.str() + " ", "revision " + robot.str() + " ");
  std::vector<std::string> works;
  while (query.Step()) works.push_back(query.Text(0));
  return works;
}

}  // namespace

std::string WorkOfJob(std::int64_t job_number) { return "job " + std::to_string(job_number); }
std::string WorkOfReport(const RevisionKey& key) {
  return "report " + key.robot.str() + " " + std::to_string(key.number);
}
std::string WorkOfRevision(const RobotId& robot, std::int64_t edge_watermark, std::int64_t standing_watermark) {
  return "revision " + robot.str() + " " + std::to_string(edge_watermark) + "." + std::to_string(standing_watermark);
}

Status BeginAttempt(Store& store, const std::string& work, Stamp now) {
  return store.connection().Append(AttemptSubject(work), [&]() -> Status {
    BeginOne(store, work, now);
    return {};
  });
}

Status EndAttempt(Store& store, const std::string& work, AttemptEnd end, const std::string& why, Stamp now) {
  return store.connection().Append(AttemptSubject(work), [&]() -> Status {
    EndOne(store, work, end, why, now);
    return {};
  });
}

Result<std::vector<std::string>> EndOpenAttempts(Store& store, AttemptEnd end, Stamp now) {
  return Append<std::vector<std::string>>(store, "open attempts", [&]() -> Result<std::vector<std::string>> {
    const std::vector<std::string> works = OpenWorks(store);
    for (const std::string& work : works) EndOne(store, work, end, "", now);
    return works;
  });
}

Result<std::vector<std::string>> EndKilledAttempts(Store& store, Stamp now) {
  return Append<std::vector<std::string>>(store, "open attempts", [&]() -> Result<std::vector<std::string>> {
    const std::vector<std::string> works = OpenWorks(store);
    for (const std::string& work : works) EndKilled(store, work, now);
    return works;
  });
}

Result<std::vector<std::string>> EndKilledAttempts(Store& store, const RobotId& robot, Stamp now) {
  return Append<std::vector<std::string>>(store, "open attempts of robot " + robot.str(),
                                          [&]() -> Result<std::vector<std::string>> {
                                            const std::vector<std::string> works = OpenWorks(store, robot);
                                            for (const std::string& work : works) EndKilled(store, work, now);
                                            return works;
                                          });
}

Result<std::vector<std::string>> EndOpenAttempts(Store& store, const RobotId& robot, AttemptEnd end, Stamp now) {
  return Append<std::vector<std::string>>(store, "open attempts of robot " + robot.str(),
                                          [&]() -> Result<std::vector<std::string>> {
                                            const std::vector<std::string> works = OpenWorks(store, robot);
                                            for (const std::string& work : works) EndOne(store, work, end, "", now);
                                            return works;
                                          });
}

Result<std::map<std::string, int>> LoadAttemptCounts(Store& store) {
  return Load<std::map<std::string, int>>(store, "attempts", [&]() -> Result<std::map<std::string, int>> {
    Query query(store, "SELECT work, attempts FROM waiting_attempt");
    std::map<std::string, int> counts;
    while (query.Step()) counts.emplace(query.Text(0), static_cast<int>(query.Int(1)));
    return counts;
  });
}

Result<Attempts> LoadAttempts(Store& store, const std::string& work) {
  return Load<Attempts>(store, AttemptSubject(work), [&]() -> Result<Attempts> {
    const auto begun = BegunOf(store, work);
    Attempts attempts;
    attempts.under_way = begun && begun->open_number;
    Query query(store,
                "SELECT coalesce(e.how, 'cut_off'), coalesce(e.why, '') FROM attempt a "
                "LEFT JOIN attempt_ended e ON e.attempt_number = a.number "
                "WHERE a.work = ? AND coalesce(e.how, '') <> 'given_back' ORDER BY a.number DESC LIMIT ?");
    query.Bind(work, begun ? begun->attempts : 0);
    while (query.Step()) {
      const bool failed = query.Text(0) == "failed";
      ++(failed ? attempts.failed : attempts.cut_off);
      if (failed && attempts.newest_why.empty()) attempts.newest_why = query.Text(1);
    }
    return attempts;
  });
}

}  // namespace rigcal::storage
