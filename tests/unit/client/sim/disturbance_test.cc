// What goes wrong on a simulated visit: as large as asked for, where it was asked for, and nowhere else.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "client/sim/rig/lens.h"
#include "client/sim/visit/observe.h"
#include "client/sim/visit/sway.h"
#include "server/formats/sessions/poses.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

using Eigen::Vector2d;

Options Quiet(std::uint64_t seed = 1) {
  Options options;
  options.seed = seed;
  options.noise_factor = 0;
  return options;
}

// (sensor, capture) whose corners are not those of the other experiment, and by how much at most.
std::map<std::pair<std::string, std::string>, double> MovedViews(const Experiment& one, const Experiment& other) {
  const Observations a = Observe(one), b = Observe(other);
  std::map<std::pair<std::string, std::string>, double> moved;
  for (const auto& [sensor, views] : a.views)
    for (const auto& [capture, view] : views) {
      const BoardView& beside = b.views.at(sensor).at(capture);
      if (!view.found || !beside.found) continue;
      double most_px = 0;
      for (std::size_t i = 0; i < view.corners_px.size(); ++i)
        most_px = std::max(most_px, (view.corners_px[i] - beside.corners_px[i]).norm());
      if (most_px > 0) moved[{sensor.str(), capture.str()}] = most_px;
    }
  return moved;
}

TEST(SimLensMisfit, HasTheRmsThatIsAskedForAndIsSmooth) {
  for (const std::uint64_t key : {1, 2, 3, 4, 5}) {
    const LensMisfit misfit = DrawLensMisfit(0.05, 2448, 2048, key);
    Vector2d squares = Vector2d::Zero();
    double steepest = 0;
    constexpr int kColumns = 153, kRows = 128;
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x) {
        const Vector2d uv_px(16 * x + 8, 16 * y + 8);
        squares += misfit.At(uv_px).cwiseAbs2() / (kColumns * kRows);
        steepest = std::max(steepest, (misfit.At(uv_px + Vector2d(1, 1)) - misfit.At(uv_px)).norm());
      }
    EXPECT_NEAR(std::sqrt(squares.x()), 0.05, 1e-4);
    EXPECT_NEAR(std::sqrt(squares.y()), 0.05, 1e-4);
    // Three waves over the shorter side change by at most 2 pi 3 / 2048 of their amplitudes in a pixel.
    EXPECT_LT(steepest, 0.05 * 2 * std::sqrt(3.0) * 2 * 2 * M_PI * 3 / 2048);
    EXPECT_GT(steepest, 0.05 * 2 * M_PI * 1.5 / 2448);
    const Vector2d pixel(700.5, 1900.25), straight = misfit.Straightened(pixel);
    EXPECT_LT((straight + misfit.At(straight) - pixel).norm(), 1e-9);
  }
  EXPECT_TRUE(DrawLensMisfit(0, 2448, 2048, 1).empty());
}

TEST(SimLensMisfit, IsTheSameForASeedAndAnotherForEachCamera) {
  Options options = Quiet();
  options.disturb.lens_misfit_px = 0.5;
  const auto at = [&](const char* camera) {
    return Prepared(SmallRig(), options).rig.SensorOf(SensorId(camera)).camera.misfit.At({100, 200});
  };
  const Vector2d left = at("left"), side = at("side");
  EXPECT_EQ(left, at("left"));
  EXPECT_NE(left, side);
  options.seed = 2;
  EXPECT_NE(left, at("left"));
}

// The field is added to where the lens model projects to, by OpenCV.
TEST(SimLensMisfit, BendsWhatTheCameraSees) {
  Options options = Quiet();
  options.disturb.lens_misfit_px = 0.5;
  const Experiment plain = Prepared(SmallRig(), Quiet()), bent = Prepared(SmallRig(), options);
  const SensorId left("left");
  const LensMisfit& misfit = bent.rig.SensorOf(left).camera.misfit;
  const BoardView before = Observe(plain).views.at(left).at(plain.captures[0]);
  const BoardView after = Observe(bent).views.at(left).at(bent.captures[0]);
  ASSERT_TRUE(before.found);
  for (std::size_t i = 0; i < before.corners_px.size(); ++i)
    EXPECT_LT((before.corners_px[i] + misfit.At(before.corners_px[i]) - after.corners_px[i]).norm(), 1e-12);
}

