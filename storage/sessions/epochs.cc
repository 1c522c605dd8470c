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

// Of a sensor of `l`, that sessions told more than one `column` of it: two look-ups, however many sessions there are.
std::string TellsSeveral(const std::string& column) {
  const std::string of_sensor =
      "(" + column + ") FROM sensor_part WHERE robot_id = l.robot_id AND sensor_id = l.sensor_id)";
  return "(SELECT min" + of_sensor + " <> (SELECT max" + of_sensor;
}

// Of sensors that were ever another part. By sensor, then the earliest captured first.
std::vector<PartRow> LoadPartsOfSessions(Store& store, const RobotId& robot) {
  Query query(store,
              "SELECT p.sensor_id, s.session_id, s.captured_ns, p.serial, p.firmware FROM listed_sensor l "
              "CROSS JOIN sensor_part p ON p.robot_id = l.robot_id AND p.sensor_id = l.sensor_id "
              "CROSS JOIN session s ON s.number = p.session_number WHERE l.robot_id = ? AND (" +
                  TellsSeveral("serial") + " OR " + TellsSeveral("firmware") +
                  ") ORDER BY p.sensor_id, s.captured_ns, s.session_id");
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
  std::erase_if(
      parts, [&](const PartRow& part) { return superseded.contains(part.session) || retired.contains(part.session); });
  AddChanges(parts, epochs);
  return epochs;
}

// In the order in which they were said, those that were taken back left out.
std::vector<Epoch> SaidByPeople(Store& store, const RobotId& robot) {
  Query query(
      store,
      "SELECT t.sensor_id, e.begins_ns, t.at_ns, t.who, t.reason, t.number FROM standing t "
      "JOIN epoch e ON e.standing_number = t.number WHERE t.robot_id = ? AND t.how = 'epoch' ORDER BY t.number");
  query.Bind(robot);
  std::vector<Epoch> epochs;
  while (query.Step()) {
    Epoch epoch{query.IdAt<SensorId>(0), {}, query.Time(1), EpochCause::kPerson};
    epoch.word = {query.Time(2), query.Text(3), query.Text(4)};
    epoch.standing = query.Int(5);
    const auto before =
        std::find_if(epochs.rbegin(), epochs.rend(), [&](const Epoch& one) { return one.sensor == epoch.sensor; });
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

// `begins_at` absent: it takes back. An audit row holds one row: each sensor has its own.
Status AppendEpochWord(Store& store, const RobotId& robot, const SensorId& sensor, std::optional<Stamp> begins_at,
                       const Word& word) {
  const auto number = Query(store,
                            "INSERT INTO standing (robot_id, at_ns, how, sensor_id, who, reason) VALUES (?, ?, "
                            "'epoch', ?, ?, ?) RETURNING number")
                          .Bind(robot, word.at, sensor, word.who, word.reason)
                          .RunForKey();
  const AuditedRow row{AuditedKind::kStanding, number.value()};
  Query(store, "INSERT INTO epoch VALUES (?, ?)").Bind(row.number, begins_at).Run();
  const std::string what = (begins_at ? "began an epoch of " : "took back the epoch of ") + sensor.str() +
                           " of robot " + robot.str() + (begins_at ? " at " + ToIso(*begins_at) : "") + Because(word);
  return AppendAudit(store, word.at, word.who, what, robot, row);
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
    for (const SensorId& sensor : sensors) {
      if (IsSaidAlready(NewestSaidOf(said, sensor), begins_at, word)) continue;
      RIGCAL_TRY(AppendEpochWord(store, robot, sensor, begins_at, word));
    }
    return {};
  });
}

Result<std::vector<Epoch>> TakeBackEpoch(Store& store, const RobotId& robot, const std::vector<SensorId>& sensors,
                                         const Word& word) {
  using Epochs = std::vector<Epoch>;
  RIGCAL_TRY(CheckWord(word));
  return Append<Epochs>(store, EpochsSubject(robot), [&]() -> Result<Epochs> {
    const Epochs said = SaidByPeople(store, robot);
    Epochs taken;
    for (const SensorId& sensor : sensors) {
      const Epoch* newest = NewestSaidOf(said, sensor);
      if (newest == nullptr) continue;
      RIGCAL_TRY(AppendEpochWord(store, robot, sensor, std::nullopt, word));
      taken.push_back(*newest);
    }
    return taken;
  });
}

}  // namespace rigcal::storage
