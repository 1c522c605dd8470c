// A session whose pairs failed: edges as the estimators make them of pictures and clouds.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "server/fleet/causes/root_causes.h"

namespace rigcal::fleet {

// One letter per capture. 'B': the board is there; '.': it is not; 'x': the file cannot be read; ' ': there is none.
using Letters = std::string;

struct Visit {
  SessionId session = SessionId(std::string(64, '1'));
  SessionHeader header;
  std::vector<Edge> edges;

  explicit Visit(const Target& board);
  void AddSensor(const std::string& name, SensorKind kind);
  // With an id and this session.
  void Add(Edge edge);
  // Estimated. Fewer than three captures may have the board in both pictures.
  void AddStereo(const std::string& a, const Letters& of_a, const std::string& b, const Letters& of_b);
  // Every pair of these.
  void AddStereos(const std::map<std::string, Letters>& cameras);
  // Likewise, the camera with known intrinsics; fewer than four with the board in both.
  void AddLidarCamera(const std::string& camera, const Letters& pictures, const std::string& lidar,
                      const Letters& clouds);
  // Made by hand.
  void AddFailed(const std::string& a, const std::string& b, const std::string& method, const std::string& code,
                 const std::map<std::string, double>& figures = {});
  void AddGood(const std::string& a, const std::string& b);

  [[nodiscard]] SessionHeaders Headers() const { return {{session, header}}; }
  [[nodiscard]] SessionTimes Times() const { return {{session, header.captured_at}}; }
  [[nodiscard]] std::vector<RootCause> Causes(const GraphSolution& solution = {}) const;
  [[nodiscard]] Verdict Judge(const GraphSolution& solution) const;
};

// Null: none is of this kind.
[[nodiscard]] const RootCause* CauseOfKind(const std::vector<RootCause>& causes, CauseKind kind);
// The only one of a visit; the test fails where there is another.
[[nodiscard]] RootCause OneCause(const Visit& visit, CauseKind kind);

// "calib", 9 x 6 corners of 30 mm: of stereo pairs; "wall", 7 x 5 corners of 100 mm: of lidars and cameras.
[[nodiscard]] Target StereoBoard();
[[nodiscard]] Target LidarBoard();
// Two cameras before boards that all face them squarely.
[[nodiscard]] Edge FlatStereo(const std::string& a, const std::string& b);
// A camera and a lidar before boards that all face one way; and before boards that are larger than `square_m` says.
[[nodiscard]] Edge FlatLidarCamera(const std::string& camera, const std::string& lidar);
[[nodiscard]] Edge MissizedLidarCamera(const std::string& camera, const std::string& lidar, double square_m);

// Sensors with poses, the first the reference, and others without.
[[nodiscard]] GraphSolution SolutionOf(const std::vector<std::string>& known, const std::vector<std::string>& unknown);

}  // namespace rigcal::fleet
