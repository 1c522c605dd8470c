#include "server/pipeline/sessions/epochs.h"

#include <algorithm>

#include "storage/sessions/epochs.h"

namespace rigcal::pipeline {
namespace {

template <typename IsSo>
const Epoch* FirstOf(const std::vector<Epoch>& epochs, const IsSo& is_so) {
  const auto found = std::find_if(epochs.begin(), epochs.end(), is_so);
  return found != epochs.end() ? &*found : nullptr;
}

bool ByPerson(const Epoch& epoch) { return epoch.cause == EpochCause::kPerson; }

}  // namespace

Result<Epochs> Epochs::Load(storage::Store& store, const RobotId& robot) {
  Epochs loaded;
  RIGCAL_ASSIGN(loaded.epochs_, storage::LoadEpochs(store, robot));
  if (loaded.epochs_.empty()) return loaded;
  RIGCAL_ASSIGN(loaded.captured_at_, storage::LoadCapturedAt(store, robot));
  return loaded;
}

Result<Epochs> Epochs::Load(storage::Store& store, const std::vector<SessionId>& sessions,
                            const std::vector<Epoch>& epochs) {
  Epochs loaded;
  loaded.epochs_ = epochs;
  if (epochs.empty()) return loaded;
  RIGCAL_ASSIGN(loaded.captured_at_, storage::LoadCapturedAt(store, sessions));
  return loaded;
}

bool Epochs::Names(const SessionId& session, const SensorId& sensor) const {
  return std::any_of(epochs_.begin(), epochs_.end(),
                     [&](const Epoch& epoch) { return epoch.session == session && epoch.sensor == sensor; });
}

// Of two sessions of one time, a day say, that which names the sensor is the later; if both do, nobody knows.
const Epoch* Epochs::After(const SessionId& session, const SensorId& sensor) const {
  const auto measured = captured_at_.find(session);
  if (measured == captured_at_.end()) return nullptr;
  return FirstOf(epochs_, [&](const Epoch& epoch) {
    if (epoch.sensor != sensor) return false;
    if (measured->second != epoch.begins_at) return measured->second < epoch.begins_at;
    return !ByPerson(epoch) && !Names(session, sensor);
  });
}

const Epoch* Epochs::After(Stamp measured_at, const SensorId& sensor) const {
  return FirstOf(epochs_, [&](const Epoch& epoch) {
    if (epoch.sensor != sensor) return false;
    return ByPerson(epoch) ? measured_at < epoch.begins_at : measured_at <= epoch.begins_at;
  });
}

const Epoch* Epochs::SaidAfter(Stamp stored_at, const SensorId& sensor) const {
  return FirstOf(epochs_, [&](const Epoch& epoch) {
    return epoch.sensor == sensor && ByPerson(epoch) && stored_at < epoch.begins_at;
  });
}

}  // namespace rigcal::pipeline
