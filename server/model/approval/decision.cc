#include "server/model/approval/decision.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "server/model/approval/audit.h"
#include "server/model/approval/validity.h"

namespace rigcal {
namespace {

constexpr std::array<std::pair<RevisionState, const char*>, 7> kStateNames = {
    {{RevisionState::kUnusable, "unusable"},
     {RevisionState::kCandidate, "candidate"},
     {RevisionState::kApproved, "approved"},
     {RevisionState::kTakenBack, "taken_back"},
     {RevisionState::kSuperseded, "superseded"},
     {RevisionState::kRolledBack, "rolled_back"},
     {RevisionState::kRejected, "rejected"}}};

// "approved by policy, 3 Nov 2026"
std::string DecidedText(const Decision& decision) {
  const std::string how = decision.how == "rolled_back" ? "rolled back to" : decision.how;
  return how + " by " + decision.word.who + ", " + DayText(decision.word.at);
}

std::string ApproveCommand(const RobotId& robot, int revision) {
  return "`rigcal approve " + robot.str() + " " + std::to_string(revision) + " --reason TEXT`";
}

std::string StateText(const RobotId& robot, int revision, const Approval& approval) {
  const std::string reason =
      approval.decision && !approval.decision->word.reason.empty() ? ": " + approval.decision->word.reason : "";
  switch (approval.state) {
    case RevisionState::kCandidate:
      return "this one is a candidate" + (approval.cause.empty() ? "" : ", " + approval.cause) + ": " +
             ApproveCommand(robot, revision);
    case RevisionState::kSuperseded:
      return "this one was superseded";
    case RevisionState::kRolledBack:
      return "this one was rolled back";
    case RevisionState::kRejected:
      return "this one was " + (approval.decision ? DecidedText(*approval.decision) : "rejected") + reason;
    case RevisionState::kTakenBack:
    case RevisionState::kApproved:
    case RevisionState::kUnusable:
      break;
  }
  return "this one is taken back: what it was made of was retired, or a sensor was moved, since it was approved";
}

}  // namespace

Status CheckPerson(const std::string& who) {
  std::string name;
  for (const char letter : who)
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0)
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (name != kPolicyWho && name != kServerWho) return {};
  return Fail(
      ErrorCode::kInvalidInput,
      "'" + who + "' is the name by which " + (name == kPolicyWho ? "the policy" : "the server") + " itself decides",
      "Say who you are: --by NAME.");
}

std::string NameOf(RevisionState state) {
  for (const auto& [one, name] : kStateNames)
    if (one == state) return name;
  return kStateNames.front().second;
}

std::string WordFor(RevisionState state) {
  if (state == RevisionState::kUnusable) return "-";
  if (state == RevisionState::kApproved) return "in use";
  std::string word = NameOf(state);
  std::replace(word.begin(), word.end(), '_', ' ');
  return word;
}

RevisionState RevisionStateOf(const std::string& name) {
  for (const auto& [state, one] : kStateNames)
    if (one == name) return state;
  return RevisionState::kUnusable;
}

bool Approves(const Policy& policy, const Verdict& verdict, bool found_drift) {
  if (policy.approval.value_or(ApprovalBy::kAutomatic) == ApprovalBy::kPerson) return false;
  if (found_drift && !policy.approve_drift.value_or(true)) return false;
  if (verdict.level == VerdictLevel::kWarn) return policy.approve_warnings.value_or(true);
  return verdict.level == VerdictLevel::kPass;
}

std::string WhatToDo(const RobotId& robot, int revision, RevisionState state, const Verdict& verdict) {
  if (state != RevisionState::kCandidate) return verdict.what_to_do;
  const std::string approve = ApproveCommand(robot, revision) + ", if it is right";
  if (verdict.level == VerdictLevel::kPass || verdict.what_to_do.empty()) return approve + ".";
  return approve + "; then: " + verdict.what_to_do;
}

std::string ApprovalText(const RobotId& robot, int revision, const Approval& approval) {
  if (approval.state == RevisionState::kUnusable) return "";
  if (approval.in_use && approval.in_use->revision == revision) return "";
  const std::string used = approval.in_use ? "In use: revision " + std::to_string(approval.in_use->revision) + " (" +
                                                 DecidedText(*approval.in_use) + ")"
                                           : "No calibration of " + robot.str() + " is in use";
  return used + "; " + StateText(robot, revision, approval);
}

}  // namespace rigcal
