// READ and detect: where a sensor saw a target. Searched once per content, ever; then read from the store.
#pragma once

#include <map>

#include "server/model/sessions/session.h"
#include "storage/sessions/detections.h"

namespace rigcal::pipeline {

template <typename Stored>
using Sightings = std::map<CaptureId, Stored>;

// Of every picture (cloud) of the sensor by its capture: from the store, or searched now and stored. What cannot be
// read is a sighting that says why.
[[nodiscard]] Result<Sightings<storage::StoredView>> DetectInImages(storage::Store& store, const Manifest& manifest,
                                                                    const SensorId& camera, const Target& target);
[[nodiscard]] Result<Sightings<storage::StoredCloud>> DetectInClouds(storage::Store& store, const Manifest& manifest,
                                                                     const SensorId& lidar, const Target& target);
// Pictures in which the board was found.
[[nodiscard]] std::size_t CountFound(const Sightings<storage::StoredView>& views);

// For reports: "left / 003: 54 corners".
[[nodiscard]] std::string EvidenceTitle(const SensorId& sensor, const CaptureId& capture, const std::string& found);

}  // namespace rigcal::pipeline
