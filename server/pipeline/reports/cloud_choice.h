// Which capture of which session is coloured: values of a revision and its sessions, no pictures yet.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/cloud/camera_view.h"
#include "server/formats/documents.h"
#include "server/model/sessions/session.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct PlacedCamera {
  SensorId id;
  cloud::CloudCamera camera;
  const Payload* picture = nullptr;
};
// A lidar, the cameras that took a picture at the same moment, in the session's order, and their pictures.
struct CloudChoice {
  SensorId lidar;
  Se3 T_ref_lidar;
  const Payload* cloud = nullptr;
  std::optional<CloudLayout> layout;  // of it, where the session says so
  std::vector<PlacedCamera> cameras;
  std::size_t cameras_left_out = 0;  // beyond kCloudCamerasMax
};
// `manifest` must outlive the choices.
struct CloudChoices {
  std::shared_ptr<const Manifest> manifest;
  std::vector<CloudChoice> lidars;  // in the session's order
};

// The newest session (by its capture time; ties: the smaller id) behind the revision's edges in which a lidar with a
// pose and a camera with a pose and intrinsics took one capture; of each such lidar the capture with the most such
// pictures (ties: the first). Empty if there is none. Intrinsics are those that the session was refined
// with as a whole, else those that an edge of it estimated or refined; given without sigmas, or where there are none of
// these, the given ones.
[[nodiscard]] Result<CloudChoices> ChooseClouds(storage::Store& store, const formats::RevisionInput& revision);

// Of an edge's figures, as the estimators write them: of `sensor`, if it is a camera of this edge and they are all
// there.
[[nodiscard]] std::optional<CameraIntrinsics> EstimatedIntrinsics(const Edge& edge, const SensorId& sensor,
                                                                  CameraModel model);

}  // namespace rigcal::pipeline
