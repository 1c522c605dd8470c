#include "server/model/sessions/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "server/model/edges/method.h"
#include "server/model/edges/past.h"
#include "tests/unit/model/values.h"

namespace rigcal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
Sensor Camera(const char* id) {
  Sensor sensor;
  sensor.id = SensorId(id);
  return sensor;
}

Sensor Of(const char* id, SensorKind kind, const char* sees = nullptr) {
  Sensor sensor = Camera(id);
  sensor.kind = kind;
  if (sees) sensor.sees = TargetId(sees);
  return sensor;
}

SessionHeader GoodHeader() {
  SessionHeader header;
  header.robot = RobotId("mapper-01");
  header.reference = SensorId("left");
  header.sensors = {Camera("left"), Camera("right")};
  header.targets = {{TargetId("board"), 9, 6, 0.025, 0.0, "A-17"}};
  header.operator_name = "Jürgen";
  return header;
}

Error HeaderRefusalAfter(const std::function<void(SessionHeader&)>& change) {
  SessionHeader header = GoodHeader();
  change(header);
  const Status status = Validate(header);
  if (status) return {};
  EXPECT_FALSE(status.error().cure.empty());
  return status.error();
}

TEST(ValidateHeader, AcceptsAGoodOne) {
  EXPECT_EQ(HeaderRefusalAfter([](SessionHeader&) {}).what, "");
}

TEST(ValidateHeader, NamesWhatIsMissingOrDouble) {
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.reference = SensorId("top"); }).what, HasSubstr("\"top\""));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.sensors.push_back(Camera("left")); }).what,
              HasSubstr("left is listed twice"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.sensors.push_back(Camera("LEFT")); }).what,
              HasSubstr("sensor LEFT differs from left only in case"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.targets.push_back(h.targets[0]); }).what,
              HasSubstr("board is listed twice"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.sensors[1].sees = TargetId("wall"); }).what,
              HasSubstr("sensor right: it sees target \"wall\""));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.sensors.clear(); }).what, HasSubstr("sensors"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.targets.clear(); }).what, HasSubstr("targets"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.sensors.resize(1025, Camera("x")); }).cure, HasSubstr("1024"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.robot = RobotId("a/b"); }).what, HasSubstr("robot id"));
}

TEST(ValidateHeader, RefusesNewerFormats) {
  const Error error = HeaderRefusalAfter([](auto& h) { h.format = 2; });
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_THAT(error.what, HasSubstr("format 2"));
}

TEST(ValidateHeader, PosesHaveNeitherIntrinsicsNorATarget) {
  for (SensorKind kind : {SensorKind::kTracker, SensorKind::kPoseStream}) {
    SessionHeader header = GoodHeader();
    header.sensors[1] = Of("right", kind);
    EXPECT_TRUE(Validate(header).has_value());
    header.sensors[1].sees = header.targets[0].id;
    EXPECT_THAT(Validate(header).error().what, HasSubstr("sees no target"));
    header.sensors[1].sees.reset();
    header.sensors[1].intrinsics = CameraIntrinsics{};
    EXPECT_THAT(Validate(header).error().what, HasSubstr("has no intrinsics"));
  }
}

TEST(ValidateHeader, TargetsAreNeededByCamerasOnly) {
  SessionHeader header = GoodHeader();
  header.targets.clear();
  for (Sensor& sensor : header.sensors) sensor.sees.reset();
  EXPECT_THAT(Validate(header).error().what, HasSubstr("targets: the session has 0"));
  for (Sensor& sensor : header.sensors) sensor.kind = SensorKind::kPoseStream;
  EXPECT_TRUE(Validate(header).has_value());
}

TEST(ValidateHeader, SkippedPairsAreOfTwoSensors) {
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) {
                h.skip_pairs = {{SensorId("left"), SensorId("top")}};
              }).what,
              HasSubstr("skip_pairs: [left, top]: \"top\" is not a sensor"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) {
                h.remounted = {SensorId("left"), SensorId("top")};
              }).what,
              HasSubstr("remounted: \"top\" is not a sensor"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) {
                h.skip_pairs = {{SensorId("left"), SensorId("left")}};
              }).what,
              HasSubstr("no pair with itself"));
}

TEST(ValidateHeader, ARemountedSensorIsMeasuredAnew) {
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) {
                h.remounted = {SensorId("left")};
                h.skip_pairs = {{SensorId("left"), SensorId("right")}};
              }).what,
              HasSubstr("remounted: \"left\" is in no pair that is calibrated"));
}

