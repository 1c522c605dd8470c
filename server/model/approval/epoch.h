// Epochs: stretches of time in which a sensor stayed mechanically what it was. When one begins, what was measured of
// the sensor before is past; nothing that was measured is changed by it.
#pragma once

#include <string>
#include <string_view>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/model/approval/standing.h"

namespace rigcal {

enum class EpochCause {
  kRemounted,  // a session says that the sensor was moved on purpose
  kSerial,     // another part sits there than on the visit before: its serial number
  kFirmware,   // the same part with another firmware
  kPerson      // somebody said so, `rigcal epoch`
};
// The spelling in documents: "remounted" | "serial" | "firmware" | "person".
[[nodiscard]] std::string_view NameOf(EpochCause cause);

// The beginning of one, of one sensor.
struct Epoch {
  SensorId sensor;
  SessionId session;  // that says it, the first of the new epoch; empty: a person did
  Stamp begins_at;    // when that session was captured; of a person from when on, said
  EpochCause cause = EpochCause::kRemounted;
  std::string before = {}, now = {};  // serial numbers, or firmware
  Word word = {};                     // of a person: who, why, and when it was said
  std::int64_t standing = 0;          // of a person: the number of that word among all words about what counts
  friend bool operator==(const Epoch&, const Epoch&) = default;
};

// Without a stop at the end: "front_left was remounted", "the serial number of front_left is B7, before it was A1",
// "an epoch of front_left was begun by Ada: new bracket".
[[nodiscard]] std::string TextOf(const Epoch& epoch);

}  // namespace rigcal
