#include "client/import/moments_json.h"

#include <span>

namespace rigcal::importing {
namespace {

using formats::JsonField;
using formats::JsonWriter;
using moments::ClockSource;

constexpr std::size_t kClocksMax = 100'000;

// A number as a document names it, and where it stands in the value: written and read by one list.
template <typename T>
struct NumberMember {
  const char* key;
  double T::*value;
};
constexpr NumberMember<moments::SensorClock> kClockNumbers[] = {
    {"offset_s", &moments::SensorClock::offset_s},
    {"offset_sigma_s", &moments::SensorClock::offset_sigma_s},
    {"drift_ratio", &moments::SensorClock::drift_ratio},
    {"drift_sigma_ratio", &moments::SensorClock::drift_sigma_ratio}};
constexpr NumberMember<moments::MomentLimits> kLimitNumbers[] = {{"motion_px_max", &moments::MomentLimits::motion_px},
                                                                 {"motion_m_max", &moments::MomentLimits::motion_m}};
constexpr NumberMember<MomentsTold> kMotionNumbers[] = {{"kept_motion_px", &MomentsTold::worst_kept_px},
                                                        {"kept_motion_m", &MomentsTold::worst_kept_m},
                                                        {"left_out_motion_px", &MomentsTold::usual_motion_px},
                                                        {"left_out_motion_m", &MomentsTold::usual_motion_m},
                                                        {"least_left_out_motion_px", &MomentsTold::least_motion_px},
                                                        {"least_left_out_motion_m", &MomentsTold::least_motion_m}};

template <typename T>
void WriteNumbers(JsonWriter& out, std::span<const NumberMember<T>> members, const T& from) {
  for (const NumberMember<T>& member : members) out.Number(member.key, from.*member.value);
}
template <typename T>
void ReadNumbers(const JsonField& field, std::span<const NumberMember<T>> members, T& to) {
  for (const NumberMember<T>& member : members) to.*member.value = field.At(member.key).Number();
}

std::size_t SizeAt(const JsonField& field, std::string_view key) {
  return static_cast<std::size_t>(field.At(key).Integer(0, INT64_MAX));
}

void WriteClock(JsonWriter& out, const MomentsTold::Clock& one) {
  out.Text("sensor", one.sensor);
  out.Text("source", NameOf(one.clock.source));
  if (one.clock.source == ClockSource::kUnknown) return out.Null("offset_s");
  out.Integer("at_ns", one.clock.at_ns);
  WriteNumbers<moments::SensorClock>(out, kClockNumbers, one.clock);
}

MomentsTold::Clock ClockAt(const JsonField& field) {
  MomentsTold::Clock one{field.At("sensor").Text(), {}};
  one.clock.source = moments::ClockSourceOf(field.At("source").Text()).value_or(ClockSource::kUnknown);
  if (one.clock.source == ClockSource::kUnknown) return one;
  one.clock.at_ns = field.At("at_ns").Integer(INT64_MIN, INT64_MAX);
  ReadNumbers<moments::SensorClock>(field, kClockNumbers, one.clock);
  return one;
}

void WriteFigures(JsonWriter& out, const MomentsTold& told) {
  out.Integer("all", static_cast<std::int64_t>(told.moments));
  out.Integer("chosen", static_cast<std::int64_t>(told.chosen));
  out.Object("left_out", [&] {
    for (std::size_t i = 0; i < told.left_out.size(); ++i)
      out.Integer(NameOf(static_cast<moments::LeftOut>(i)), static_cast<std::int64_t>(told.left_out[i]));
  });
  WriteNumbers<moments::MomentLimits>(out, kLimitNumbers, told.limits);
  WriteNumbers<MomentsTold>(out, kMotionNumbers, told);
  out.Text("text", MomentsText(told));
}

}  // namespace

void WriteMoments(JsonWriter& out, const MomentsTold& told) {
  out.Object("moments", [&] { WriteFigures(out, told); });
  out.List("clocks", [&] {
    for (const MomentsTold::Clock& one : told.clocks) out.Object([&] { WriteClock(out, one); });
  });
}

MomentsTold MomentsAt(const JsonField& outcome) {
  const JsonField figures = outcome.At("moments");
  MomentsTold told;
  told.moments = SizeAt(figures, "all");
  told.chosen = SizeAt(figures, "chosen");
  const JsonField left_out = figures.At("left_out");
  for (std::size_t i = 0; i < told.left_out.size(); ++i)
    told.left_out[i] = SizeAt(left_out, NameOf(static_cast<moments::LeftOut>(i)));
  ReadNumbers<moments::MomentLimits>(figures, kLimitNumbers, told.limits);
  ReadNumbers<MomentsTold>(figures, kMotionNumbers, told);
  for (const JsonField& clock : outcome.At("clocks").Items(kClocksMax)) told.clocks.push_back(ClockAt(clock));
  return told;
}

}  // namespace rigcal::importing
