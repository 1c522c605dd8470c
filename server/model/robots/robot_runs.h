// What a robot says that it runs, beside what it is to run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/approval/decision.h"
#include "server/model/approval/validity.h"

namespace rigcal {

// As it was told over DDS. `who`: the program that applied it, one printable line of at most 64 bytes.
struct RunsReport {
  RobotId robot;
  Digest digest;     // of the revision's document
  Stamp applied_at;  // by the robot's clock
  std::string who;
};

struct RobotRuns {
  RunsReport report;
  int revision = 0;  // that has this digest; 0: none of this robot
  Stamp told_at;
};

// At a glance.
struct Runs {
  int revision = 0;                    // 0: none that is known
  std::string trouble;                 // a sentence; empty: it runs what is in use
  std::string what = {};               // "revision 3, which was rejected by Ada, 3 Nov 2026"
  Digest digest = {};                  // of its document; empty: not asked for
  std::optional<Stamp> apply_by = {};  // until then a robot may take to apply what is in use; absent: it has no excuse
  friend bool operator==(const Runs&, const Runs&) = default;
};

// A robot applies what is in use by itself, when it is on and ready to.
inline constexpr std::int64_t kApplyWithin_ns = 15LL * 60 * 1'000'000'000;

// "It runs revision 3; revision 5 is in use: not applied yet." `was_approved`: that it was ever allowed to. `decision`:
// the newest about the revision that it runs. `in_use_since`: when it was decided that this is in use.
[[nodiscard]] Runs RunsOf(const RobotRuns& runs, bool was_approved, const std::optional<Decision>& decision,
                          const std::optional<UsableRevision>& in_use, const std::optional<Stamp>& in_use_since = {});

}  // namespace rigcal
