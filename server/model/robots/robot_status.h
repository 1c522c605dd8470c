// Where a robot, and each of its sensors, stands with its calibration: one word, a sentence why, and the next step.
// Beside the verdict, which judges a revision, and the drive rule, which says whether the robot may drive: this says
// who has to go where, and by when.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/approval/validity.h"
#include "server/model/diagnosis.h"
#include "server/model/verdict_basis.h"

namespace rigcal {

enum class StatusWord {
  kOk,
  kDue,             // within the next week, or the date that the drift of a sensor allows is past
  kOverdue,         // older than the policy allows
  kNotApplied,      // the robot says that it runs something else than what is in use
  kToApprove,       // the newest revision may be used, and waits for somebody's word
  kDrifted,         // the newest session found a sensor moved, beyond chance; the calibration was updated by it
  kOutOfTolerance,  // that move, or how uncertain a pose is, is beyond the tolerance of the policy
  kFailed,          // the verdict of the newest revision is fail
  kUnknown          // nothing is known of it yet, or its verdict is unknown
};
inline constexpr std::array<StatusWord, 9> kStatusWords = {
    StatusWord::kOk,        StatusWord::kDue,     StatusWord::kOverdue,        StatusWord::kNotApplied,
    StatusWord::kToApprove, StatusWord::kDrifted, StatusWord::kOutOfTolerance, StatusWord::kFailed,
    StatusWord::kUnknown};
// "ok", "due", "overdue", "not-applied", "to-approve", "drifted", "out-of-tolerance", "failed", "unknown"; and back,
// kUnknown for any other name.
[[nodiscard]] std::string NameOf(StatusWord word);
[[nodiscard]] StatusWord StatusWordOf(const std::string& name);

struct CalibrationStatus {
  StatusWord word = StatusWord::kOk;
  std::string why = {}, next_step = {};  // sentences
  friend bool operator==(const CalibrationStatus&, const CalibrationStatus&) = default;
};

// How a sensor's place goes on changing between visits.
enum class DriftLaw { kRandomWalk, kLinear };
// "random_walk", "linear"; what is not known is a random walk.
[[nodiscard]] std::string NameOf(DriftLaw law);
[[nodiscard]] DriftLaw DriftLawOf(const std::string& name);

// The date from which on the odds are 5 % that a sensor is further than the tolerance from where it was left.
struct DriftDue {
  SensorId sensor;
  Stamp at;
  DriftLaw law = DriftLaw::kRandomWalk;  // the likelier of both
  int visits = 0, robots = 0;            // that it was learnt from
  friend bool operator==(const DriftDue&, const DriftDue&) = default;
};

struct SensorStatus {
  SensorId sensor;
  CalibrationStatus status;          // whatever the time: never due, nor overdue
  std::optional<DriftDue> due = {};  // absent: not before the age that the policy allows, or not known
};

// What a revision says of the status of its robot, whatever the time.
struct StatusFacts {
  std::vector<SensorStatus> sensors;  // sorted by id, the reference with them
  std::string site = {};              // that the newest session names in its conditions; empty: none does
  VerdictBasis basis = {};            // of its verdict
};
// The worst of its sensors: ok, drifted or out-of-tolerance; and the earliest of their dates.
[[nodiscard]] CalibrationStatus FoundOf(const StatusFacts& facts);
[[nodiscard]] std::optional<DriftDue> DriftDueOf(const StatusFacts& facts);

// A robot is due from so long before its date on.
inline constexpr std::int64_t kDueSoon_ns = 7LL * 24 * 3600 * 1'000'000'000;

// What a robot's status follows from.
struct StatusBasis {
  int revision = 0;  // the newest; 0: none yet
  Verdict verdict;
  Validity validity;
  CalibrationStatus found = {};  // FoundOf
  std::optional<DriftDue> drift_due = {};
};
// As of `now`. Of several that hold the first of: unknown without a revision, failed, out-of-tolerance, unknown,
// overdue, drifted, due, ok.
[[nodiscard]] CalibrationStatus StatusAt(const StatusBasis& basis, Stamp now);
// Of one sensor of such a robot: what it is itself, or else that its robot is overdue, or that it is due.
[[nodiscard]] CalibrationStatus StatusAt(const SensorStatus& sensor, const Validity& validity, Stamp now);

// The earlier of both; absent: the robot was never calibrated.
[[nodiscard]] std::optional<Stamp> DueAt(const Validity& validity, const std::optional<DriftDue>& drift_due);
// "due 20 Feb 2027 by age; 3 Jan 2027 by drift of lidar_vertical"; empty where there is no date.
[[nodiscard]] std::string DueText(const Validity& validity, const std::optional<DriftDue>& drift_due);

}  // namespace rigcal
