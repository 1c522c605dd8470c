#include "server/fleet/wording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace rigcal::fleet {
namespace {

constexpr std::size_t kNamesMax = 6;

std::string Rounded(const char* format, double value, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value, unit);
  return text.data();
}

// Less than a millionth of a millimetre or degree is arithmetic, not a disagreement.
std::string Amount(double value, const char* unit) { return Number(value < 1e-6 ? 0.0 : value, unit); }

std::string LengthOf(const Vector6d& e) { return Amount(1e3 * e.head<3>().norm(), "mm"); }
std::string AngleOf(const Vector6d& e) { return Amount(kDegreesPerRadian * e.tail<3>().norm(), "deg"); }

}  // namespace

std::string Number(double value, const char* unit) {
  return Rounded(std::abs(value) < 100.0 ? "%.3g %s" : "%.0f %s", value, unit);
}

std::string TwoDigits(double value, const char* unit) {
  return Rounded(std::abs(value) < 9.95 ? "%.2g %s" : "%.0f %s", value, unit);
}

std::string PlainNumber(double value) {
  std::string text = Number(value, "");
  text.pop_back();
  return text;
}

namespace {

std::string ListUpTo(std::size_t shown_max, const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), shown_max);
  std::string text;
  for (std::size_t k = 0; k < shown; ++k) {
    const bool last = k + 1 == names.size();
    if (k > 0) text += last ? " and " : ", ";
    text += names[k];
  }
  if (names.size() > shown) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

std::vector<std::string> NamesOf(const std::vector<SensorId>& sensors) {
  std::vector<std::string> names;
  for (const SensorId& sensor : sensors) names.push_back(sensor.str());
  return names;
}

}  // namespace

std::string List(const std::vector<std::string>& names) { return ListUpTo(kNamesMax, names); }
std::string List(const std::vector<SensorId>& sensors) { return List(NamesOf(sensors)); }
std::string ListAll(const std::vector<SensorId>& sensors) { return ListUpTo(sensors.size(), NamesOf(sensors)); }

std::string NameOfEdge(const Edge& edge) { return edge.frame_a.str() + " - " + edge.frame_b.str(); }

std::string OffText(const Vector6d& e) { return LengthOf(e) + " and " + AngleOf(e); }
std::string OffList(const Vector6d& e) { return LengthOf(e) + ", " + AngleOf(e); }

std::string SigmaText(double sigma_m, double sigma_rad) {
  return TwoDigits(1e3 * sigma_m, "mm") + " and " + TwoDigits(kDegreesPerRadian * sigma_rad, "deg");
}

std::string LimitText(const PoseLimit& limit) { return SigmaText(limit.m, limit.rad); }

DecidingFigure OffFigure(std::string name, const Vector6d& off, const PoseLimit& limit) {
  const bool is_shift = off.head<3>().norm() / limit.m >= off.tail<3>().norm() / limit.rad;
  return {std::move(name), is_shift ? LengthOf(off) : AngleOf(off),
          "limit " + (is_shift ? TwoDigits(1e3 * limit.m, "mm") : TwoDigits(kDegreesPerRadian * limit.rad, "deg"))};
}

DecidingFigure SigmaFigure(std::string name, double sigma_m, double sigma_rad, const PoseLimit& limit) {
  const bool is_shift = sigma_m / limit.m >= sigma_rad / limit.rad;
  const char* unit = is_shift ? "mm" : "deg";
  const double scale = is_shift ? 1e3 : kDegreesPerRadian;
  return {std::move(name), TwoDigits(scale * (is_shift ? sigma_m : sigma_rad), unit),
          "limit " + TwoDigits(scale * (is_shift ? limit.m : limit.rad), unit)};
}

namespace {

std::string TimeOf(Stamp stamp) {
  constexpr std::size_t kDay = 10, kToMinute = 16;
  constexpr std::int64_t kDay_ns = 86'400'000'000'000;
  if (stamp.ns % kDay_ns == 0) return ToIso(stamp).substr(0, kDay);
  return ToIso(stamp).substr(0, kToMinute).replace(kDay, 1, " ") + " UTC";
}

}  // namespace

std::string NameOfSession(const SessionId& session, const std::map<SessionId, Stamp>& captured_at) {
  constexpr std::size_t kDigits = 12;  // as pages show them
  const std::string id = session.str().substr(0, kDigits);
  const auto found = captured_at.find(session);
  if (found == captured_at.end()) return id;
  const std::string time = TimeOf(found->second);
  const auto alike = std::count_if(captured_at.begin(), captured_at.end(),
                                   [&](const auto& one) { return TimeOf(one.second) == time; });
  return time + (alike > 1 ? " (" + id + ")" : "");
}

}  // namespace rigcal::fleet
