// What a verdict means for who drives the robot: one line, and until when it holds.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "server/base/stamp.h"
#include "server/model/approval/validity.h"
#include "server/model/diagnosis.h"
#include "server/model/robots/robot_runs.h"

namespace rigcal {

// By which robots are counted, the most urgent first.
enum class DriveKind {
  kDoNotDrive,
  kNotVerified,   // nothing is known, or it is overdue
  kNotApplied,    // the robot says that it runs something else than what is in use
  kToApprove,     // it passed or warned, and is not in use
  kSuperseded,    // of a revision that is not the newest
  kOkWithAction,  // something is to be done by a day
  kOk
};
inline constexpr std::array kDriveKinds = {DriveKind::kDoNotDrive, DriveKind::kNotVerified, DriveKind::kNotApplied,
                                           DriveKind::kToApprove,  DriveKind::kSuperseded,  DriveKind::kOkWithAction,
                                           DriveKind::kOk};
// "do_not_drive", "not_verified", "not_applied", "to_approve", "superseded", "ok_with_action", "ok"; of another name
// nothing.
[[nodiscard]] std::string NameOf(DriveKind kind);
[[nodiscard]] std::optional<DriveKind> DriveKindOf(const std::string& name);
// For people, of so many robots: "do not drive", "not verified", "not applied", "to be approved", "warn", "OK to
// drive".
[[nodiscard]] std::string WordsFor(DriveKind kind);

struct DriveRule {
  DriveKind kind = DriveKind::kNotVerified;
  VerdictLevel level = VerdictLevel::kUnknown;  // that it stands for: of what is overdue nothing is known
  std::string rule;                             // without a stop: "OK to drive until 20 Feb 2027"
  std::optional<Stamp> until = {};              // absent: no time ends it
};

// `due`: when the calibration is overdue; absent: it counts nothing, and is. Of a fail and of what is not known the
// time changes nothing.
[[nodiscard]] DriveRule DriveRuleOf(const Verdict& verdict, const std::optional<Stamp>& due, Stamp now);
// As of the moment at which `validity.overdue` was worked out. Of a superseded revision, of one that is not approved,
// and where the robot says that it runs something else, that it is so: not known. `runs`: absent of a robot that never
// told, and where the revision alone is asked for. A fail stays one.
[[nodiscard]] DriveRule DriveRuleOf(const Verdict& verdict, const Validity& validity,
                                    const std::optional<Runs>& runs = {});

}  // namespace rigcal
