// How far DDS reaches, by the environment (dds.h).
#pragma once

namespace rigcal::wire {

// CYCLONEDDS_URI is given: that configuration says it.
[[nodiscard]] bool IsRuledFromOutside();
// RIGCAL_DDS_LOCAL is given, and counts: all traffic stays on the loopback interface.
[[nodiscard]] bool IsOnlyHere();

}  // namespace rigcal::wire
