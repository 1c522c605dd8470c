// The life of a calibration: a revision is a candidate until somebody approves it, a person or the policy; then it is
// in use until another takes its place.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/base/result.h"
#include "server/model/approval/policy.h"
#include "server/model/approval/standing.h"
#include "server/model/diagnosis.h"

namespace rigcal {

inline constexpr const char* kPolicyWho = "policy";  // who decides where nobody has to
// kInvalidInput of a name that stands for the policy or the server themselves, however it is written: no person may
// decide by it.
[[nodiscard]] Status CheckPerson(const std::string& who);

struct Decision {
  std::int64_t number = 0;  // order of arrival among those of all robots
  int revision = 0;
  std::string how;  // "approved", "rejected", "rolled_back": the robot was, to this revision
  Word word;
};

enum class RevisionState {
  kUnusable,    // it failed, or nothing is known: nobody can approve it
  kCandidate,   // nobody has decided about it
  kApproved,    // and no other since: the robot is to use it
  kTakenBack,   // likewise, but what it was made of was retired, or a sensor moved, since: the robot is not to use it
  kSuperseded,  // another was approved after it
  kRolledBack,  // the robot was rolled back behind it
  kRejected
};
// "unusable", "candidate", "approved", "taken_back", "superseded", "rolled_back", "rejected"; what is not known is
// unusable.
[[nodiscard]] std::string NameOf(RevisionState state);
[[nodiscard]] RevisionState RevisionStateOf(const std::string& name);

// For people: "in use", "candidate", "taken back", "rolled back"; "-" of what is unusable.
[[nodiscard]] std::string WordFor(RevisionState state);

// Of a revision; `in_use` is of its robot.
struct Approval {
  RevisionState state = RevisionState::kUnusable;
  std::optional<Decision> decision = {};  // the newest about it
  std::optional<Decision> in_use = {};    // by which a revision is announced now; absent: none is
  std::string cause =
      {};  // "re-computed with rigcal 0.2.0, estimator joint/7"; empty: something was measured, said or set
};

// Whether the policy approves a revision of this verdict by itself. `found_drift`: its newest session found a sensor
// elsewhere than the calibration in use says.
[[nodiscard]] bool Approves(const Policy& policy, const Verdict& verdict, bool found_drift = false);

// What to do about a revision: of a candidate approving it comes first, and alone where its verdict asks for nothing.
[[nodiscard]] std::string WhatToDo(const RobotId& robot, int revision, RevisionState state, const Verdict& verdict);

// "In use: revision 3 (approved by policy, 3 Nov 2026); this one is a candidate: `rigcal approve rig 4 --reason TEXT`".
// Empty of the revision that is in use, and of one that is unusable: its verdict says it.
[[nodiscard]] std::string ApprovalText(const RobotId& robot, int revision, const Approval& approval);

}  // namespace rigcal
