// What counts: which of several sessions of the same pictures is current. Append-only; the newest word holds. Nothing
// that was measured is changed by it. What was taken out by a word: retired.h.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/model/approval/standing.h"
#include "storage/store.h"

namespace rigcal::storage {

// kInvalidInput unless both texts are one printable line each, of at most 500 bytes.
[[nodiscard]] Status CheckWord(const Word& word);

// A session that is being closed is current. For CloseSession.
[[nodiscard]] Status AppendPushed(Store& store, const RobotId& robot, const SessionId& id, Stamp now);
// A session that has just been made current came from a site where others supersede it: those of them that are whole
// here, and what supersedes those, are current again after it. Each is noted in the audit. For CloseSession.
[[nodiscard]] Status KeepSuperseding(Store& store, const RobotId& robot, const SessionId& id, Stamp now);
enum class MadeCurrent { kPushedAgain, kRestored };
// The closed session is current from now on: what it repeats or is repeated by is superseded by it. False, and a no-op,
// if nothing supersedes it and it is not retired; otherwise noted in the audit as well. What was retired is restored
// only: pushed again it stays retired. kNotFound if unknown, kConflict while it is not closed.
[[nodiscard]] Result<bool> MakeCurrent(Store& store, const SessionId& id, MadeCurrent how, const Word& word);
// The newest word about a session: by which it is current, was last, or was retired. nullopt until it is closed.
[[nodiscard]] Result<std::optional<Standing>> LoadStanding(Store& store, const SessionId& id);

// The closed sessions of the robot that were made current by a word after that of this number.
[[nodiscard]] Result<std::set<SessionId>> LoadMadeCurrentSince(Store& store, const RobotId& robot,
                                                               std::int64_t standing);

// Two closed sessions of a robot repeat each other if the later one to arrive holds half or more of the payloads of the
// earlier one: pushed again with a corrected session.yaml, say. The same pictures are no second measurement: that with
// the newest standing is current, the other is superseded; of several, by the one of the newest standing. One that is
// retired supersedes what it did, until that is restored. Of all robots if `robot` is empty.
[[nodiscard]] Result<std::map<SessionId, Superseding>> LoadSuperseded(Store& store, const RobotId& robot);

// Number of the newest standing of the robot; 0 if none. It only grows.
[[nodiscard]] Result<std::int64_t> LoadStandingWatermark(Store& store, const RobotId& robot);

// Ids that begin with `prefix`, sorted; only those of `robot` if it is not empty. kInvalidInput unless the prefix is 8
// to 64 lower-case hex digits.
[[nodiscard]] Result<std::vector<SessionId>> FindSessions(Store& store, const std::string& prefix,
                                                          const RobotId& robot);
[[nodiscard]] Result<std::vector<EdgeId>> FindEdges(Store& store, const std::string& prefix, const RobotId& robot);

}  // namespace rigcal::storage
