#include "server/formats/revision/suspects_fields.h"

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

void WriteSuspectEdge(JsonWriter& out, const SuspectEdge& suspect) {
  out.Object([&] {
    out.Text("edge", suspect.edge.str());
    out.Text("frame_a", suspect.frame_a.str());
    out.Text("frame_b", suspect.frame_b.str());
    WriteVector(out, "e", suspect.e);
    out.Number("statistic", suspect.statistic);
    out.Number("limit", suspect.limit);
    WriteIds(out, "alternatives", suspect.alternatives);
  });
}

void WriteTwoPoses(JsonWriter& out, const TwoPoses& two) {
  out.Object([&] {
    out.Text("sensor", two.sensor.str());
    WriteIds(out, "group_a", two.group_a);
    WriteIds(out, "group_b", two.group_b);
    WriteVector(out, "difference", two.difference);
  });
}

SuspectEdge ReadSuspectEdge(const JsonField& field) {
  SuspectEdge suspect;
  suspect.edge = ReadId<EdgeId>(field.At("edge"));
  suspect.frame_a = ReadId<SensorId>(field.At("frame_a"));
  suspect.frame_b = ReadId<SensorId>(field.At("frame_b"));
  suspect.e = ReadVector(field.At("e"));
  suspect.statistic = field.At("statistic").Number();
  suspect.limit = field.At("limit").Number();
  suspect.alternatives = ReadIds<EdgeId>(field.At("alternatives"), limits::kEdgesPerBatchMax);
  return suspect;
}

TwoPoses ReadTwoPoses(const JsonField& field) {
  TwoPoses two;
  two.sensor = ReadId<SensorId>(field.At("sensor"));
  two.group_a = ReadIds<EdgeId>(field.At("group_a"), limits::kEdgesPerBatchMax);
  two.group_b = ReadIds<EdgeId>(field.At("group_b"), limits::kEdgesPerBatchMax);
  two.difference = ReadVector(field.At("difference"));
  return two;
}

}  // namespace

void WriteSuspects(JsonWriter& out, std::string_view key, const Suspects& suspects) {
  out.Object(key, [&] {
    out.Flag("judged", suspects.judged);
    out.List("edges", [&] {
      for (const SuspectEdge& suspect : suspects.edges) WriteSuspectEdge(out, suspect);
    });
    out.List("two_poses", [&] {
      for (const TwoPoses& two : suspects.two_poses) WriteTwoPoses(out, two);
    });
  });
}

Suspects ReadSuspects(const JsonField& field) {
  Suspects suspects;
  suspects.judged = field.At("judged").Flag();
  for (const JsonField& suspect : field.At("edges").Items(limits::kEdgesPerBatchMax))
    suspects.edges.push_back(ReadSuspectEdge(suspect));
  for (const JsonField& two : field.At("two_poses").Items(limits::kSensorsPerRobotMax))
    suspects.two_poses.push_back(ReadTwoPoses(two));
  return suspects;
}

}  // namespace rigcal::formats
