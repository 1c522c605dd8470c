#include "idl/reach.h"

#include <cstdlib>

namespace rigcal::wire {
namespace {

bool IsGiven(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != 0;
}

}  // namespace

bool IsRuledFromOutside() { return IsGiven("CYCLONEDDS_URI"); }

bool IsOnlyHere() { return !IsRuledFromOutside() && IsGiven("RIGCAL_DDS_LOCAL"); }

}  // namespace rigcal::wire
