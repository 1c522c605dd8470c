#include "server/model/validity.h"

#include <array>
#include <chrono>

namespace rigcal {

bool IsUsable(const Verdict& verdict) {
  return verdict.level == VerdictLevel::kPass || verdict.level == VerdictLevel::kWarn;
}

std::optional<Stamp> ValidUntil(const Validity& validity) {
  if (!validity.calibrated_at) return std::nullopt;
  return Stamp{validity.calibrated_at->ns + validity.max_age_ns};
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
  if (!valid_until) return "Overdue: nothing of this robot is calibrated. Calibrate it before it is relied on.";
  return "Overdue since " + DayText(*valid_until) + ". Calibrate the robot again before it is relied on.";
}

std::string KeepText(const std::optional<UsableRevision>& usable) {
  if (!usable) return "There is no earlier calibration to fall back to.";
  return "Keep using revision " + std::to_string(usable->number) + " of " + DayText(usable->created_at) + " meanwhile.";
}

}  // namespace rigcal
