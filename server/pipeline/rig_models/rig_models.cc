#include "server/pipeline/rig_models/rig_models.h"

#include <map>
#include <set>

#include "server/base/text.h"
#include "server/fleet/causes/rig_causes.h"
#include "server/formats/rig_models/rig_model_yaml.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/unknown_names.h"
#include "storage/sessions/retired.h"
#include "storage/settings/policies.h"
#include "storage/settings/rig_models.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

Result<std::int64_t> CountOfRobots(storage::Store& store, const std::string& model) {
  RIGCAL_ASSIGN(const auto robots, storage::LoadRobotsOfModel(store, model, kRobotsOfModelMax));
  return static_cast<std::int64_t>(robots.size());
}

}  // namespace

Result<ExpectedRig> LoadExpectedRig(storage::Store& store, const std::string& rig_model) {
  ExpectedRig expected;
  RIGCAL_ASSIGN(expected.watermark, storage::LoadRigModelWatermark(store));
  if (rig_model.empty()) return expected;
  RIGCAL_ASSIGN(const auto version, storage::LoadRigModelVersion(store, rig_model));
  if (!version) return expected;
  RIGCAL_ASSIGN(expected.model, formats::ReadRigModel(version->text, "rig model " + rig_model));
  expected.version = version->version;
  return expected;
}

Result<std::string> LoadLacking(storage::Store& store, const RobotId& robot, const SessionHeader& header) {
  std::string lacking;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const ExpectedRig expected, LoadExpectedRig(store, header.rig_model));
    RIGCAL_ASSIGN(const auto gone, storage::LoadRetiredSensors(store, robot));
    std::set<SensorId> retired;
    for (const auto& [sensor, standing] : gone) retired.insert(sensor);
    lacking = fleet::LackingOf(header, expected.model, retired);
    return {};
  }));
  return lacking.empty() ? lacking : lacking + ".";
}

Result<std::string> RequiredRigModel(const Parameters& parameters) {
  constexpr std::size_t kModelBytesMax = 1024;
  const std::string model = parameters.Text("model").value_or("");
  if (!model.empty() && model.size() <= kModelBytesMax && IsPrintableUtf8(model)) return model;
  return Fail(ErrorCode::kInvalidInput, Quoted(model) + " is no rig model", "Give what session.yaml has as rig_model.");
}

Status CheckRigModelKnown(storage::Store& store, const std::string& model, const char* cure) {
  RIGCAL_ASSIGN(const auto version, storage::LoadRigModelVersion(store, model));
  if (version) return {};
  RIGCAL_ASSIGN(const bool is_named, storage::HasRigModel(store, model));
  if (is_named) return {};
  const Error unknown = UnknownModel(store, model);
  return Fail(unknown.code, unknown.what, cure == nullptr ? unknown.cure : cure);
}

Result<std::string> TellRigModel(storage::Store& store, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::string model, RequiredRigModel(parameters));
  formats::RigModelAnswer answer;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_TRY(CheckRigModelKnown(store, model, kListRigModels));
    RIGCAL_ASSIGN(const auto version, storage::LoadRigModelVersion(store, model));
    if (!version)
      return Fail(ErrorCode::kNotFound, "nobody has set rig model " + Quoted(model) + ", though sessions name it",
                  "Write it and give it to `rigcal model set FILE --reason TEXT`; docs/rig-models.md says how.");
    answer.set = *version;
    RIGCAL_ASSIGN(answer.robots, CountOfRobots(store, model));
    return {};
  }));
  RIGCAL_ASSIGN(answer.model, formats::ReadRigModel(answer.set.text, "rig model " + model));
  return formats::WriteRigModel(answer);
}

Result<std::vector<formats::RigModelRow>> LoadRigModelRows(storage::Store& store) {
  std::map<std::string, formats::RigModelRow> rows;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto named, storage::LoadRigModels(store, kRigModelsMax));
    for (const std::string& name : named) rows[name].name = name;
    RIGCAL_ASSIGN(const auto versions, storage::LoadRigModelVersions(store, kRigModelsMax));
    for (const RigModelVersion& version : versions) rows[version.name] = {version.name, version.version, 0};
    for (auto& [name, row] : rows) {
      RIGCAL_ASSIGN(row.robots, CountOfRobots(store, name));
    }
    return {};
  }));
  std::vector<formats::RigModelRow> list;
  for (auto& [name, row] : rows) list.push_back(std::move(row));
  return list;
}

Result<std::string> ListRigModels(storage::Store& store) {
  RIGCAL_ASSIGN(const auto rows, LoadRigModelRows(store));
  return formats::WriteRigModels(rows);
}

Result<OrderDone> SetRigModel(storage::Store& store, const Clock& clock, const Parameters& parameters) {
  RIGCAL_ASSIGN(const Word word, RequiredWord(parameters, clock.Now(), "Say who sets it.", "Say why it is so."));
  const std::string text = parameters.Text("text").value_or("");
  RIGCAL_ASSIGN(const RigModel model, formats::ReadRigModel(text, "the rig model"));
  RIGCAL_ASSIGN(const bool is_new_model, parameters.Flag("new_model"));
  if (!is_new_model) RIGCAL_TRY(CheckRigModelKnown(store, model.name));
  RigModelVersion set;
  std::int64_t waiting = 0;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(set, storage::AppendRigModel(store, model.name, text, word));
    RIGCAL_ASSIGN(waiting, storage::CountRobotsOfModelToJudge(store, set.number));
    return {};
  }));
  return OrderDone{RobotId(), formats::WriteRigModelSet(set, waiting)};
}

}  // namespace rigcal::pipeline
