#include "server/pipeline/rig_models/begin_epoch.h"

#include <algorithm>
#include <set>

#include "server/formats/rig_models/rig_model_answers.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/unknown_names.h"
#include "storage/edges/edges.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

constexpr std::int64_t kSaidTwice_ns = 60'000'000'000;

Result<std::set<SensorId>> NamesAsked(const std::string& text) {
  std::set<SensorId> names;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    RIGCAL_ASSIGN(SensorId name, SensorId::Parse(text.substr(start, end - start)));
    names.insert(std::move(name));
    start = end + 1;
  }
  return names;
}

// Those that are named; without a name all that the robot has.
Result<std::vector<SensorId>> SensorsAsked(storage::Store& store, const RobotId& robot, const Parameters& parameters) {
  const std::string text = parameters.Text("sensors").value_or("");
  RIGCAL_ASSIGN(const std::vector<SensorId> known, storage::LoadSensorsOf(store, robot));
  if (text.empty() && known.empty())
    return Fail(ErrorCode::kNotFound, "nothing was measured of robot " + robot.str() + " yet",
                "There is no epoch to begin: its first session begins one.");
  if (text.empty()) return known;
  RIGCAL_ASSIGN(const std::set<SensorId> named, NamesAsked(text));
  for (const SensorId& sensor : named) {
    if (!std::binary_search(known.begin(), known.end(), sensor)) return Fail(UnknownSensor(robot, sensor, known));
  }
  return std::vector<SensorId>(named.begin(), named.end());
}

// As it was said a moment ago, where it was: then a repeated order changes nothing.
Result<Stamp> BeginsNow(storage::Store& store, const RobotId& robot, const Word& word) {
  RIGCAL_ASSIGN(const auto epochs, storage::LoadEpochs(store, robot));
  for (const Epoch& epoch : epochs) {
    const bool is_same = epoch.cause == EpochCause::kPerson && epoch.begins_at == epoch.word.at &&
                         epoch.word.who == word.who && epoch.word.reason == word.reason;
    if (is_same && word.at.ns - epoch.word.at.ns < kSaidTwice_ns && word.at >= epoch.word.at) return epoch.begins_at;
  }
  return word.at;
}

Result<Stamp> BeginsAt(storage::Store& store, const RobotId& robot, const Parameters& parameters, const Word& word) {
  if (const auto at = parameters.Text("at")) return ParseIso(*at);
  return BeginsNow(store, robot, word);
}

Status TakeBack(storage::Store& store, const std::vector<SensorId>& sensors, formats::EpochAnswer& answer) {
  RIGCAL_ASSIGN(const auto taken, storage::TakeBackEpoch(store, answer.robot, sensors, answer.word));
  for (const Epoch& epoch : taken) {
    answer.sensors.push_back(epoch.sensor);
    answer.begins_at = epoch.begins_at;
  }
  answer.taken_back = true;
  if (!taken.empty()) return {};
  return Fail(ErrorCode::kNotFound, "nobody began an epoch of these sensors of robot " + answer.robot.str(),
              "`rigcal history " + answer.robot.str() +
                  "` lists its epochs. One that a session began goes when the session, "
                  "corrected, is pushed again.");
}

}  // namespace

Result<OrderDone> BeginEpochBy(storage::Store& store, const Clock& clock, const Parameters& parameters) {
  formats::EpochAnswer answer;
  answer.word = {clock.Now(), "", ""};
  RIGCAL_ASSIGN(answer.word.who, RequiredWho(parameters, "Say who says so."));
  RIGCAL_ASSIGN(answer.word.reason, RequiredText(parameters, "reason", "Say what was done to it."));
  RIGCAL_ASSIGN(const bool takes_back, parameters.Flag("take_back"));
  RIGCAL_ASSIGN(answer.robot, KnownRobot(store, parameters));
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(const auto sensors, SensorsAsked(store, answer.robot, parameters));
    if (takes_back) {
      RIGCAL_TRY(TakeBack(store, sensors, answer));
    } else {
      RIGCAL_ASSIGN(answer.begins_at, BeginsAt(store, answer.robot, parameters, answer.word));
      RIGCAL_TRY(storage::BeginEpoch(store, answer.robot, sensors, answer.begins_at, answer.word));
      answer.sensors = sensors;
    }
    RIGCAL_ASSIGN(answer.standing, storage::LoadStandingWatermark(store, answer.robot));
    RIGCAL_ASSIGN(const std::int64_t newest_edge, storage::LoadEdgeWatermark(store, answer.robot));
    answer.has_edges = newest_edge > 0;
    return {};
  }));
  return OrderDone{answer.robot, formats::WriteEpochBegun(answer)};
}

}  // namespace rigcal::pipeline
