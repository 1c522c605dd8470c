// How far DDS reaches, by the environment (dds.h).
#pragma once

namespace rigcal::wire {

// CYCLONEDDS_URI is given: that configuration says it.
[[nodiscard]] bool IsRuledFromOutside();
// RIGCAL_DDS_LOCAL is given, and counts: all traffic stays on the loopback interface.
[[nodiscard]] bool IsOnlyHere();
// An interface other than the loopback is up.
[[nodiscard]] bool HasNetwork();
// Others than this machine may be on the DDS domain, as far as can be told.
[[nodiscard]] bool ReachesOthers();

}  // namespace rigcal::wire
