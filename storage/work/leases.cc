#include "storage/work/leases.h"

#include "storage/database/query.h"
#include "storage/s3/store_bucket.h"

namespace rigcal::storage {
namespace {

std::string LeaseSubject(const RobotId& robot) { return "the lease of robot " + robot.str(); }

std::int64_t InNanoseconds(std::chrono::milliseconds time) { return std::chrono::nanoseconds(time).count(); }

struct Held {
  std::int64_t token = 0;
  std::string owner;
  bool is_in_time = false;
};

std::optional<Held> LoadHeld(Store& store, const RobotId& robot) {
  Query query(store,
              "SELECT token, owner, until_ns > (SELECT now_ns FROM store_clock) FROM lease_robot WHERE robot_id = ?");
  if (!query.Bind(robot).Step()) return std::nullopt;
  return Held{query.Int(0), query.Text(1), query.Int(2) != 0 && !query.Text(1).empty()};
}

bool IsHeld(Store& store, const Lease& lease) {
  Query query(store, "SELECT 1 FROM lease_robot WHERE robot_id = ? AND owner = ? AND token = ?");
  return query.Bind(lease.robot, lease.owner, lease.token).Step();
}

Error LostError(const Lease& lease) {
  return {ErrorCode::kConflict,
          "another process took over robot " + lease.robot.str() + " while " + lease.owner +
              " stood still: what this one did of it is given up",
          "Nothing: the other one does it anew."};
}

}  // namespace

Result<std::optional<Lease>> TakeLease(Store& store, const RobotId& robot, const std::string& owner,
                                       std::chrono::milliseconds time) {
  return Append<std::optional<Lease>>(store, LeaseSubject(robot), [&]() -> Result<std::optional<Lease>> {
    const auto before = LoadHeld(store, robot);
    if (before && before->is_in_time && before->owner != owner) return std::nullopt;
    const Lease lease{robot, owner, before ? before->token + 1 : 1, before ? before->owner : ""};
    Query(store,
          "INSERT INTO lease_robot SELECT ?, ?, ?, now_ns + ? FROM store_clock WHERE true ON CONFLICT (robot_id) DO "
          "UPDATE SET "
          "token = excluded.token, owner = excluded.owner, until_ns = excluded.until_ns")
        .Bind(robot, lease.token, owner, InNanoseconds(time))
        .Run();
    return lease;
  });
}

Status RenewLeases(Store& store, const std::vector<Lease>& leases, std::chrono::milliseconds time) {
  return store.connection().WriteBeside([&]() -> Status {
    for (const Lease& lease : leases)
      Query(store,
            "UPDATE lease_robot SET until_ns = (SELECT now_ns FROM store_clock) + ? WHERE robot_id = ? AND owner = ? "
            "AND token = ?")
          .Bind(InNanoseconds(time), lease.robot, lease.owner, lease.token)
          .Run();
    return {};
  });
}

Status GiveBackLease(Store& store, const Lease& lease) {
  return store.connection().Append(LeaseSubject(lease.robot), [&]() -> Status {
    Query(store, "UPDATE lease_robot SET owner = '', until_ns = 0 WHERE robot_id = ? AND owner = ? AND token = ?")
        .Bind(lease.robot, lease.owner, lease.token)
        .Run();
    return {};
  });
}

Result<std::vector<RobotId>> LoadLeasedByOthers(Store& store, const std::string& owner) {
  return Load<std::vector<RobotId>>(store, "leases", [&]() -> Result<std::vector<RobotId>> {
    Query query(store,
                "SELECT robot_id FROM lease_robot WHERE owner > '' AND until_ns > (SELECT now_ns FROM store_clock) AND "
                "owner <> ? "
                "ORDER BY robot_id");
    std::vector<RobotId> robots;
    query.Bind(owner);
    while (query.Step()) robots.push_back(query.IdAt<RobotId>(0));
    return robots;
  });
}

Fenced::Fenced(Store& store, const Lease& lease) : store_(store) {
  store.connection().SetGuard([&store, lease]() -> Status {
    RIGCAL_TRY(CheckBlobsStayed(store));
    return IsHeld(store, lease) ? Status{} : Fail(LostError(lease));
  });
}

Fenced::~Fenced() { store_.connection().SetGuard({}); }

}  // namespace rigcal::storage
