// READ and detect: where a sensor saw a target. Searched once per content, ever; then read from the store.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/model/diagnosis.h"
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

// What is odd about the points of a pair's clouds, as notes of its edge.
class OddClouds {
 public:
  // `what` of formats::OdditiesOf; empty: not odd.
  void Add(const SensorId& lidar, const CaptureId& capture, const std::string& what);
  // One of each lidar that has some, by name: how many, and what of the first.
  [[nodiscard]] std::vector<Diagnosis> Notes() const;

 private:
  std::map<SensorId, std::map<CaptureId, std::string>> odd_;
};

}  // namespace rigcal::pipeline