TEST(SimBump, HappensAfterTheAskedPartOfTheCapturesAlsoToTheReference) {
  Options options = Quiet();
  options.captures = 8;
  options.bump = SensorId("left");
  options.bump_m = 0.02;
  options.bump_rad = 0.035;
  options.bump_at_ratio = 0.25;
  const Experiment bumped = Prepared(SmallRig(), options);
  EXPECT_EQ(bumped.bumped_from_idx, 2u);
  for (std::size_t k = 0; k < 8; ++k) {
    const Vector6d xi =
        (bumped.rig.SensorOf(SensorId("left")).T_body_sensor.Inverse() * bumped.T_body_sensor(SensorId("left"), k))
            .Log();
    EXPECT_NEAR(xi.head<3>().norm(), k < 2 ? 0 : 0.02, 1e-3);
    EXPECT_NEAR(xi.tail<3>().norm(), k < 2 ? 0 : 0.035, 1e-9);
  }
  options.bump_at_ratio = 1;
  EXPECT_FALSE(Prepare(SmallRig(), options));
}

TEST(SimBoardMove, MovesOneBoardFromACaptureOn) {
  Options options = Quiet();
  options.captures = 8;
  Options moving = options;
  moving.disturb.board_move = BoardMove{{0.005, 0.01}, 0.75, TargetId("side")};
  const Experiment still = Prepared(SmallRig(), options), moved = Prepared(SmallRig(), moving);
  const auto views = MovedViews(still, moved);
  EXPECT_FALSE(views.empty());
  for (const auto& [view, most_px] : views) {
    EXPECT_EQ(view.first, "side");
    EXPECT_GE(view.second, "07");
    EXPECT_GT(most_px, 0.5);
  }
  const Se3 before = moved.BoardAt(TargetId("side"), 5).T_world_plate,
            after = moved.BoardAt(TargetId("side"), 6).T_world_plate;
  EXPECT_NEAR((before.Inverse() * after).Log().tail<3>().norm(), 0.01, 1e-9);
  // The lidar meets it where it is.
  const auto on_plate = [&](std::size_t k) {
    double off_m = 0;
    for (const ScanPoint& point :
         PlatePoints(moved, SceneAt(moved, k), moved.rig.SensorOf(SensorId("top")), TargetId("side"), k))
      off_m = std::max(off_m, std::abs((moved.BoardAt(TargetId("side"), k).T_world_plate.Inverse() *
                                        (moved.T_world_sensor(SensorId("top"), k) * point.p_lidar))
                                           .z()));
    return off_m;
  };
  EXPECT_LT(on_plate(7), 1e-9);
}

TEST(SimWrongInstant, ChangesOnePictureOnly) {
  Options wrong = Quiet();
  wrong.disturb.wrong_instant.emplace();
  for (const std::uint64_t seed : {1, 2, 3}) {
    wrong.seed = seed;
    const Experiment plain = Prepared(SmallRig(), Quiet(seed)), disturbed = Prepared(SmallRig(), wrong);
    const auto moved = MovedViews(plain, disturbed);
    ASSERT_EQ(moved.size(), 1u);
    EXPECT_EQ(moved.begin()->first.first, disturbed.wrong_instant->sensor.str());
    EXPECT_EQ(moved.begin()->first.second, disturbed.captures[disturbed.wrong_instant->capture_idx].str());
    EXPECT_GT(moved.begin()->second, 1);
  }
  wrong.disturb.wrong_instant->of = Recording{CaptureId("03"), SensorId("left")};
  EXPECT_EQ(Prepared(SmallRig(), wrong).wrong_instant->capture_idx, 2u);
  wrong.disturb.wrong_instant->of->capture = CaptureId("99");
  EXPECT_EQ(Prepare(SmallRig(), wrong).error().what, "capture 99 is none of this visit");
}

