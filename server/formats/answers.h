// The documents of /api/v1 (docs/api.md): what a Reply, HTTP and the CLI's --json carry. Canonical as in documents.h.
// The order of lists is the caller's. A value that does not exist is null, never a made-up number.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/limits_in_force.h"
#include "server/formats/documents.h"

namespace rigcal::formats {

// verb robots
struct RobotAnswer {
  RobotId robot;
  int revision = 0;  // 0: none yet, written as null
  Verdict verdict;
  std::optional<Stamp> calibrated_at;  // newest capture of a good edge; absent: never
  std::int64_t sessions = 0, edges = 0, jobs_waiting = 0;
  bool overdue = false;
};
[[nodiscard]] std::string WriteRobots(const std::vector<RobotAnswer>& robots, Stamp now);

// verbs sessions, session
struct SessionAnswer {
  SessionId session;
  RobotId robot;
  bool closed = false;
  std::int64_t payloads = 0, payloads_held = 0, bytes = 0;
  std::optional<Stamp> captured_at, opened_at, closed_at;
  std::string operator_name;
  std::int64_t jobs_waiting = 0, jobs_total = 0;
};
[[nodiscard]] std::string WriteSessions(const std::vector<SessionAnswer>& sessions);
[[nodiscard]] std::string WriteSession(const SessionAnswer& session, const Manifest& manifest,
                                       const std::vector<Edge>& edges);

// verb edges: a row per edge; `residuals` (sorted by edge id) are those of `revision`, 0 if there is none.
[[nodiscard]] std::string WriteEdges(const RobotId& robot, int revision, const std::vector<Edge>& edges,
                                     const std::vector<EdgeResidual>& residuals);

// verb show: number, time and digest around the revision's document, which is put in byte for byte.
[[nodiscard]] std::string WriteShow(const Revision& revision, bool is_published, Stamp now);
// verb revisions: without documents.
[[nodiscard]] std::string WriteRevisions(const RobotId& robot, const std::vector<Revision>& revisions, Stamp now);

// verb lookup
struct LookupAnswer {
  RobotId robot;
  int revision = 0;
  SensorId frame_a, frame_b;
  Se3 T_a_b;
  Matrix6d covariance = Matrix6d::Zero();  // right tangent at b
  Verdict verdict;                         // of the revision
};
[[nodiscard]] std::string WriteLookup(const LookupAnswer& answer);

// verb status
struct StatusAnswer {
  std::string version;
  std::int64_t uptime_ns = 0;
  std::int64_t jobs_waiting = 0;
  std::vector<RobotAnswer> robots;  // all, or the one asked for
  std::string http_address;         // of the reports; empty: none
};
[[nodiscard]] std::string WriteStatus(const StatusAnswer& answer, Stamp now);

// verb live: changes whenever something arrived or was finished, and at no other time.
struct LiveAnswer {
  RobotId robot;  // empty: all
  std::int64_t robots = 0, sessions = 0, edges = 0;
  std::int64_t unfinished = 0;  // robots to solve and reports to publish
  int revision = 0;             // of one robot; 0: none yet
  std::vector<SessionAnswer> open_sessions;
};
[[nodiscard]] std::string WriteLive(const LiveAnswer& answer);

// verb due: every robot; overdue = older than max_age_ns, or never calibrated.
struct DueAnswer {
  RobotId robot;
  std::optional<Stamp> calibrated_at;
  Verdict verdict;
};
[[nodiscard]] std::string WriteDue(const std::vector<DueAnswer>& robots, std::int64_t max_age_ns, Stamp now);

// A payload that the server's disk has not kept, and that was not sent again yet.
struct LostFileAnswer {
  RobotId robot;
  SessionId session;
  std::string path;
  bool missing = false;  // else damaged
};

// verb health
struct HealthAnswer {
  std::string version;
  std::int64_t uptime_ns = 0;
  std::int64_t disk_free_bytes = 0;
  int schema = 0;                // version of the store
  int protocol = 0;              // kWireProtocol
  std::optional<Error> problem;  // absent: "ok"
  std::string http_address;      // of the reports; empty: none
  limits::Limits limits;         // in force
  std::int64_t lost_files = 0;
  std::vector<LostFileAnswer> first_lost_files;
};
[[nodiscard]] std::string WriteHealth(const HealthAnswer& answer, Stamp now);

// {"error": {"code", "what", "cure"}}: what a failed request answers.
[[nodiscard]] std::string WriteError(const Error& error);
// The error that a document carries; nullopt for any other document.
[[nodiscard]] std::optional<Error> ReadError(std::string_view text);

// Event::json of each kind (docs/api.md, events). session_closed: WriteSessionEvent; edge: WriteEdgeEvent; ...
[[nodiscard]] std::string WriteSessionEvent(const SessionAnswer& session);
[[nodiscard]] std::string WriteEdgeEvent(const Edge& edge, std::int64_t jobs_waiting, std::int64_t jobs_total);
[[nodiscard]] std::string WriteGraphEvent(const RobotId& robot, std::int64_t edges, const GraphSolution& solution);
[[nodiscard]] std::string WriteRevisionEvent(const Revision& revision);
[[nodiscard]] std::string WritePublishedEvent(const RobotId& robot, int revision, const std::string& path);

}  // namespace rigcal::formats
