// READ and solve: all that a robot's revision is, before anything of it is stored.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "server/fleet/assess.h"
#include "server/formats/documents.h"
#include "server/model/graph/graph.h"
#include "server/model/graph/joint_poses.h"
#include "server/model/sessions/as_found.h"
#include "server/pipeline/robots/robot_status.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/revisions/merged_edges.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// What follows from a revision that was judged, beside its document.
struct JudgedBeside {
  std::vector<std::string> cause_keys;
  std::optional<AsFound> as_found;
  std::optional<StatusFacts> status;
};

// What is stored of a revision, which has no number yet.
struct SolvedRobot {
  Revision revision;
  formats::RevisionInput input;  // of its document
  JointPoses poses;
  std::optional<PlacedPoses> placed;  // where a pose is known in part only
  storage::MergeStep merge;
  storage::WhatCounts counts;  // by which it was merged
  std::string rig_model;
  fleet::SessionTimes captured_at;
  JudgedBeside beside;
  std::optional<WorstEdge> worst;
};

struct SolveOptions {
  std::int64_t pairs_waiting = 0;
  std::int64_t run = 0;     // with what that re-computation says of the sessions; 0: with what is in effect
  bool merges_anew = true;  // from all stored edges, where they wait for that
};
// Merges, solves and judges what counts of the robot (revise.h).
[[nodiscard]] Result<SolvedRobot> SolveRobot(storage::Store& store, const RobotId& robot, const Clock& clock,
                                             const SolveOptions& options);

}  // namespace rigcal::pipeline
