#include "server/formats/revision/moved_fields.h"

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

template <typename Id>
void WriteUnlessNone(JsonWriter& out, std::string_view key, const Id& id) {
  if (!id.empty()) out.Text(key, id.str());
}

}  // namespace

void WriteMoved(JsonWriter& out, const SensorMovedWithin& moved) {
  out.Text("first_after", moved.first_after.str());
  out.Text("last_before", moved.last_before.str());
  if (moved.lens)
    out.Object("lens", [&] {
      out.Number("focal_ratio", moved.lens->focal_ratio);
      out.Number("sigma_ratio", moved.lens->sigma_ratio);
      out.Flag("surely", moved.lens->surely);
    });
  out.Number("odds", moved.odds);
  WriteUnlessNone(out, "or_board", moved.or_board);
  WriteUnlessNone(out, "or_sensor", moved.or_sensor);
  WriteUnlessNone(out, "or_world_of", moved.or_world_of);
  out.Text("sensor", moved.sensor.str());
  WriteVector(out, "step", moved.step);
}

SensorMovedWithin ReadMoved(const JsonField& field) {
  SensorMovedWithin moved{ReadId<SensorId>(field.At("sensor")), ReadId<CaptureId>(field.At("last_before")),
                          ReadId<CaptureId>(field.At("first_after")), ReadVector(field.At("step")),
                          field.At("odds").Number()};
  if (const auto lens = field.Find("lens"))  // documents of before have none
    moved.lens = {lens->At("focal_ratio").Number(), lens->At("sigma_ratio").Number(), lens->At("surely").Flag()};
  moved.or_sensor = ReadOptionalId<SensorId>(field, "or_sensor");
  moved.or_board = ReadOptionalId<TargetId>(field, "or_board");
  moved.or_world_of = ReadOptionalId<SensorId>(field, "or_world_of");
  return moved;
}

void WriteBoardMoved(JsonWriter& out, const BoardMovedWithin& moved) {
  WriteUnlessNone(out, "board", moved.board);
  out.Text("first_after", moved.first_after.str());
  out.Text("last_before", moved.last_before.str());
  out.Number("odds", moved.odds);
  WriteUnlessNone(out, "or_board", moved.or_board);
  WriteVector(out, "step", moved.step);
  WriteUnlessNone(out, "world_of", moved.world_of);
}

BoardMovedWithin ReadBoardMoved(const JsonField& field) {
  const auto world_of = ReadOptionalId<SensorId>(field, "world_of");
  return {world_of.empty() ? ReadId<TargetId>(field.At("board")) : TargetId(),
          ReadId<CaptureId>(field.At("last_before")),
          ReadId<CaptureId>(field.At("first_after")),
          ReadVector(field.At("step")),
          field.At("odds").Number(),
          ReadOptionalId<TargetId>(field, "or_board"),
          world_of};
}

}  // namespace rigcal::formats
