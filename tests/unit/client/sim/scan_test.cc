#include "client/sim/views/scan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/sim/rig/random.h"
#include "client/sim/visit/observe.h"
#include "server/formats/clouds/cloud.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

struct Scanned {
  Experiment experiment;
  Scene scene;
  Se3 T_world_lidar;
  std::vector<ScanPoint> points;

  explicit Scanned(const Rig& rig, double noise_factor, double bias_m = 0) {
    Options options;
    options.noise_factor = noise_factor;
    options.lidar_bias_sigma_m = bias_m;
    experiment = Prepared(rig, options);
    scene = SceneOf(experiment.rig);
    const SensorId id("top");
    T_world_lidar = experiment.T_world_sensor(id, 0);
    points = Scan(scene, experiment.rig.SensorOf(id).lidar, T_world_lidar, experiment.beam_bias_m.at(id), 5);
  }
};

TEST(SimScan, PointsLieOnTheSurfacesTheyClaim) {
  const Scanned scanned(SmallRig(), 0);
  EXPECT_EQ(scanned.points.size(), 900u * 9u);  // a closed room: every beam comes back
  std::map<int, int> count;
  for (const ScanPoint& point : scanned.points) {
    const Panel& panel = scanned.scene.panels[static_cast<std::size_t>(point.panel_idx)];
    const Eigen::Vector3d off = scanned.T_world_lidar * point.p_lidar - panel.middle_m;
    ASSERT_LT(std::abs(off.dot(panel.outward)), 1e-9);
    ASSERT_LE(std::abs(off.dot(panel.u)), panel.half_m.x() + 1e-9);
    ASSERT_LE(std::abs(off.dot(panel.v)), panel.half_m.y() + 1e-9);
    ++count[panel.board_idx];
  }
  EXPECT_GT(count[0], 100);
  EXPECT_GT(count[1], 100);
}

// Sampled along the beam by the geometry of the room itself, not by rays against panels.
TEST(SimScan, NothingStandsBetweenTheLidarAndAPoint) {
  const Rig rig = SmallRig();
  const Scanned scanned(rig, 0);
  const Box& crate = rig.room.boxes[0];
  const auto is_inside_crate = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d local = Eigen::AngleAxisd(-crate.yaw_rad, Eigen::Vector3d::UnitZ()) * (p - crate.centre_m);
    return ((local.cwiseAbs() - crate.size_m / 2).maxCoeff()) < -1e-6;
  };
  const auto side_of_board = [&](const RigBoard& board, const Eigen::Vector3d& p) {
    const Eigen::Vector3d local = board.T_world_plate.Inverse() * p;
    const bool on_plate = (local.head<2>().cwiseAbs() - *board.target.plate_m / 2).maxCoeff() < -0.02;
    return on_plate ? local.z() : std::nan("");
  };
  for (const ScanPoint& point : scanned.points) {
    for (const RigBoard& board : rig.boards) {
      double before = std::nan("");
      for (double part = 0; part < 0.999; part += 0.01) {
        const double side = side_of_board(board, scanned.T_world_lidar * (part * point.p_lidar));
        ASSERT_FALSE(before < 0 && side > 0) << "a beam goes through board " << board.target.id.str();
        before = side;
      }
    }
    for (double part = 0; part < 0.999; part += 0.01)
      ASSERT_FALSE(is_inside_crate(scanned.T_world_lidar * (part * point.p_lidar)));
  }
}

TEST(SimScan, ABoxBeforeABoardHidesIt) {
  Rig rig = SmallRig();
  rig.room.boxes.push_back({{1.6, 0, 1}, {0.1, 2.0, 1.9}, 0, Colour::Constant(0.5)});
  const Scanned scanned(rig, 1);
  for (const ScanPoint& point : scanned.points)
    ASSERT_NE(scanned.scene.panels[static_cast<std::size_t>(point.panel_idx)].board_idx, 0);
  const RigSensor& left = scanned.experiment.rig.SensorOf(SensorId("left"));
  EXPECT_FALSE(TrueCorners(scanned.experiment, scanned.scene, left, 0));
  EXPECT_TRUE(TrueCorners(Scanned(SmallRig(), 1).experiment, SceneOf(SmallRig()), left, 0));
}

TEST(SimScan, NoiseAndBeamsAreAsDeclared) {
  const Scanned scanned(SmallRig(), 1, 0.005);
  const LidarTruth& lidar = scanned.experiment.rig.SensorOf(SensorId("top")).lidar;
  std::vector<double> sum(9, 0), squares(9, 0), count(9, 0);
  for (const ScanPoint& point : scanned.points) {
    const auto ring = static_cast<std::size_t>(point.ring);
    ASSERT_NEAR(std::asin(point.p_lidar.z() / point.p_lidar.norm()), lidar.elevations_rad[ring], 1e-9);
    const double error_m = point.p_lidar.norm() - point.range_m;
    sum[ring] += error_m, squares[ring] += error_m * error_m, ++count[ring];
  }
  for (std::size_t ring = 0; ring < 9; ++ring) {
    const double mean = sum[ring] / count[ring], bias = scanned.experiment.beam_bias_m.at(SensorId("top"))[ring];
    EXPECT_NEAR(mean, bias, 5.5 * 0.02 / std::sqrt(count[ring]));
    EXPECT_NEAR(std::sqrt(squares[ring] / count[ring] - mean * mean) / 0.02, 1, 5.5 / std::sqrt(2 * count[ring]));
  }
}

TEST(SimScan, APartOfAScanHasTheWholesPoints) {
  const Scanned scanned(SmallRig(), 1);
  const RigSensor& top = scanned.experiment.rig.SensorOf(SensorId("top"));
  const std::uint64_t key = KeyOf(scanned.experiment.options.seed, "scan", "top", 0);
  const auto whole = Scan(scanned.scene, top.lidar, scanned.T_world_lidar, {}, key);
  const auto part = PlatePoints(scanned.experiment, scanned.scene, top, TargetId("front"), 0);
  ASSERT_GT(part.size(), 50u);
  for (const ScanPoint& point : part)
    ASSERT_TRUE(std::any_of(whole.begin(), whole.end(), [&](const ScanPoint& other) {
      return (other.p_lidar - point.p_lidar).norm() < 1e-12 && other.ring == point.ring;
    }));
}

TEST(SimScan, PcdIsReadBackByTheProduct) {
  const Scanned scanned(SmallRig(), 1);
  const std::string pcd = PcdOf(scanned.points);
  const auto cloud = formats::ReadCloud(std::as_bytes(std::span(pcd)), "pcd", "top/01.pcd");
  ASSERT_TRUE(cloud) << Sentence(cloud.error());
  ASSERT_EQ(cloud->points_m.size(), scanned.points.size());
  EXPECT_LT((cloud->points_m[77].cast<double>() - scanned.points[77].p_lidar).norm(), 1e-5);
  ASSERT_EQ(cloud->fields.size(), 2u);
  EXPECT_EQ(cloud->fields[0].name, "intensity");
  EXPECT_EQ(cloud->fields[1].name, "ring");
  EXPECT_EQ(cloud->fields[1].values[77], scanned.points[77].ring);
}

}  // namespace
}  // namespace rigcal::sim
