// C samples -> checked values. Pure. The robot a sample speaks for is the partition of its writer, as discovery tells
// it; a sample that names another robot is refused.
#pragma once

#include <optional>

#include "idl/dds.h"
#include "server/dds/intake/arrival.h"

namespace rigcal::dds {

// The value; or a Refusal; or nothing, where nobody can be answered (the writer is gone, the subject has no valid id).
[[nodiscard]] std::optional<Arrival> FromIdl(const rigcal_wire_SessionHeader& sample, const wire::SampleOrigin& origin);
[[nodiscard]] std::optional<Arrival> FromIdl(const rigcal_wire_Manifest& sample, const wire::SampleOrigin& origin);
[[nodiscard]] std::optional<Arrival> FromIdl(const rigcal_wire_Chunk& sample, const wire::SampleOrigin& origin);
[[nodiscard]] std::optional<Arrival> FromIdl(const rigcal_wire_PairwiseResult& sample,
                                             const wire::SampleOrigin& origin);
[[nodiscard]] std::optional<Arrival> FromIdl(const rigcal_wire_CalibrationInUse& sample,
                                             const wire::SampleOrigin& origin);

// The robot of a "robot/<id>" partition; nullopt for any other.
[[nodiscard]] std::optional<RobotId> RobotOfPartition(const std::string& partition);

}  // namespace rigcal::dds