TEST(ValidateHeader, APolishIsOfTwoLidars) {
  const auto cameras = HeaderRefusalAfter([](auto& h) { h.lidar_polish = LidarPolish::kGicp; });
  EXPECT_EQ(cameras.what, "lidar_polish: the session has no two lidars that are calibrated with each other");
  EXPECT_FALSE(cameras.cure.empty());
  SessionHeader header = GoodHeader();
  header.lidar_polish = LidarPolish::kGicp;
  header.sensors.push_back(Of("top", SensorKind::kLidar));
  EXPECT_FALSE(Validate(header));
  header.sensors.push_back(Of("rear", SensorKind::kLidar));
  EXPECT_TRUE(Validate(header)) << Sentence(Validate(header).error());
  header.skip_pairs = {{SensorId("rear"), SensorId("top")}};
  EXPECT_THAT(Validate(header).error().what, HasSubstr("lidar_polish"));
  header.lidar_polish = LidarPolish::kNone;
  EXPECT_TRUE(Validate(header));
}

TEST(LidarPolish, HasTheNamesOfThoseThatThereAre) {
  for (const LidarPolish polish : {LidarPolish::kNone, LidarPolish::kGicp})
    EXPECT_EQ(*LidarPolishOf(NameOf(polish)), polish);
  const auto unknown = LidarPolishOf("point_to_plane");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().what, "polish \"point_to_plane\" is not known");
  EXPECT_THAT(unknown.error().cure, HasSubstr("gicp"));
}

TEST(AddRemounted, InWhateverOrderAndHoweverOftenSensorsAreNamed) {
  SessionHeader one, other;
  for (const char* name : {"left", "top", "left", "body"}) AddRemounted(SensorId(name), one);
  for (const char* name : {"top", "body", "left"}) AddRemounted(SensorId(name), other);
  EXPECT_EQ(one.remounted, (std::vector<SensorId>{SensorId("body"), SensorId("left"), SensorId("top")}));
  EXPECT_EQ(other.remounted, one.remounted);
}

TEST(ValidateHeader, TextsMustBeReadable) {
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.operator_name = "a\nb"; }).what, HasSubstr("operator"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.rig_model = "\xff"; }).what, HasSubstr("rig_model"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.conditions["light"] = "\x01"; }).what, HasSubstr("conditions light"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) { h.targets[0].serial = std::string(300, 'x'); }).what,
              HasSubstr("serial"));
}

TEST(ValidateSensor, IntrinsicsAreInRange) {
  const auto refusal = [](const std::function<void(Sensor&)>& change) {
    return HeaderRefusalAfter([&](SessionHeader& header) {
             header.sensors[1].intrinsics = CameraIntrinsics{530, 530, 320, 240};
             change(header.sensors[1]);
           })
        .what;
  };
  EXPECT_EQ(refusal([](Sensor&) {}), "");
  EXPECT_EQ(refusal([](Sensor& s) { s.intrinsics_sigma = std::vector<double>(9, 0.1); }), "");
  EXPECT_THAT(refusal([](Sensor& s) { s.intrinsics->fy_px = 0; }), HasSubstr("sensor right: intrinsics"));
  EXPECT_THAT(refusal([](Sensor& s) { s.intrinsics->distortion[4] = kNaN; }), HasSubstr("sensor right: intrinsics"));
  EXPECT_THAT(refusal([](Sensor& s) { s.intrinsics->distortion.pop_back(); }),
              HasSubstr("fit the model pinhole_radtan"));
  EXPECT_THAT(refusal([](Sensor& s) { s.camera_model = CameraModel::kFisheyeKb4; }), HasSubstr("model fisheye_kb4"));
  EXPECT_THAT(refusal([](Sensor& s) { s.range_bias_sigma_m = 0.01; }), HasSubstr("for lidars only"));
  EXPECT_THAT(refusal([](Sensor& s) { s.clock_sigma_s = 0.01; }), HasSubstr("for trackers only"));
  EXPECT_THAT(refusal([](Sensor& s) { s.kind = SensorKind::kLidar; }), HasSubstr("a lidar has no intrinsics"));
  EXPECT_THAT(refusal([](Sensor& s) { s.intrinsics_sigma = std::vector<double>(8, 0.1); }), HasSubstr("9 finite"));
  EXPECT_THAT(refusal([](Sensor& s) { s.intrinsics_sigma = std::vector<double>(9, -0.1); }), HasSubstr("9 finite"));
  EXPECT_THAT(refusal([](Sensor& s) {
                s.intrinsics_sigma = std::vector<double>(9, 0.1);
                s.intrinsics.reset();
              }),
              HasSubstr("without intrinsics"));
}

