// The documents of /api/v1 (docs/api.md): what a Reply, HTTP and the CLI's --json carry. Canonical as in documents.h.
// The order of lists is the caller's. A value that does not exist is null, never a made-up number.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/limits_in_force.h"
#include "server/base/process/vitals.h"
#include "server/formats/documents.h"
#include "server/model/approval/audit.h"
#include "server/model/approval/decision.h"
#include "server/model/approval/epoch.h"
#include "server/model/approval/policy_version.h"
#include "server/model/approval/standing.h"
#include "server/model/approval/validity.h"
#include "server/model/boards/remark.h"
#include "server/model/robots/robot_summary.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::formats {

// Of a list that was asked for by pages, "next": what the following page is asked for with; empty, written as null:
// there is none. Absent of a list in one piece.
using NextPage = std::optional<std::string>;

// verb robots. `next` is there for a part of a list: the robot after which the next part begins, empty where nothing
// follows.
[[nodiscard]] std::string WriteRobots(const std::vector<RobotSummary>& robots, Stamp now,
                                      const std::optional<RobotId>& next = std::nullopt);

// verbs sessions, session
struct SessionAnswer {
  SessionId session;
  RobotId robot;
  bool closed = false;
  std::int64_t payloads = 0, payloads_held = 0, bytes = 0;
  std::optional<Stamp> captured_at, opened_at, closed_at;
  std::string operator_name;
  std::int64_t jobs_waiting = 0, jobs_total = 0;
  std::optional<Standing> standing = {};          // absent: not closed
  std::optional<Superseding> superseded_by = {};  // absent: current, or not closed
  std::vector<SessionId> supersedes = {};
  std::optional<Standing> retired = {};  // absent: it is not
};
// A row per session; and of one session its row, its manifest and the rows of its edges.
[[nodiscard]] std::string WriteSessions(const std::vector<SessionAnswer>& sessions, const NextPage& next = {});
// `retired`: of the sensors that it lists, those that are. `lacking`: what its rig model has and it does not, a
// sentence. `remarks`: on its boards.
[[nodiscard]] std::string WriteSession(const SessionAnswer& session, const Manifest& manifest,
                                       const std::vector<Edge>& edges, const std::vector<RetiredSensor>& retired = {},
                                       const std::string& lacking = {}, const std::vector<BoardRemark>& remarks = {});

// verbs retire, restore. Of a session, as it stands; `has_edges`: its robot, so that a revision follows.
[[nodiscard]] std::string WriteStandingOfSession(const SessionAnswer& session, bool has_edges);
// Of an edge, as it is shown from now on; of a sensor. `standing`: the newest word about it, if anybody said any.
[[nodiscard]] std::string WriteStandingOfEdge(const Edge& edge, const std::optional<Standing>& standing);
[[nodiscard]] std::string WriteStandingOfSensor(const RobotId& robot, const SensorId& sensor,
                                                const std::optional<Standing>& standing, bool has_edges);

// verb policy: what holds, and who set it, the widest first.
struct PolicyAnswer {
  PolicyPlace place;
  PolicyInForce in_force;
  std::vector<PolicyVersion> set;
};
// The limits that hold, key by key who set them, then what was set.
[[nodiscard]] std::string WritePolicy(const PolicyAnswer& answer);
// verb set_policy: how many robots wait to be judged anew by it.
[[nodiscard]] std::string WritePolicySet(const PolicyVersion& set, std::int64_t robots_waiting);
// Of `rigcal policy check`: a file alone.
[[nodiscard]] std::string WritePolicyCheck(const std::string& file, const Policy& policy);

// verb audit, the newest first. `next`: as NextPage, the number of a row; 0: there is no other page.
[[nodiscard]] std::string WriteAudit(const std::vector<AuditRow>& rows, const std::optional<std::int64_t>& next = {});
// verb audit_verify
[[nodiscard]] std::string WriteAuditCheck(const AuditCheck& check);

// verb edges: a row per edge; `residuals` (sorted by edge id) are those of `revision`, 0 if there is none.
[[nodiscard]] std::string WriteEdges(const RobotId& robot, int revision, const std::vector<Edge>& edges,
                                     const std::vector<EdgeResidual>& residuals, const NextPage& next = {});

// verbs approve, reject, rollback: the revision as it stands from now on.
[[nodiscard]] std::string WriteDecided(const Revision& revision, const Approval& approval);

// verb show: number, time and digest around the revision's document, which is put in byte for byte; beside it what its
// newest session found of the calibration in use, and `remarks` on the boards of the sessions that it counts.
[[nodiscard]] std::string WriteShow(const Revision& revision, bool is_published, const Validity& validity, Stamp now,
                                    const Approval& approval = {}, const std::optional<Runs>& runs = {},
                                    const std::optional<AsFound>& as_found = {},
                                    const std::vector<BoardRemark>& remarks = {});
// verb revisions: without documents. `next`: as NextPage, the number of a revision; 0: there is no other page.
// `approvals`: one of each revision. `as_found`: of those that have it. `epochs`: all that began of the robot, the
// earliest first.
[[nodiscard]] std::string WriteRevisions(const RobotId& robot, const std::vector<Revision>& revisions, Stamp now,
                                         const std::optional<int>& next = {},
                                         const std::vector<Approval>& approvals = {},
                                         const std::map<int, AsFoundSummary>& as_found = {},
                                         const std::vector<Epoch>& epochs = {});

