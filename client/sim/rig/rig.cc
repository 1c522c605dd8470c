#include "client/sim/rig/rig.h"

#include <algorithm>
#include <set>

#include "client/sim/rig/printed_pattern.h"

namespace rigcal::sim {
namespace {

constexpr const char* kCure = "Mend the rig's file; `rigcal simulate --print-rig mars-mapper` prints a complete one.";

template <typename T, typename IdType>
const T* Find(const std::vector<T>& things, const IdType& id, const IdType& (*id_of)(const T&)) {
  const auto it = std::find_if(things.begin(), things.end(), [&](const T& thing) { return id_of(thing) == id; });
  return it == things.end() ? nullptr : &*it;
}
const SensorId& IdOfSensor(const RigSensor& sensor) { return sensor.id; }
const TargetId& IdOfBoard(const RigBoard& board) { return board.target.id; }

tl::unexpected<Error> Refuse(const std::string& what) { return Fail(ErrorCode::kInvalidInput, what, kCure); }

Status CheckBoards(const Rig& rig) {
  for (const RigBoard& board : rig.boards) {
    RIGCAL_TRY(rigcal::Validate(board.target));
    if (!board.target.plate_m || (*board.target.plate_m - PatternSize_m(board.target)).minCoeff() < 0)
      return Refuse("board " + board.target.id.str() + ": its plate is smaller than its pattern");
    RIGCAL_TRY(PrintedPattern::Of(board.target));
    const Eigen::Vector3d& p_m = board.T_world_plate.p_m;
    const Eigen::Vector3d half_m = rig.room.size_m / 2;
    if (std::abs(p_m.x()) > half_m.x() || std::abs(p_m.y()) > half_m.y() || p_m.z() < 0 ||
        p_m.z() > rig.room.size_m.z())
      return Refuse("board " + board.target.id.str() + ": it hangs outside the room");
  }
  return {};
}

// What is mounted on one body is one: the world of such a rig is that of what the robot carries.
Status CheckMounts(const Rig& rig) {
  for (const RigBoard& board : rig.boards) {
    const auto& carrier = board.target.mounted_on;
    if (carrier != rig.boards.front().target.mounted_on)
      return Refuse("board " + board.target.id.str() + ": either all boards are mounted on one tracker, or none");
    const RigSensor* sensor = carrier ? Find(rig.sensors, *carrier, IdOfSensor) : nullptr;
    if (carrier && (sensor == nullptr || sensor->kind != SensorKind::kTracker))
      return Refuse("board " + board.target.id.str() + ": " + carrier->str() +
                    ", which it is mounted on, is no tracker of the rig");
  }
  return {};
}

Status CheckSensors(const Rig& rig) {
  if (rig.sensors.empty()) return Refuse("the rig has no sensors");
  for (const RigSensor& sensor : rig.sensors)
    if (sensor.sees && Find(rig.boards, *sensor.sees, IdOfBoard) == nullptr)
      return Refuse("sensor " + sensor.id.str() + ": it sees board " + sensor.sees->str() + ", which the rig has not");
  if (Find(rig.sensors, rig.reference, IdOfSensor) == nullptr)
    return Refuse("reference " + rig.reference.str() + " is not a sensor of the rig");
  if (rig.SensorOf(rig.reference).kind == SensorKind::kTracker)
    return Refuse("reference " + rig.reference.str() + " is the tracker; name a camera or a lidar");
  for (const SensorPair& pair : rig.skip_pairs)
    for (const SensorId& id : {pair.a, pair.b})
      if (Find(rig.sensors, id, IdOfSensor) == nullptr)
        return Refuse("skip_pairs names " + id.str() + ", which is not a sensor of the rig");
  return {};
}

}  // namespace

Se3 RigBoard::T_world_board() const {
  const Se3 T_plate_board{-PlateCentreOf(target), Eigen::Quaterniond::Identity()};
  return T_world_plate * T_plate_board;
}

const RigSensor& Rig::SensorOf(const SensorId& id) const { return *Find(sensors, id, IdOfSensor); }
const RigBoard& Rig::BoardOf(const TargetId& id) const { return *Find(boards, id, IdOfBoard); }

Status Validate(const Rig& rig) {
  RIGCAL_TRY(CheckBoards(rig));
  RIGCAL_TRY(CheckSensors(rig));
  RIGCAL_TRY(CheckMounts(rig));
  if (rig.motion.captures < 1 || rig.motion.captures > 10'000) return Refuse("captures must be 1 to 10,000");
  return {};
}

}  // namespace rigcal::sim
