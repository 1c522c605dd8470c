#include "server/model/sessions/why_held_back.h"

#include "server/model/named.h"

namespace rigcal {

const char* NameOf(WhyHeldBack why) {
  switch (why) {
    case WhyHeldBack::kPlaceUnknown:
      return "place_unknown";
    case WhyHeldBack::kBehindTheCamera:
      return "behind_the_camera";
    case WhyHeldBack::kContradicts:
      break;
  }
  return "contradicts";
}

Result<WhyHeldBack> WhyHeldBackOf(const std::string& name) {
  return ValueNamed(name, {WhyHeldBack::kContradicts, WhyHeldBack::kPlaceUnknown, WhyHeldBack::kBehindTheCamera},
                    "reason", "Use contradicts, place_unknown or behind_the_camera.");
}

}  // namespace rigcal
