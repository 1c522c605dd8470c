#include "client/import/moments_json.h"

namespace rigcal::importing {
namespace {

using formats::JsonField;
using formats::JsonWriter;
using moments::ClockSource;

constexpr std::size_t kClocksMax = 100'000;

std::size_t SizeAt(const JsonField& field, std::string_view key) { return static_cast<std::size_t>(field.At(key).Integer(0, INT64_MAX)); }

void WriteClock(JsonWriter& out, const MomentsTold::Clock& one) {
  out.Text("sensor", one.sensor);
  out.Text("source", NameOf(one.clock.source));
  if (one.clock.source == ClockSource::kUnknown) return out.Null("offset_s");
  out.Integer("at_ns", one.clock.at_ns);
  out.Number("offset_s", one.clock.offset_s);
  out.Number("offset_sigma_s", one.clock.offset_sigma_s);
  out.Number("drift_ratio", one.clock.drift_ratio);
  out.Number("drift_sigma_ratio", one.clock.drift_sigma_ratio);
}

MomentsTold::Clock ClockAt(const JsonField& field) {
  MomentsTold::Clock one{field.At("sensor").Text(), {}};
  one.clock.source = moments::ClockSourceOf(field.At("source").Text()).value_or(ClockSource::kUnknown);
  if (one.clock.source == ClockSource::kUnknown) return one;
  one.clock.at_ns = field.At("at_ns").Integer(INT64_MIN, INT64_MAX);
  one.clock.offset_s = field.At("offset_s").Number();
  one.clock.offset_sigma_s = field.At("offset_sigma_s").Number();
  one.clock.drift_ratio = field.At("drift_ratio").Number();
  one.clock.drift_sigma_ratio = field.At("drift_sigma_ratio").Number();
  return one;
}

void WriteFigures(JsonWriter& out, const MomentsTold& told) {
  out.Integer("all", static_cast<std::int64_t>(told.moments));
  out.Integer("chosen", static_cast<std::int64_t>(told.chosen));
  out.Object("left_out", [&] {
    for (std::size_t i = 0; i < told.left_out.size(); ++i)
      out.Integer(NameOf(static_cast<moments::LeftOut>(i)), static_cast<std::int64_t>(told.left_out[i]));
  });
  out.Number("motion_px_max", told.limits.motion_px);
  out.Number("motion_m_max", told.limits.motion_m);
  out.Number("kept_motion_px", told.worst_kept_px);
  out.Number("kept_motion_m", told.worst_kept_m);
  out.Number("left_out_motion_px", told.usual_motion_px);
  out.Number("left_out_motion_m", told.usual_motion_m);
  out.Number("least_left_out_motion_px", told.least_motion_px);
  out.Number("least_left_out_motion_m", told.least_motion_m);
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
  for (std::size_t i = 0; i < told.left_out.size(); ++i) told.left_out[i] = SizeAt(left_out, NameOf(static_cast<moments::LeftOut>(i)));
  told.limits.motion_px = figures.At("motion_px_max").Number();
  told.limits.motion_m = figures.At("motion_m_max").Number();
  told.worst_kept_px = figures.At("kept_motion_px").Number();
  told.worst_kept_m = figures.At("kept_motion_m").Number();
  told.usual_motion_px = figures.At("left_out_motion_px").Number();
  told.usual_motion_m = figures.At("left_out_motion_m").Number();
  told.least_motion_px = figures.At("least_left_out_motion_px").Number();
  told.least_motion_m = figures.At("least_left_out_motion_m").Number();
  for (const JsonField& clock : outcome.At("clocks").Items(kClocksMax)) told.clocks.push_back(ClockAt(clock));
  return told;
}

}  // namespace rigcal::importing
