// Sessions, their payloads, and the receipts given for them.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/model/sessions/session.h"
#include "storage/store.h"

namespace rigcal::storage {

struct SessionRow {
  RobotId robot;
  SessionId id;
  bool closed = false;
  std::int64_t payloads = 0, payloads_held = 0;  // a closed one holds all but those that were lost since
  std::int64_t bytes = 0;
  Stamp captured_at, opened_at, closed_at;
  std::string operator_name;
};

// Stores robot, session and its payload list from the canonical manifest text. A no-op if the session exists.
[[nodiscard]] Status AppendSession(Store& store, const SessionId& id, const std::string& manifest_json,
                                   const Manifest& manifest, Stamp now);
[[nodiscard]] Result<std::optional<SessionRow>> LoadSession(Store& store, const SessionId& id);
[[nodiscard]] Result<std::optional<Manifest>> LoadManifest(Store& store, const SessionId& id);
// Of one robot, or of all robots if `robot` is empty; newest captured_at first. Of that list up to `limit`: those after
// the session `before`, the first ones if it is empty; kNotFound if it is not known.
[[nodiscard]] Result<std::vector<SessionRow>> LoadSessions(Store& store, const RobotId& robot,
                                                           const SessionId& before = {}, std::int64_t limit = kAllRows);
[[nodiscard]] Result<std::map<SessionId, Stamp>> LoadCapturedAt(Store& store, const RobotId& robot);
// Of those that are known.
[[nodiscard]] Result<std::map<SessionId, Stamp>> LoadCapturedAt(Store& store, const std::vector<SessionId>& sessions);
// The reference that is named by the closed session which was captured first (of several: of the smallest id), of those
// that name none of `gone`. Empty: there is no such session.
[[nodiscard]] Result<SensorId> LoadNamedReference(Store& store, const RobotId& robot,
                                                  const std::vector<SensorId>& gone);
struct NewestCapture {
  Stamp at;
  std::string operator_name;  // empty: it does not say
};
// Of the closed ones when, and by whom, the newest was captured.
[[nodiscard]] Result<std::optional<NewestCapture>> LoadNewestCapture(Store& store, const RobotId& robot);
// Those that are still arriving, or whose pairs are still being calibrated; likewise newest first.
[[nodiscard]] Result<std::vector<SessionRow>> LoadOpenSessions(Store& store, const RobotId& robot);

// held[i]: payload i of the manifest is durable, and was not lost since. kNotFound if the session is unknown.
[[nodiscard]] Result<std::vector<bool>> LoadHeld(Store& store, const SessionId& id);
// Marks payloads as durable; a no-op for those already marked. Refuses the whole list if one index is not in the
// manifest.
[[nodiscard]] Status AppendHeld(Store& store, const SessionId& id, const std::vector<std::uint32_t>& payload_idx,
                                Stamp now);
// Digests that sessions of this robot hold: what it need not send again, unless it was lost. What another robot sent
// does not count: its digests can be read by anybody, its bytes cannot.
[[nodiscard]] Result<bool> IsHeld(Store& store, const RobotId& robot, const Digest& digest);
struct HeldByAnother {
  RobotId robot;
  SessionId session;
  Stamp captured_at;
  std::size_t contents = 0;  // of those asked for
};
// Of the closed sessions of other robots the one that holds most of these contents; of several the first to arrive.
[[nodiscard]] Result<std::optional<HeldByAnother>> LoadHeldByAnother(Store& store, const RobotId& robot,
                                                                     const std::set<Digest>& digests);
// Closes the session (immutable and current from now on) and queues one job per pair, in this order. A no-op if closed;
// kConflict while a payload is not held.
[[nodiscard]] Status CloseSession(Store& store, const SessionId& id, const std::vector<SensorPair>& pairs, Stamp now);

// All sensors that the closed sessions of a robot list, also those without an edge. Sorted.
[[nodiscard]] Result<std::vector<SensorId>> LoadListedSensors(Store& store, const RobotId& robot);

struct RobotRow {
  RobotId robot;
  Stamp first_seen_at;
  std::int64_t sessions = 0, edges = 0;
};
// A no-op if the robot is known; its name must be a robot's name.
[[nodiscard]] Status AppendRobot(Store& store, const RobotId& robot, Stamp now);
// Nothing of a robot that is not known.
[[nodiscard]] Result<std::optional<RobotRow>> LoadRobot(Store& store, const RobotId& robot);
[[nodiscard]] Result<bool> HasRobot(Store& store, const RobotId& robot);

// Names of robots alone, in their order; each walks a range of the table's own order, or looks names up in it.
// The first `limit` of those that begin with `prefix`.
[[nodiscard]] Result<std::vector<RobotId>> LoadRobotNames(Store& store, const std::string& prefix, std::int64_t limit);
// Those that stand next to `name`, known or not: up to `each_way` before it and after it.
[[nodiscard]] Result<std::vector<RobotId>> LoadRobotsBeside(Store& store, const RobotId& name, std::int64_t each_way);
// Those of `names` that are known.
[[nodiscard]] Result<std::vector<RobotId>> LoadRobotsNamed(Store& store, const std::vector<RobotId>& names);

}  // namespace rigcal::storage
