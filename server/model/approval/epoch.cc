#include "server/model/approval/epoch.h"

namespace rigcal {

std::string_view NameOf(EpochCause cause) {
  switch (cause) {
    case EpochCause::kRemounted:
      return "remounted";
    case EpochCause::kSerial:
      return "serial";
    case EpochCause::kFirmware:
      return "firmware";
    case EpochCause::kPerson:
      break;
  }
  return "person";
}

std::string TextOf(const Epoch& epoch) {
  const std::string sensor = epoch.sensor.str(), change = " is " + epoch.now + ", before it was " + epoch.before;
  switch (epoch.cause) {
    case EpochCause::kRemounted:
      return sensor + " was remounted";
    case EpochCause::kSerial:
      return "the serial number of " + sensor + change;
    case EpochCause::kFirmware:
      return "the firmware of " + sensor + change;
    case EpochCause::kPerson:
      break;
  }
  return "an epoch of " + sensor + " was begun by " + epoch.word.who +
         (epoch.word.reason.empty() ? "" : ": " + epoch.word.reason);
}

}  // namespace rigcal
