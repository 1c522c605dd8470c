#include "storage/sessions/epochs.h"

#include <algorithm>
#include <tuple>

#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/standing.h"
#include "storage/sessions/standing_row.h"

namespace rigcal::storage {
namespace {

std::string EpochsSubject(const RobotId& robot) { return "epochs of robot " + robot.str(); }

// Those that sessions name, the earliest captured first.
std::vector<Epoch> NamedByWord(Store& store, const RobotId& robot) {
  Query query(store,
              "SELECT r.sensor_id, session.session_id, session.captured_ns FROM session_remount r "
              "JOIN session ON session.number = r.session_number WHERE r.robot_id = ? "
              "ORDER BY session.captured_ns, session.session_id, r.sensor_id");
  query.Bind(robot);
  std::vector<Epoch> epochs;
  while (query.Step()) epochs.push_back({query.IdAt<SensorId>(0), query.IdAt<SessionId>(1), query.Time(2)});
  return epochs;
}

// What a session tells of the part that a sensor is.
struct PartRow {
  SensorId sensor;
  SessionId session;
  Stamp captured_at;
  std::string serial, firmware;  // empty: not told
};

// By sensor, then the earliest captured first.
std::vector<PartRow> LoadPartsOfSessions(Store& store, const RobotId& robot) {
  Query query(store,
              "SELECT p.sensor_id, s.session_id, s.captured_ns, p.serial, p.firmware FROM sensor_part p "
              "CROSS JOIN session s ON s.number = p.session_number WHERE p.robot_id = ? "
              "ORDER BY p.sensor_id, s.captured_ns, s.session_id");
  query.Bind(robot);
  std::vector<PartRow> rows;
  while (query.Step())
    rows.push_back({query.IdAt<SensorId>(0), query.IdAt<SessionId>(1), query.Time(2), query.Text(3), query.Text(4)});
  return rows;
}

// An exchanged part has its own firmware: that it is another part says enough.
void AddChanges(const std::vector<PartRow>& parts, std::vector<Epoch>& epochs) {
  std::string serial, firmware;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartRow& part = parts[i];
    if (i == 0 || parts[i - 1].sensor != part.sensor) serial.clear(), firmware.clear();
    const bool is_other = !serial.empty() && !part.serial.empty() && serial != part.serial;
    if (is_other)
      epochs.push_back({part.sensor, part.session, part.captured_at, EpochCause::kSerial, serial, part.serial});
    else if (!firmware.empty() && !part.firmware.empty() && firmware != part.firmware)
      epochs.push_back({part.sensor, part.session, part.captured_at, EpochCause::kFirmware, firmware, part.firmware});
    if (is_other) firmware.clear();
    if (!part.serial.empty()) serial = part.serial;
    if (!part.firmware.empty()) firmware = part.firmware;
  }
}

Result<std::vector<Epoch>> BySessions(Store& store, const RobotId& robot) {
  std::vector<Epoch> epochs = NamedByWord(store, robot);
  std::vector<PartRow> parts = LoadPartsOfSessions(store, robot);
  if (epochs.empty() && parts.empty()) return epochs;
  RIGCAL_ASSIGN(const auto superseded, LoadSuperseded(store, robot));
  RIGCAL_ASSIGN(const auto retired, LoadRetiredSessions(store, robot));
  std::erase_if(epochs, [&](const Epoch& epoch) { return superseded.contains(epoch.session); });
  std::erase_if(parts, [&](const PartRow& part) {
    return superseded.contains(part.session) || retired.contains(part.session);
  });
  AddChanges(parts, epochs);
  return epochs;
}

// In the order in which they were said, those that were taken back left out.
std::vector<Epoch> SaidByPeople(Store& store, const RobotId& robot) {
  Query query(store,
              "SELECT t.sensor_id, e.begins_ns, t.at_ns, t.who, t.reason FROM standing t "
              "JOIN epoch e ON e.standing_number = t.number WHERE t.robot_id = ? AND t.how = 'epoch' ORDER BY t.number");
  query.Bind(robot);
  std::vector<Epoch> epochs;
  while (query.Step()) {
    Epoch epoch{query.IdAt<SensorId>(0), {}, query.Time(1), EpochCause::kPerson};
    epoch.word = {query.Time(2), query.Text(3), query.Text(4)};
    const auto before = std::find_if(epochs.rbegin(), epochs.rend(),
                                     [&](const Epoch& one) { return one.sensor == epoch.sensor; });
    if (!query.IsNull(1))
      epochs.push_back(std::move(epoch));
    else if (before != epochs.rend())
      epochs.erase(std::next(before).base());
  }
  return epochs;
}

const Epoch* NewestSaidOf(const std::vector<Epoch>& said, const SensorId& sensor) {
  const auto found = std::find_if(said.rbegin(), said.rend(), [&](const Epoch& one) { return one.sensor == sensor; });
  return found == said.rend() ? nullptr : &*found;
}

// `begins_at` absent: it takes back.
void InsertEpochWord(Store& store, const RobotId& robot, const SensorId& sensor, std::optional<Stamp> begins_at,
                const Word& word) {
  Query(store, "INSERT INTO standing (robot_id, at_ns, how, sensor_id, who, reason) VALUES (?, ?, 'epoch', ?, ?, ?)")
      .Bind(robot, word.at, sensor, word.who, word.reason)
      .Run();
  Query(store, "INSERT INTO epoch VALUES (?, ?)").Bind(store.database().getLastInsertRowid(), begins_at).Run();
}

std::string SensorNamesOf(const std::vector<SensorId>& sensors) {
  std::string names;
  for (const SensorId& sensor : sensors) names += (names.empty() ? "" : ", ") + sensor.str();
  return names;
}

bool IsSaidAlready(const Epoch* said, Stamp begins_at, const Word& word) {
  return said != nullptr && said->begins_at == begins_at && said->word.who == word.who &&
         said->word.reason == word.reason;
}

}  // namespace