TEST(ValidateSensor, SphereModelsHaveTheirRanges) {
  const auto refusal = [](CameraModel model, std::vector<double> distortion) {
    return HeaderRefusalAfter([&](SessionHeader& header) {
             header.sensors[1].camera_model = model;
             header.sensors[1].intrinsics = CameraIntrinsics{530, 530, 320, 240, distortion, model};
           })
        .what;
  };
  EXPECT_EQ(refusal(CameraModel::kEucm, {0.6, 1.1}), "");
  EXPECT_EQ(refusal(CameraModel::kEucm, {0.0, 1.0}), "") << "a pinhole";
  EXPECT_EQ(refusal(CameraModel::kDoubleSphere, {-0.2, 1.0}), "");
  EXPECT_EQ(refusal(CameraModel::kEucm, {1.1, 0.6}), "sensor right: intrinsics: alpha 1.1 is not within 0 to 1");
  EXPECT_THAT(refusal(CameraModel::kEucm, {0.6, 0.0}), HasSubstr("beta 0 is not above 0"));
  EXPECT_THAT(refusal(CameraModel::kDoubleSphere, {1.0, 0.6}), HasSubstr("xi 1 is not between -1 and 1"));
  EXPECT_THAT(refusal(CameraModel::kDoubleSphere, {0.2, kNaN}), HasSubstr("a value is not finite"));
  EXPECT_THAT(refusal(CameraModel::kDoubleSphere, {0.2}), HasSubstr("fit the model double_sphere"));
}

TEST(CameraModels, EveryNameIsReadBack) {
  for (const CameraModel model : {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational, CameraModel::kFisheyeKb4,
                                  CameraModel::kEucm, CameraModel::kDoubleSphere})
    EXPECT_EQ(CameraModelOf(NameOf(model)).value(), model);
  EXPECT_THAT(CameraModelOf("ds").error().cure, HasSubstr("eucm or double_sphere"));
}

TEST(CameraModels, TheAxisOfADoubleSphereIsNotAsLongAsItsFocalLength) {
  EXPECT_DOUBLE_EQ(AxialFocal_px({400, 400, 0, 0, {-0.2, 0.6}, CameraModel::kDoubleSphere}), 500);
  EXPECT_DOUBLE_EQ(AxialFocal_px({400, 400, 0, 0, {0.6, 1.2}, CameraModel::kEucm}), 400);
  EXPECT_DOUBLE_EQ(AxialFocal_px({400, 400, 0, 0, {-0.2, 0.6, 0, 0, 0}, CameraModel::kPinholeRadtan}), 400);
}

TEST(ValidateSensor, NominalPoseIsAPose) {
  EXPECT_EQ(HeaderRefusalAfter([](auto& h) { h.sensors[1].T_ref_nominal = Se3{}; }).what, "");
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) {
                h.sensors[1].T_ref_nominal = Se3{{kNaN, 0, 0}, {1, 0, 0, 0}};
              }).what,
              HasSubstr("sensor right: nominal p_m"));
  EXPECT_THAT(HeaderRefusalAfter([](auto& h) {
                h.sensors[1].T_ref_nominal = Se3{{0, 0, 0}, {2, 0, 0, 0}};
              }).what,
              HasSubstr("sensor right: nominal q_xyzw"));
}

Target Board(int cols, int rows) { return {TargetId("board"), cols, rows, 0.025, 0.0, ""}; }

TEST(Target, LooksTheSameTurned) {
  EXPECT_EQ(SymmetryOf(Board(9, 6)), 1);
  EXPECT_EQ(SymmetryOf(Board(7, 5)), 2);
  EXPECT_EQ(SymmetryOf(Board(8, 6)), 2);
  EXPECT_EQ(SymmetryOf(Board(7, 7)), 2);
  EXPECT_EQ(SymmetryOf(Board(6, 6)), 4);
}