TEST(SimCaptureShift, ShiftsAllCornersOfOnePictureAlike) {
  Options shifting = Quiet();
  shifting.disturb.capture_shift = CaptureShift{8, {}};
  const Experiment plain = Prepared(SmallRig(), Quiet()), shifted = Prepared(SmallRig(), shifting);
  const auto moved = MovedViews(plain, shifted);
  ASSERT_EQ(moved.size(), 1u);
  const SensorId sensor(moved.begin()->first.first);
  const CaptureId capture(moved.begin()->first.second);
  const BoardView before = Observe(plain).views.at(sensor).at(capture),
                  after = Observe(shifted).views.at(sensor).at(capture);
  for (std::size_t i = 0; i < before.corners_px.size(); ++i)
    EXPECT_LT((after.corners_px[i] - before.corners_px[i] - shifted.shifted->shift_px).norm(), 1e-9);
  EXPECT_NEAR(shifted.shifted->shift_px.norm(), 8, 1e-12);
  shifting.disturb.capture_shift->of = Recording{CaptureId("01"), SensorId("top")};
  EXPECT_EQ(Prepare(SmallRig(), shifting).error().what, "sensor top takes no pictures that could be shifted");
}

TEST(SimVisitScatter, HasItsSigmaOverVisitsOfOneRobot) {
  Options options = Quiet();
  options.captures = 1;
  options.disturb.visit_scatter = {0.003, 0.002};
  const SensorId side("side");
  const Se3 mean = SmallRig().SensorOf(side).T_body_sensor;
  Vector6d squares = Vector6d::Zero();
  constexpr int kVisits = 400;
  for (std::uint64_t seed = 1; seed <= kVisits; ++seed) {
    options.seed = seed;
    const Experiment visit = Prepared(SmallRig(), options);
    squares += (mean.Inverse() * visit.rig.SensorOf(side).T_body_sensor).Log().cwiseAbs2() / kVisits;
  }
  // An rms of 400 is within 5 of its own sigmas of 3.5 %.
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(std::sqrt(squares[i]) / (i < 3 ? 0.003 : 0.002), 1, 0.18);
}

TEST(SimBoardBend, CornersAndPointsLieOnTheBentBoard) {
  Options options = Quiet();
  options.disturb.board_bend_m = 0.01;
  const Experiment bent = Prepared(SmallRig(), options);
  const SensorId left("left"), top("top");
  const RigBoard board = bent.BoardAt(TargetId("front"), 0);
  EXPECT_NEAR(std::abs(board.bend.At(board.bend.axis * board.target.plate_m->norm() / 2)), 0.01, 1e-12);
  const Se3 T_cam_plate = bent.T_world_sensor(left, 0).Inverse() * board.T_world_plate;
  std::vector<Eigen::Vector3d> points_cam;
  for (const Eigen::Vector3d& corner : TargetPoints(board.target)) {
    const Vector2d ab_m = corner.head<2>() - CentreOf(board.target).head<2>();
    points_cam.push_back(T_cam_plate * Eigen::Vector3d(ab_m.x(), ab_m.y(), board.bend.At(ab_m)));
  }
  const auto expected = PixelsOf(bent.rig.SensorOf(left).camera.intrinsics, points_cam);
  const auto corners = TrueCorners(bent, SceneAt(bent, 0), bent.rig.SensorOf(left), 0);
  ASSERT_TRUE(corners);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_LT(((*corners)[i] - expected[i]).norm(), 1e-9);
  const auto points = PlatePoints(bent, SceneAt(bent, 0), bent.rig.SensorOf(top), TargetId("front"), 0);
  ASSERT_GT(points.size(), 20u);
  double highest_m = 0;
  for (const ScanPoint& point : points) {
    const Eigen::Vector3d on_plate = board.T_world_plate.Inverse() * (bent.T_world_sensor(top, 0) * point.p_lidar);
    EXPECT_NEAR(on_plate.z(), board.bend.At(on_plate.head<2>()), 2e-4);  // the ray is followed to first order
    highest_m = std::max(highest_m, std::abs(on_plate.z()));
  }
  EXPECT_GT(highest_m, 2e-3);
}

