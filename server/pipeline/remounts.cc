#include "server/pipeline/remounts.h"

#include <algorithm>

namespace rigcal::pipeline {

Result<Remounts> Remounts::Load(storage::Store& store, const RobotId& robot) {
  Remounts loaded;
  RIGCAL_ASSIGN(loaded.remounts_, storage::LoadRemounts(store, robot));
  if (loaded.remounts_.empty()) return loaded;
  RIGCAL_ASSIGN(loaded.captured_at_, storage::LoadCapturedAt(store, robot));
  return loaded;
}

Result<Remounts> Remounts::Load(storage::Store& store, const std::vector<SessionId>& sessions,
                                const std::vector<storage::Remount>& remounts) {
  Remounts loaded;
  loaded.remounts_ = remounts;
  if (remounts.empty()) return loaded;
  RIGCAL_ASSIGN(loaded.captured_at_, storage::LoadCapturedAt(store, sessions));
  return loaded;
}

bool Remounts::Names(const SessionId& session, const SensorId& sensor) const {
  return std::any_of(remounts_.begin(), remounts_.end(), [&](const storage::Remount& remount) {
    return remount.session == session && remount.sensor == sensor;
  });
}

// Of two sessions of one time, a day say, that which names the sensor is the later; if both do, nobody knows.
const storage::Remount* Remounts::After(const SessionId& session, const SensorId& sensor) const {
  const auto measured = captured_at_.find(session);
  if (measured == captured_at_.end()) return nullptr;
  const auto found = std::find_if(remounts_.begin(), remounts_.end(), [&](const storage::Remount& remount) {
    if (remount.sensor != sensor) return false;
    if (measured->second != remount.captured_at) return measured->second < remount.captured_at;
    return !Names(session, sensor);
  });
  return found != remounts_.end() ? &*found : nullptr;
}

const storage::Remount* Remounts::After(Stamp measured_at, const SensorId& sensor) const {
  const auto found = std::find_if(remounts_.begin(), remounts_.end(), [&](const storage::Remount& remount) {
    return remount.sensor == sensor && measured_at <= remount.captured_at;
  });
  return found != remounts_.end() ? &*found : nullptr;
}

}  // namespace rigcal::pipeline