// Turning the board about its centre carries each point onto the one that takes its index.
TEST(Target, TurnedIndexIsTheRotationAboutTheCentre) {
  for (const Target& board : {Board(7, 5), Board(6, 6), Board(8, 6), Board(9, 6)}) {
    const auto points = TargetPoints(board);
    for (int turn = 0; turn < SymmetryOf(board); ++turn) {
      const Eigen::Rotation2Dd back(-2 * M_PI * turn / SymmetryOf(board));
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d moved = back * (points[i] - CentreOf(board)).head<2>() + CentreOf(board).head<2>();
        const auto at = static_cast<std::size_t>(TurnedIndex(board, static_cast<int>(i), turn));
        EXPECT_LT((points[at].head<2>() - moved).norm(), 1e-12) << board.cols << " turn " << turn << " point " << i;
      }
    }
  }
}

TEST(Target, TagsAreNumberedFromTheTopOrTheBottom) {
  Target grid = Board(3, 2);
  grid.kind = TargetKind::kArucoGrid;
  grid.square_m = 0.1;
  grid.spacing_ratio = 0.5;
  EXPECT_EQ(TargetPoints(grid).size(), 24u);
  EXPECT_LT((TargetPoints(grid)[4 * 3] - Eigen::Vector3d(0, 0.15, 0)).norm(), 1e-12);
  EXPECT_LT((PatternSize_m(grid) - Eigen::Vector2d(0.4, 0.25)).norm(), 1e-12);
  EXPECT_LT((CentreOf(grid) - Eigen::Vector3d(0.2, 0.125, 0)).norm(), 1e-12);
  grid.kind = TargetKind::kAprilGrid;
  EXPECT_LT((TargetPoints(grid)[0] - Eigen::Vector3d(0, 0.15, 0)).norm(), 1e-12);
  EXPECT_LT((TargetPoints(grid)[4 * 5 + 2] - Eigen::Vector3d(0.4, 0.1, 0)).norm(), 1e-12);
}

TEST(ValidateTarget, MarkersAndPlateFitTheKind) {
  const auto refusal = [](const auto& change) {
    Target target = Board(4, 3);
    target.kind = TargetKind::kCharuco;
    target.dictionary = "DICT_4X4_50";
    target.marker_m = 0.018;
    change(target);
    const Status status = Validate(target);
    return status ? std::string() : status.error().what;
  };
  EXPECT_EQ(refusal([](Target&) {}), "");
  EXPECT_THAT(refusal([](Target& t) { t.dictionary = "DICT_9X9"; }), HasSubstr("dictionary \"DICT_9X9\" is not known"));
  EXPECT_THAT(refusal([](Target& t) { t.marker_m = 0.025; }), HasSubstr("marker_size_m"));
  EXPECT_THAT(refusal([](Target& t) { t.marker_m = kNaN; }), HasSubstr("marker_size_m"));
  EXPECT_THAT(refusal([](Target& t) { t.kind = TargetKind::kAprilGrid; }), HasSubstr("spacing_ratio"));
  EXPECT_THAT(refusal([](Target& t) { t.kind = TargetKind::kCheckerboard; }), HasSubstr("has no dictionary"));
  EXPECT_EQ(refusal([](Target& t) { t.plate_m = {0.125, 0.1}; }), "");
  EXPECT_THAT(refusal([](Target& t) { t.plate_m = {0.1, 0.125}; }), HasSubstr("plate_size_m 0.100000 does not fit"));
  EXPECT_THAT(refusal([](Target& t) { t.plate_m = {kNaN, 0.125}; }), HasSubstr("plate_size_m"));
}

TEST(ValidateTarget, CountsAndSizesAreInRange) {
  EXPECT_TRUE(Validate(Board(3, 100)).has_value());
  EXPECT_FALSE(Validate(Board(2, 5)).has_value());
  EXPECT_FALSE(Validate(Board(101, 6)).has_value());
  EXPECT_FALSE(Validate(Board(9, -6)).has_value());
  const auto accepts = [](double square_m, double sigma_m) {
    Target board = Board(9, 6);
    board.square_m = square_m;
    board.square_sigma_m = sigma_m;
    return Validate(board).has_value();
  };
  EXPECT_TRUE(accepts(0.001, 0));
  EXPECT_TRUE(accepts(1.0, 0.001));
  EXPECT_FALSE(accepts(0.00099, 0));
  EXPECT_FALSE(accepts(25, 0));  // millimetres by mistake
  EXPECT_FALSE(accepts(kNaN, 0));
  EXPECT_FALSE(accepts(0.025, -1e-6));
  EXPECT_FALSE(accepts(0.025, 0.02));
  EXPECT_FALSE(accepts(0.025, kNaN));
}