// verb lookup
struct LookupAnswer {
  RobotId robot;
  int revision = 0;
  SensorId frame_a, frame_b;
  Se3 T_a_b;
  Matrix6d covariance = Matrix6d::Zero();         // right tangent at b
  std::vector<Vector6d> unobservable_basis = {};  // likewise; directions that nobody measured: then it is no whole pose
  std::optional<Eigen::Matrix3d> R_a_robot = {};  // as GraphSolution::R_ref_robot, in a; nothing: not known
  Verdict verdict;                                // of the revision
  Validity validity;
  Approval approval = {};         // likewise
  std::optional<Runs> runs = {};  // what the robot says that it runs; absent: it never told
};
// "known" is true of a whole pose only; one in part has what was measured, axis by axis.
[[nodiscard]] std::string WriteLookup(const LookupAnswer& answer);

// verb status
struct OpenBatchAnswer {
  BatchId batch;
  RobotId robot;
  std::int64_t items = 0, held = 0;  // edges that it has, and those that came
  Stamp opened_at, newest_at;
};
struct StatusAnswer {
  std::string version;
  std::int64_t uptime_ns = 0;
  std::int64_t jobs_waiting = 0;
  std::vector<RobotSummary> robots;           // all, a part of them, or the one asked for
  std::optional<RobotId> next;                // of a part: as in WriteRobots
  std::vector<OpenBatchAnswer> open_batches;  // of all robots, or the one asked for: no edge of them counts
  std::string http_address;                   // of the reports; empty: none
  std::optional<Error> problem;               // why the server cannot store or answer
};
// Ages are as of `now`.
[[nodiscard]] std::string WriteStatus(const StatusAnswer& answer, Stamp now);

// verb live: changes whenever something arrived or was finished, and at no other time.
struct LiveAnswer {
  RobotId robot;  // empty: all
  std::int64_t robots = 0, sessions = 0, edges = 0;
  std::int64_t unfinished = 0;  // pairs to calibrate, robots to solve and reports to publish
  int revision = 0;             // of one robot; 0: none yet
  std::vector<SessionAnswer> open_sessions;
};
// With no time in it, so that the same state is the same text.
[[nodiscard]] std::string WriteLive(const LiveAnswer& answer);

// verbs robot_names, sensor_names; `more`: there are others.
[[nodiscard]] std::string WriteRobotNames(const std::vector<RobotId>& robots, bool more);
[[nodiscard]] std::string WriteSensorNames(const RobotId& robot, const std::vector<SensorId>& sensors, bool more);
// verb known_robot; `slip_of`: known ones that a robot which is not known may be, mistyped.
[[nodiscard]] std::string WriteKnownRobot(const RobotId& robot, bool is_known, const std::vector<RobotId>& slip_of);

// verb known_files: of the files asked for, those of another robot's session.
struct FilesOfAnother {
  RobotId robot;
  SessionId session;
  Stamp captured_at;
  std::size_t files = 0;
};
// `asked`: files that were asked about; `another` absent: nobody else's.
[[nodiscard]] std::string WriteKnownFiles(std::size_t asked, const std::optional<FilesOfAnother>& another);

// verb due: every robot, or a part of them; overdue = older than max_age_ns (absent: than its policy allows), or never
// calibrated.
[[nodiscard]] std::string WriteDue(const std::vector<RobotSummary>& robots, std::optional<std::int64_t> max_age_ns,
                                   Stamp now, const std::optional<RobotId>& next = std::nullopt);

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
  std::vector<PartState> parts;  // one with a problem: "failing"
  std::string http_address;      // of the reports; empty: none
  limits::Limits limits;         // in force
  std::int64_t lost_files = 0;
  std::vector<LostFileAnswer> first_lost_files;
  [[nodiscard]] std::optional<Error> problem() const;  // the first of the parts
};
// "state" is "failing" where a part has a problem, else "ok".
[[nodiscard]] std::string WriteHealth(const HealthAnswer& answer, Stamp now);

// {"error": {"code", "what", "cure"}}: what a failed request answers.
[[nodiscard]] std::string WriteError(const Error& error);
// The error that a document carries; nullopt for any other document.
[[nodiscard]] std::optional<Error> ReadError(std::string_view text);

// Event::json of each kind (docs/api.md, events). session_closed: WriteSessionEvent; edge: WriteEdgeEvent; ...
[[nodiscard]] std::string WriteSessionEvent(const SessionAnswer& session);
[[nodiscard]] std::string WriteEdgeEvent(const Edge& edge, std::int64_t jobs_waiting, std::int64_t jobs_total);
[[nodiscard]] std::string WriteGraphEvent(const RobotId& robot, std::int64_t edges, const GraphSolution& solution);
// `usable`: Validity::usable.
[[nodiscard]] std::string WriteRevisionEvent(const Revision& revision, const std::optional<UsableRevision>& usable);
[[nodiscard]] std::string WritePublishedEvent(const RobotId& robot, int revision, const std::string& path);

}  // namespace rigcal::formats
