#include "server/formats/revision/verdict_basis_fields.h"

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kReasonsMax = 100'000;

void WriteSensorNames(JsonWriter& out, std::string_view key, const std::vector<SensorId>& sensors) {
  if (sensors.empty()) return;
  out.List(key, [&] {
    for (const SensorId& sensor : sensors) out.Text(sensor.str());
  });
}

std::vector<SensorId> ReadSensorNames(const JsonField& parent, const char* key) {
  std::vector<SensorId> sensors;
  const auto field = parent.Find(key);
  if (!field) return sensors;
  for (const JsonField& sensor : field->Items(limits::kSensorsPerRobotMax)) sensors.push_back(ReadId<SensorId>(sensor));
  return sensors;
}

void WriteDecidingFigure(JsonWriter& out, const DecidingFigure& figure) {
  if (figure.name.empty()) return;
  out.Object("decided_by", [&] {
    out.Text("limit", figure.limit);
    out.Text("name", figure.name);
    out.Text("value", figure.value);
  });
}

DecidingFigure ReadDecidingFigure(const JsonField& parent) {
  const auto figure = parent.Find("decided_by");
  if (!figure) return {};
  return {figure->At("name").Text(), figure->At("value").Text(), figure->At("limit").Text()};
}

void WriteReasons(JsonWriter& out, const std::vector<VerdictReason>& reasons) {
  if (reasons.empty()) return;
  out.List("reasons", [&] {
    for (const VerdictReason& reason : reasons)
      out.Object([&] {
        out.Text("what_to_do", reason.what_to_do);
        out.Text("why", reason.why);
      });
  });
}

std::vector<VerdictReason> ReadReasons(const JsonField& parent) {
  std::vector<VerdictReason> reasons;
  const auto field = parent.Find("reasons");
  if (!field) return reasons;
  for (const JsonField& reason : field->Items(kReasonsMax))
    reasons.push_back({reason.At("why").Text(), reason.At("what_to_do").Text()});
  return reasons;
}

void WriteHardlyChecked(JsonWriter& out, const std::vector<HardlyChecked>& edges) {
  if (edges.empty()) return;
  out.List("hardly_checked", [&] {
    for (const HardlyChecked& one : edges)
      out.Object([&] {
        out.Text("edge", one.edge.str());
        out.Text("what", one.what);
      });
  });
}

std::vector<HardlyChecked> ReadHardlyChecked(const JsonField& parent) {
  std::vector<HardlyChecked> edges;
  const auto field = parent.Find("hardly_checked");
  if (!field) return edges;
  for (const JsonField& one : field->Items(limits::kEdgesPerBatchMax))
    edges.push_back({ReadId<EdgeId>(one.At("edge")), one.At("what").Text()});
  return edges;
}

}  // namespace

void WriteVerdictBasis(JsonWriter& out, const VerdictBasis& basis) {
  if (basis.empty()) return;
  out.Object("verdict_basis", [&] {
    WriteSensorNames(out, "culprits", basis.culprits);
    WriteDecidingFigure(out, basis.decided_by);
    WriteSensorNames(out, "doubted", basis.doubted);
    WriteHardlyChecked(out, basis.hardly_checked);
    WriteReasons(out, basis.reasons);
  });
}

VerdictBasis ReadVerdictBasis(const JsonField& root) {
  const auto basis = root.Find("verdict_basis");
  if (!basis) return {};
  return {ReadSensorNames(*basis, "culprits"), ReadSensorNames(*basis, "doubted"), ReadDecidingFigure(*basis),
          ReadReasons(*basis), ReadHardlyChecked(*basis)};
}

}  // namespace rigcal::formats
