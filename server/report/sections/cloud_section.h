// What the section of coloured clouds and overlays shows on a revision page. Nothing is shown where it is empty.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace rigcal::report {

// File names are relative to the revision's folder; they hold ids and fixed words only.
struct ColouredLidar {
  std::string lidar, capture;
  std::string front_png, top_png, oblique_png, ply, viewer_points;
  std::size_t points = 0, covered = 0;            // covered: seen by at least one camera
  std::size_t cameras = 0;                        // whose pictures were used
  std::vector<std::string> camera_names = {};     // by the index that viewer_points has
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // in the lidar's frame
};
struct CameraOverlay {
  std::string camera, lidar, capture;
  std::string points_jpg, picture_jpg;
  std::size_t points = 0;           // of the lidar, in the picture
  int width_px = 0, height_px = 0;  // of the picture; 0: not known
};
struct CloudSection {
  std::vector<ColouredLidar> lidars;
  std::vector<CameraOverlay> overlays;
  std::vector<std::string> notes;  // whole sentences: what could not be shown, and why
};

}  // namespace rigcal::report
