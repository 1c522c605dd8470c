#include "server/model/approval/validity.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <map>

namespace rigcal {

namespace {

// Sensors that are tied together so far, by a name that they share.
class TiedGroups {
 public:
  // False where they were tied before.
  bool Tie(const SensorId& a, const SensorId& b) {
    const SensorId of_a = GroupOf(a), of_b = GroupOf(b);
    if (of_a != of_b) parent_[of_a] = of_b;
    return of_a != of_b;
  }

 private:
  SensorId GroupOf(SensorId sensor) {
    while (parent_.try_emplace(sensor, sensor).first->second != sensor) sensor = parent_[sensor];
    return sensor;
  }
  std::map<SensorId, SensorId> parent_;
};

}  // namespace

std::optional<Stamp> MeasuredThroughout(std::vector<DatedTie> ties, const std::set<SensorId>& sensors) {
  std::stable_sort(ties.begin(), ties.end(),
                   [](const DatedTie& x, const DatedTie& y) { return y.measured_at < x.measured_at; });
  TiedGroups groups;
  std::optional<Stamp> oldest;
  for (const DatedTie& tie : ties)
    if (sensors.contains(tie.a) && sensors.contains(tie.b) && groups.Tie(tie.a, tie.b)) oldest = tie.measured_at;
  return oldest;
}

bool IsUsable(const Verdict& verdict) {
  return verdict.level == VerdictLevel::kPass || verdict.level == VerdictLevel::kWarn;
}

bool IsApproved(const Verdict& verdict, int revision, const std::optional<UsableRevision>& usable) {
  return !IsUsable(verdict) || (usable && usable->number == revision);
}

std::optional<Stamp> ValidUntil(const Validity& validity) {
  if (!validity.calibrated_at) return std::nullopt;
  return Stamp{validity.calibrated_at->ns + validity.max_age_ns};
}

std::optional<Stamp> ValidUntil(const UsableRevision& revision) {
  if (!revision.calibrated_at) return std::nullopt;
  return Stamp{revision.calibrated_at->ns + revision.max_age_ns};
}

bool IsOverdue(const std::optional<Stamp>& calibrated_at, std::int64_t max_age_ns, Stamp now) {
  return !calibrated_at || now.ns - calibrated_at->ns > max_age_ns;
}

std::string DayText(Stamp stamp) {
  constexpr std::array kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const std::chrono::sys_time<std::chrono::nanoseconds> time{std::chrono::nanoseconds(stamp.ns)};
  const std::chrono::year_month_day date(std::chrono::floor<std::chrono::days>(time));
  return std::to_string(static_cast<unsigned>(date.day())) + " " + kMonths[static_cast<unsigned>(date.month()) - 1] +
         " " + std::to_string(static_cast<int>(date.year()));
}

std::string OverdueText(const std::optional<Stamp>& valid_until) {
  if (!valid_until) return "Nothing of this robot is calibrated yet. Calibrate it before it is relied on.";
  return "Overdue since " + DayText(*valid_until) + ". Calibrate the robot again before it is relied on.";
}

std::string MeasuredText(const UsableRevision& revision) {
  const std::string number = "revision " + std::to_string(revision.number);
  return revision.calibrated_at ? number + ", measured " + DayText(*revision.calibrated_at) : number;
}

std::string KeepText(VerdictLevel level, const std::optional<UsableRevision>& usable) {
  if (!usable) return "There is no earlier calibration to fall back to.";
  const std::string revision = MeasuredText(*usable);
  if (level == VerdictLevel::kFail)
    return "Robots that listen still have " + revision + ": do not rely on it, either, until this is cleared up.";
  // The sentence may be read at any later time.
  const std::optional<Stamp> until = ValidUntil(*usable);
  return "Keep using " + revision + (until ? ", until " + DayText(*until) : " meanwhile") +
         ", but for what is not verified here.";
}

}  // namespace rigcal
