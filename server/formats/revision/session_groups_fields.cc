#include "server/formats/revision/session_groups_fields.h"

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kCapturesMax = 10'000'000, kRowsMax = 10'000;

CaptureGroup ReadGroup(const JsonField& field) {
  return {ReadIds<CaptureId>(field.At("captures"), kCapturesMax), ReadOptionalId<SensorId>(field, "sensor"),
          field.At("sigmas").Number()};
}

ResidualNoise ReadNoise(const JsonField& field) {
  return {ReadId<SensorId>(field.At("sensor")), field.At("corner_px").Number(), field.At("range_ratio").Number(),
          field.At("position_m").Number(), field.At("rotation_rad").Number()};
}

}  // namespace

void WriteGroups(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.groups.empty()) return;
  out.List("groups", [&] {
    for (const CaptureGroup& group : estimate.groups)
      out.Object([&] {
        WriteIds(out, "captures", group.captures);
        if (!group.sensor.empty()) out.Text("sensor", group.sensor.str());
        out.Number("sigmas", group.sigmas);
      });
  });
}

void WriteNoise(JsonWriter& out, const SessionEstimate& estimate) {
  if (estimate.noise.empty()) return;
  out.List("noise", [&] {
    for (const ResidualNoise& noise : estimate.noise)
      out.Object([&] {
        out.Number("corner_px", noise.corner_px);
        out.Number("position_m", noise.position_m);
        out.Number("range_ratio", noise.range_ratio);
        out.Number("rotation_rad", noise.rotation_rad);
        out.Text("sensor", noise.sensor.str());
      });
  });
}

void ReadGroupsAndNoise(const JsonField& root, SessionEstimate& estimate) {
  if (const auto groups = root.Find("groups"))
    for (const JsonField& group : groups->Items(kRowsMax)) estimate.groups.push_back(ReadGroup(group));
  if (const auto noise = root.Find("noise"))
    for (const JsonField& one : noise->Items(kRowsMax)) estimate.noise.push_back(ReadNoise(one));
}

}  // namespace rigcal::formats