TEST(SimLidarErrors, MixedPixelsLieBetweenTheirSurfacesAtEdgesOnly) {
  Options options = Quiet();
  options.disturb.mixed_pixels_ratio = 1;
  Rig rig = SmallRig();
  rig.sensors[2].lidar.firings_per_turn = 9000;
  const Experiment plain = Prepared(rig, Quiet()), mixed = Prepared(rig, options);
  const SensorId top("top");
  const auto scan = [&](const Experiment& experiment) {
    return Scan(SceneAt(experiment, 0), experiment.rig.SensorOf(top).lidar, experiment.T_world_sensor(top, 0), {}, 5);
  };
  const auto before = scan(plain), after = scan(mixed);
  ASSERT_EQ(before.size(), after.size());
  int between = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (after[i].panel_idx >= 0) {
      EXPECT_EQ(before[i].p_lidar, after[i].p_lidar);
      continue;
    }
    ++between;
    EXPECT_NE(before[i].range_m, after[i].range_m);
  }
  EXPECT_GT(between, 30);
  EXPECT_LT(between, static_cast<int>(before.size()) / 20);
}

TEST(SimLidarErrors, IncidenceBiasIsNoneHeadOnAndAsSaidAtSixtyDegrees) {
  Options options = Quiet();
  options.disturb.incidence_bias_m = 0.01;
  Rig rig = SmallRig();
  rig.sensors[2].lidar.elevations_rad.insert(rig.sensors[2].lidar.elevations_rad.begin(), -M_PI / 6);  // to the floor
  const Experiment biased = Prepared(rig, options);
  const SensorId top("top");
  const Scene scene = SceneAt(biased, 0);
  const Se3 T_world_lidar = biased.T_world_sensor(top, 0);
  double head_on_m = 1, aslant_m = 0;
  for (const ScanPoint& point : Scan(scene, biased.rig.SensorOf(top).lidar, T_world_lidar, {}, 5)) {
    const Panel& panel = scene.panels[static_cast<std::size_t>(point.panel_idx)];
    const double incidence = std::acos(std::abs(panel.outward.dot(T_world_lidar.R() * point.p_lidar.normalized())));
    const double error_m = point.p_lidar.norm() - point.range_m;
    if (incidence < 0.1) head_on_m = std::min(head_on_m, error_m);
    if (std::abs(incidence - M_PI / 3) < 0.01) aslant_m = error_m;
  }
  EXPECT_LT(head_on_m, 1e-4);
  EXPECT_NEAR(aslant_m, 0.01, 3e-4);
}

// Correlation of the corners' errors of captures k and k + 1, over all corners of all such captures.
double CorrelationOfNeighbours(int burst, bool within) {
  Options options;
  options.captures = 60;
  options.disturb.burst = burst;
  const Experiment noisy = Prepared(SmallRig(), options);
  options.noise_factor = 0;
  const Experiment quiet = Prepared(SmallRig(), options);
  const SensorId left("left");
  const Observations with = Observe(noisy), without = Observe(quiet);
  const auto error = [&](std::size_t k, std::size_t i) {
    return with.views.at(left).at(noisy.captures[k]).corners_px[i] -
           without.views.at(left).at(quiet.captures[k]).corners_px[i];
  };
  double products = 0, squares = 0;
  for (std::size_t k = 0; k + 1 < noisy.captures.size(); ++k) {
    const auto& views = with.views.at(left);
    if ((noisy.BurstOf(k) == noisy.BurstOf(k + 1)) != within) continue;
    if (!views.at(noisy.captures[k]).found || !views.at(noisy.captures[k + 1]).found) continue;
    for (std::size_t i = 0; i < views.at(noisy.captures[k]).corners_px.size(); ++i) {
      products += error(k, i).dot(error(k + 1, i));
      squares += (error(k, i).squaredNorm() + error(k + 1, i).squaredNorm()) / 2;
    }
  }
  return products / squares;
}

