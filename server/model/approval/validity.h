// Whether a robot may rely on its calibration: how old it is, which revision may be used, what is on its way.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/diagnosis.h"

namespace rigcal {

// A calibration older than this is overdue, unless a policy says otherwise.
inline constexpr std::int64_t kDefaultMaxAge_ns = 90LL * 24 * 3600 * 1'000'000'000;

// A revision whose verdict is pass or warn.
struct UsableRevision {
  int number = 0;
  Stamp created_at;                             // when it was solved: no date of what was measured
  std::optional<Stamp> calibrated_at = {};      // as in Validity, of this one
  std::int64_t max_age_ns = kDefaultMaxAge_ns;  // likewise
  friend bool operator==(const UsableRevision&, const UsableRevision&) = default;
};

struct Validity {
  std::optional<Stamp> calibrated_at;         // as of when all of its sensors were measured; absent: it counts nothing
  bool overdue = false;                       // now
  std::optional<UsableRevision> usable = {};  // the newest; absent: there is none to fall back to
  bool calculating = false;                   // something arrived that the newest revision does not hold
  std::string given_up = {};  // a sentence with the cure, where that could not be solved; then not calculating
  std::int64_t max_age_ns = kDefaultMaxAge_ns;  // of the policy that judged the revision
  bool approved = true;                   // false: it passed or warned, and nobody approved it, or it was rolled back
  std::optional<int> superseded_by = {};  // the robot's newest revision, where it takes this one's place
};

// Two sensors that a measurement ties, and when it was made.
struct DatedTie {
  SensorId a, b;
  Stamp measured_at;
};
// As of when all of these sensors are measured: the newest moment such that what was measured from then on ties them
// all together. What nothing ties is left out; absent: nothing ties any two.
[[nodiscard]] std::optional<Stamp> MeasuredThroughout(std::vector<DatedTie> ties, const std::set<SensorId>& sensors);

// Whether a robot may drive by it: pass or warn.
[[nodiscard]] bool IsUsable(const Verdict& verdict);
// Whether the revision of that verdict and number is what robots are to have, `usable`; of a fail and of what is not
// known nobody asks.
[[nodiscard]] bool IsApproved(const Verdict& verdict, int revision, const std::optional<UsableRevision>& usable);
// The moment from which it is overdue; absent: it counts nothing.
[[nodiscard]] std::optional<Stamp> ValidUntil(const Validity& validity);
// What was never calibrated is overdue.
[[nodiscard]] bool IsOverdue(const std::optional<Stamp>& calibrated_at, std::int64_t max_age_ns, Stamp now);

// For people: "31 Jan 2026", in UTC; and sentences.
[[nodiscard]] std::string DayText(Stamp stamp);
[[nodiscard]] std::string OverdueText(const std::optional<Stamp>& valid_until);
// "revision 4, measured 12 Mar 2026"; without a date where it counts nothing.
[[nodiscard]] std::string MeasuredText(const UsableRevision& revision);
[[nodiscard]] std::optional<Stamp> ValidUntil(const UsableRevision& revision);
// Of a revision that is neither pass nor warn. What a fail contradicts may be what the robot has.
[[nodiscard]] std::string KeepText(VerdictLevel level, const std::optional<UsableRevision>& usable);
inline constexpr const char* kCalculatingText = "A newer revision is being calculated.";

}  // namespace rigcal
