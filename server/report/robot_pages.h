// The pages about one robot that are made when asked for: its history, a comparison of two revisions, a session.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/model/approval/decision.h"
#include "server/model/approval/epoch.h"
#include "server/model/approval/standing.h"
#include "server/model/sensors/projection_map.h"
#include "server/report/render.h"

namespace rigcal::report {

// A session as the robot's page lists it.
struct SessionRow {
  SessionId id;
  Stamp captured_at;
  std::string operator_name;
  bool closed = false;
  std::int64_t files = 0, files_held = 0, pairs = 0, pairs_waiting = 0;
  std::int64_t good = 0, failed = 0;  // of the pairs that are done
  std::int64_t past = 0;              // good where they were measured, but they count no more
  std::optional<Superseding> superseded_by = {};
  std::optional<Word> retired = {};
};
// Of revisions and of sessions a page each, the newest first; "?before=<revision>" and "?sessions_before=<id>" show
// others.
struct RobotInput {
  RobotSummary row;
  std::vector<Revision> revisions;
  std::vector<SessionRow> sessions;
  std::vector<SensorId> sensors;      // whose history is drawn
  std::vector<SessionRow> open = {};  // of all sessions: still arriving, or being calibrated; the newest first
  bool older_revisions = false, older_sessions = false;  // there are, beyond the page
  bool newest_revisions = true, newest_sessions = true;  // the page is the first
  std::vector<RetiredSensor> retired = {};
  Approval approval = {};                    // of the newest revision
  std::string rig_model = {};                // as the newest session says; empty: none does
  std::vector<Epoch> epochs = {};            // that began, the earliest first
  std::map<int, RevisionState> states = {};  // of `revisions`
};
// /robots/<id>/. Ages are as of `now`.
[[nodiscard]] Result<std::string> RenderRobot(const RobotInput& input, Stamp now);

struct SolvedRevision {
  int number = 0;
  std::shared_ptr<const formats::RevisionInput> revision;
  Stamp calibrated_at = {};  // 0: it counts nothing
};
// What the joint refinement of one session says by itself; poses in its reference, covariances as of GraphSolution.
struct Visit {
  SessionId session;
  Stamp captured_at;
  SensorId reference;
  std::vector<SensorPose> poses;
};
// "window.rigcal = {...};": the poses of each sensor over revisions ("rows") and over visits ("visits", from two on),
// each the oldest first, against the first known one, and how far it moved from each to the next. Where an epoch of the
// sensor or of the reference began in between, "remounted" instead.
[[nodiscard]] std::string TrendData(const std::vector<SolvedRevision>& revisions, const std::vector<Visit>& visits = {},
                                    const std::vector<Epoch>& epochs = {});

struct ComparedLenses {
  std::vector<LensChange> changes;                             // of cameras whose intrinsics differ
  std::vector<SensorId> same;                                  // cameras whose intrinsics do not
  std::vector<std::pair<SensorId, std::string>> not_compared;  // and why: "nothing was kept of it in revision 2"
};
struct CompareInput {
  RobotId robot;
  SolvedRevision before, now;
  int newest = 0;  // revisions 1 to this are to choose from
  std::map<SessionId, Stamp> captured_at = {};
  ComparedLenses lenses = {};
};
// What differs between the two revisions: verdicts, poses, lenses, edges.
[[nodiscard]] Result<std::string> RenderCompare(const CompareInput& input);

struct SessionInput {
  RobotId robot;
  SessionRow row;
  Manifest manifest;
  std::vector<Edge> edges;                                                // that it gave
  std::map<EdgeId, Diagnosis> past = {};                                  // of those: no longer counted, and why
  std::map<std::pair<CaptureId, SensorId>, std::string> unreadable = {};  // why a file could not be read
  bool all_looked_at = true;                                              // for that; else there may be more
  std::vector<RetiredSensor> retired = {};                                // of the sensors that it lists
  std::string lacking = {};  // what its rig model has and it does not list, as a sentence; empty: nothing
  std::vector<BoardRemark> board_remarks = {};
  std::optional<RobotSummary> robot_now = {};  // what its robot's newest revision says: the session may be part of it
};
// Pictures are "evidence/<digest>.<suffix>" below the page.
[[nodiscard]] Result<std::string> RenderSession(const SessionInput& input);

}  // namespace rigcal::report