Result<std::vector<Epoch>> LoadEpochs(Store& store, const RobotId& robot) {
  using Epochs = std::vector<Epoch>;
  return Load<Epochs>(store, EpochsSubject(robot), [&]() -> Result<Epochs> {
    RIGCAL_ASSIGN(Epochs epochs, BySessions(store, robot));
    for (Epoch& said : SaidByPeople(store, robot)) epochs.push_back(std::move(said));
    std::stable_sort(epochs.begin(), epochs.end(), [](const Epoch& x, const Epoch& y) {
      return std::tie(x.begins_at, x.session, x.sensor) < std::tie(y.begins_at, y.session, y.sensor);
    });
    return epochs;
  });
}

Status BeginEpoch(Store& store, const RobotId& robot, const std::vector<SensorId>& sensors, Stamp begins_at,
                  const Word& word) {
  RIGCAL_TRY(CheckWord(word));
  if (begins_at > word.at)
    return Fail(ErrorCode::kInvalidInput, "an epoch cannot begin at " + ToIso(begins_at) + ", which is still to come",
                "Say when the sensor was worked on, or leave the time away: then it begins now.");
  return store.connection().Append(EpochsSubject(robot), [&]() -> Status {
    const std::vector<Epoch> said = SaidByPeople(store, robot);
    std::vector<SensorId> begun;
    for (const SensorId& sensor : sensors) {
      if (IsSaidAlready(NewestSaidOf(said, sensor), begins_at, word)) continue;
      InsertEpochWord(store, robot, sensor, begins_at, word);
      begun.push_back(sensor);
    }
    if (begun.empty()) return {};
    return AppendAudit(store, word.at, word.who,
                       "began an epoch of " + SensorNamesOf(begun) + " of robot " + robot.str() + " at " + ToIso(begins_at) +
                           Because(word),
                       robot);
  });
}

Result<std::vector<Epoch>> TakeBackEpoch(Store& store, const RobotId& robot, const std::vector<SensorId>& sensors,
                                         const Word& word) {
  using Epochs = std::vector<Epoch>;
  RIGCAL_TRY(CheckWord(word));
  return Append<Epochs>(store, EpochsSubject(robot), [&]() -> Result<Epochs> {
    const Epochs said = SaidByPeople(store, robot);
    Epochs taken;
    std::vector<SensorId> names;
    for (const SensorId& sensor : sensors) {
      const Epoch* newest = NewestSaidOf(said, sensor);
      if (newest == nullptr) continue;
      InsertEpochWord(store, robot, sensor, std::nullopt, word);
      taken.push_back(*newest);
      names.push_back(sensor);
    }
    if (taken.empty()) return taken;
    RIGCAL_TRY(AppendAudit(store, word.at, word.who,
                           "took back the epoch of " + SensorNamesOf(names) + " of robot " + robot.str() + Because(word), robot));
    return taken;
  });
}

}  // namespace rigcal::storage
