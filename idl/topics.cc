// One line per topic: name, type, durability, history, bound of a reader's memory. idl/README.md says who writes what.
#include "idl/dds.h"

namespace rigcal::wire {
namespace {

constexpr bool kVolatile = false;
constexpr bool kTransientLocal = true;
constexpr int kKeepAll = 0;
constexpr int kNewest = 1;
constexpr int kNoLimit = 0;

}  // namespace

#define RIGCAL_TOPIC(type, durability, history, reader_samples_max)                                                    \
  template <>                                                                                                          \
  const TopicInfo& InfoOf<rigcal_wire_##type>() {                                                                      \
    static const TopicInfo info{"rigcal/" #type, &rigcal_wire_##type##_desc, durability, history, reader_samples_max}; \
    return info;                                                                                                       \
  }

RIGCAL_TOPIC(SessionHeader, kVolatile, kKeepAll, kNoLimit)
RIGCAL_TOPIC(Manifest, kVolatile, kKeepAll, 8)
RIGCAL_TOPIC(Chunk, kVolatile, kKeepAll, 48)
RIGCAL_TOPIC(Receipt, kTransientLocal, kNewest, kNoLimit)
RIGCAL_TOPIC(PairwiseResult, kVolatile, kKeepAll, 4096)
RIGCAL_TOPIC(Event, kVolatile, kKeepAll, kNoLimit)
RIGCAL_TOPIC(Calibration, kTransientLocal, kNewest, kNoLimit)
RIGCAL_TOPIC(CalibrationInUse, kTransientLocal, kNewest, 4096)
RIGCAL_TOPIC(RobotStatus, kTransientLocal, kNewest, kNoLimit)
RIGCAL_TOPIC(Request, kVolatile, kKeepAll, 1024)
RIGCAL_TOPIC(Reply, kVolatile, kKeepAll, kNoLimit)

#undef RIGCAL_TOPIC

}  // namespace rigcal::wire