TEST(SimBursts, CapturesOfABurstAreNearEachOtherAndWrongAlike) {
  Options options = Quiet();
  options.captures = 12;
  options.disturb.burst = 4;
  const Experiment bursts = Prepared(SmallRig(), options);
  double within_m = 0, across_m = 1;
  for (std::size_t k = 0; k + 1 < 12; ++k) {
    const double apart_m = (bursts.T_world_body[k].p_m - bursts.T_world_body[k + 1].p_m).norm();
    if (k % 4 == 3) across_m = std::min(across_m, apart_m);
    if (k % 4 != 3) within_m = std::max(within_m, apart_m);
  }
  EXPECT_LT(within_m, 0.02);
  EXPECT_GT(within_m, 1e-4);
  EXPECT_GT(across_m, 0.02);
  EXPECT_NEAR(CorrelationOfNeighbours(4, true), 0.8, 0.1);
  EXPECT_NEAR(CorrelationOfNeighbours(4, false), 0.0, 0.2);
}

Options Swaying(double late_s) {
  Options options = Quiet();
  options.disturb.sway_per_s = {0.2, 0.17};
  options.disturb.pose_clock_late_s = late_s;
  return options;
}

TEST(SimPoseClock, TellsWhereTheBodyWasBeforeAndMovesNothingElse) {
  const Experiment plain = Prepared(SmallRig(), Quiet()), late = Prepared(SmallRig(), Swaying(0.02));
  EXPECT_TRUE(MovedViews(plain, late).empty());
  const RigSensor& body = late.rig.SensorOf(SensorId("body"));
  const std::vector<TrackerRow> rows = TrackerRows(late, body);
  ASSERT_EQ(rows.size(), late.captures.size());
  for (const TrackerRow& row : rows) {
    const Se3 was = late.T_world_body[row.capture_idx] * SwayOf(late, row.capture_idx, -0.02) * body.T_body_sensor;
    EXPECT_LT((was.Inverse() * row.T_world_body).Log().norm(), 1e-12);
    EXPECT_GT((late.T_world_sensor(body.id, row.capture_idx).Inverse() * row.T_world_body).Log().norm(), 1e-5);
    EXPECT_EQ(SwayOf(late, row.capture_idx, 0.0), Se3{});
  }
}

TEST(SimPoseClock, HasTheSpeedThatIsAskedFor) {
  Options options = Swaying(0.0);
  options.captures = 400;
  const Experiment visit = Prepared(SmallRig(), options);
  double squares_m2 = 0, squares_rad2 = 0;
  for (std::size_t k = 0; k < visit.captures.size(); ++k) {
    const Vector6d twist = (SwayOf(visit, k, -1e-4).Inverse() * SwayOf(visit, k, 1e-4)).Log() / 2e-4;
    squares_m2 += twist.head<3>().squaredNorm() / 400;
    squares_rad2 += twist.tail<3>().squaredNorm() / 400;
  }
  // An rms of 1,200 numbers is within 5 of its own sigmas of 2 %.
  EXPECT_NEAR(std::sqrt(squares_m2), 0.2, 0.1 * 0.2);
  EXPECT_NEAR(std::sqrt(squares_rad2), 0.17, 0.1 * 0.17);
}

TEST(SimPoseClock, APathIsToldOnlyWhereBodiesSway) {
  const Experiment plain = Prepared(SmallRig(), Quiet()), swaying = Prepared(SmallRig(), Swaying(0.0));
  const RigSensor& body = plain.rig.SensorOf(SensorId("body"));
  const auto path_of = [&](const Experiment& visit) {
    return formats::ReadTrackerPath(PosesCsv(visit, body, TrackerRows(visit, body)), "poses.csv").value();
  };
  EXPECT_TRUE(path_of(plain).empty());
  const PoseTable path = path_of(swaying);
  ASSERT_EQ(path.size(), swaying.captures.size() * 50);
  const double since_s = 1e-9 * static_cast<double>(path[60].stamp.ns - swaying.stamps_ns[1]);
  EXPECT_LT((ToldByTracker(swaying, body, 1, since_s).Inverse() * path[60].T_world_body).Log().norm(), 1e-9);
}

TEST(SimPoseClock, IsRefusedBeyondASecond) {
  EXPECT_EQ(Prepare(SmallRig(), Swaying(1.5)).error().what, "pose-clock-offset is out of range");
}

}  // namespace
}  // namespace rigcal::sim