TEST(SensorKind, NamesRoundTrip) {
  for (const char* name : {"camera", "lidar", "tracker", "pose_stream"})
    EXPECT_EQ(NameOf(SensorKindOf(name).value()), name);
  EXPECT_FALSE(SensorKindOf("nose").has_value());
}

// "d c stereo; d a lidar_camera"
std::string PairsOf(const SessionHeader& header) {
  std::string text;
  const auto sensor = [&](const SensorId& id) {
    return *std::find_if(header.sensors.begin(), header.sensors.end(), [&](const Sensor& s) { return s.id == id; });
  };
  for (const SensorPair& pair : PairsToCalibrate(header))
    text += (text.empty() ? "" : "; ") + pair.a.str() + " " + pair.b.str() + " " +
            NameOf(MethodFor(header, sensor(pair.a), sensor(pair.b)).value());
  return text;
}

TEST(PairsToCalibrate, OfCamerasAndLidars) {
  SessionHeader header = GoodHeader();
  constexpr auto kCamera = SensorKind::kCamera, kLidar = SensorKind::kLidar;
  header.sensors = {Of("d", kCamera, "board"), Of("c", kCamera, "board"), Of("b", kCamera, "wall"), Of("a", kLidar)};
  EXPECT_EQ(PairsOf(header),
            "d c stereo; d b non_overlapping; d a lidar_camera; c b non_overlapping; c a lidar_camera; "
            "b a lidar_camera");
  header.sensors[2] = Of("b", kLidar, "wall");  // b sees another board than the cameras
  EXPECT_EQ(PairsOf(header), "d c stereo; d a lidar_camera; c a lidar_camera; b a lidar_lidar");
  header.sensors[2] = Of("b", kCamera);
  header.sensors.pop_back();
  EXPECT_EQ(PairsOf(header), "d c stereo; d b stereo; c b stereo");
  header.sensors.resize(1);
  EXPECT_EQ(PairsOf(header), "");
}

TEST(NominalPose, NeedsNoDrawingOfTheReference) {
  SessionHeader header = GoodHeader();
  Sensor &left = header.sensors[0], &right = header.sensors[1];
  EXPECT_FALSE(NominalPose(header, left, right));
  right.T_ref_nominal = Se3{Eigen::Vector3d(0.2, 0, 0), Eigen::Quaterniond(0, 1, 0, 0)};
  EXPECT_EQ(NominalPose(header, left, right)->p_m, Eigen::Vector3d(0.2, 0, 0));
  EXPECT_EQ(NominalPose(header, right, left)->p_m, Eigen::Vector3d(-0.2, 0, 0));
  header.reference = right.id;
  EXPECT_FALSE(NominalPose(header, left, right));
  left.T_ref_nominal = Se3{Eigen::Vector3d(0, 3, 0), Eigen::Quaterniond::Identity()};
  EXPECT_EQ(NominalPose(header, left, right)->p_m,
            Eigen::Vector3d(0, -3, 0));  // right is the reference: its drawing is void
}

TEST(PairsToCalibrate, OfTrackersAndPoseStreams) {
  SessionHeader header = GoodHeader();
  constexpr auto kCamera = SensorKind::kCamera, kLidar = SensorKind::kLidar, kTracker = SensorKind::kTracker,
                 kStream = SensorKind::kPoseStream;
  header.sensors = {Of("body", kTracker), Of("d", kCamera), Of("top", kLidar), Of("vio", kStream), Of("odo", kStream)};
  EXPECT_EQ(PairsOf(header), "body d tracker_camera; body top tracker_lidar; d top lidar_camera; vio odo pose_streams");
  header.skip_pairs = {{SensorId("odo"), SensorId("vio")}, {SensorId("body"), SensorId("d")}};
  EXPECT_EQ(PairsOf(header), "body top tracker_lidar; d top lidar_camera");
  header.skip_pairs.push_back({SensorId("top"), SensorId("body")});
  EXPECT_EQ(PairsOf(header), "d top lidar_camera");
  header.skip_pairs.pop_back();
  header.targets.clear();  // nothing that stands still for the lidar
  EXPECT_EQ(PairsOf(header), "d top lidar_camera");
}

}  // namespace
}  // namespace rigcal
