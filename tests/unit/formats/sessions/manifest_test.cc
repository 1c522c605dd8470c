#include "server/base/digests/sha256.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using samples::SampleManifest;

TEST(ManifestDocument, HasTheGoldenBytes) { samples::ExpectGolden("manifest.json", WriteManifest(SampleManifest())); }

TEST(ManifestDocument, ComesBackWhole) {
  const Manifest manifest = SampleManifest();
  const Result<Manifest> read = ReadManifest(WriteManifest(manifest));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->header.captured_at, manifest.header.captured_at);
  EXPECT_EQ(read->header.operator_name, manifest.header.operator_name);
  EXPECT_EQ(read->header.conditions, manifest.header.conditions);
  ASSERT_EQ(read->header.sensors.size(), 2u);
  const Sensor& right = read->header.sensors[0];
  EXPECT_EQ(right.id, SensorId("right"));
  EXPECT_EQ(right.intrinsics->cy_px, 1.0 / 3.0);
  EXPECT_EQ(right.intrinsics->distortion[1], 0.11);
  EXPECT_EQ(right.intrinsics_sigma, manifest.header.sensors[0].intrinsics_sigma);
  EXPECT_EQ(right.T_ref_nominal->q.y(), 0.6);
  EXPECT_FALSE(read->header.sensors[1].intrinsics || read->header.sensors[1].sees);
  EXPECT_EQ(read->header.targets[0].cols, 9);
  EXPECT_EQ(read->payloads[1].size_bytes, 2147483648);
  EXPECT_EQ(read->payloads[1].capture, CaptureId("01"));
  EXPECT_EQ(WriteManifest(*read), WriteManifest(manifest));
}

TEST(ManifestDocument, HoldsSphereModels) {
  Manifest manifest = SampleManifest();
  std::vector<Sensor>& sensors = manifest.header.sensors;
  const auto camera =
      std::find_if(sensors.begin(), sensors.end(), [](const Sensor& one) { return one.kind == SensorKind::kCamera; });
  ASSERT_NE(camera, sensors.end());
  const auto index = static_cast<std::size_t>(camera - sensors.begin());
  camera->camera_model = CameraModel::kDoubleSphere;
  camera->intrinsics = {240, 241, 320, 239.5, {-0.21, 0.59}, CameraModel::kDoubleSphere};
  camera->intrinsics_sigma = {1, 1, 0.5, 0.5, 0.01, 0.02};
  const std::string given = WriteManifest(manifest);
  const auto back = ReadManifest(given);
  ASSERT_TRUE(back) << Sentence(back.error());
  EXPECT_EQ(WriteManifest(*back), given);
  EXPECT_EQ(back->header.sensors[index].intrinsics, camera->intrinsics);
  camera->camera_model = CameraModel::kEucm;
  camera->intrinsics.reset(), camera->intrinsics_sigma.reset();
  const auto estimated = ReadManifest(WriteManifest(manifest));
  ASSERT_TRUE(estimated) << Sentence(estimated.error());
  EXPECT_EQ(estimated->header.sensors[index].camera_model, CameraModel::kEucm);
}

TEST(ManifestDocument, HoldsTablesOfPosesAndSkippedPairs) {
  Manifest manifest = SampleManifest();
  EXPECT_EQ(WriteManifest(manifest).find("skip_pairs"), std::string::npos);
  EXPECT_EQ(WriteManifest(manifest).find("remounted"), std::string::npos);
  Sensor vicon;
  vicon.id = SensorId("vicon");
  vicon.kind = SensorKind::kTracker;
  manifest.header.sensors.push_back(vicon);
  manifest.header.remounted = {SensorId("right")};
  manifest.header.skip_pairs = {{SensorId("vicon"), SensorId("left")}, {SensorId("left"), SensorId("right")}};
  Payload table = manifest.payloads.back();
  table.path = "vicon/poses.csv";
  table.sensor = SensorId("vicon");
  table.capture = CaptureId("poses");
  manifest.payloads.push_back(table);
  const Result<Manifest> read = ReadManifest(WriteManifest(manifest));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->header.skip_pairs, manifest.header.skip_pairs);
  EXPECT_EQ(read->header.remounted, manifest.header.remounted);
  EXPECT_EQ(read->header.sensors.back().kind, SensorKind::kTracker);
  EXPECT_EQ(read->payloads.back().capture, CaptureId("poses"));
  EXPECT_EQ(WriteManifest(*read), WriteManifest(manifest));
  manifest.payloads.back().path = "vicon/01.csv";
  manifest.payloads.back().capture = CaptureId("01");
  EXPECT_EQ(Validate(manifest).error().what, "file \"vicon/01.csv\": the path is not <sensor>/poses.csv");
}

TEST(ManifestDocument, HoldsWhatIsKnownOfATrackersClockWhereItIsTold) {
  Manifest manifest = SampleManifest();
  EXPECT_EQ(WriteManifest(manifest).find("clock_sigma_s"), std::string::npos);
  Sensor body;
  body.id = SensorId("body");
  body.kind = SensorKind::kTracker;
  body.clock_sigma_s = 0.002;
  manifest.header.sensors.push_back(body);
  const Result<Manifest> read = ReadManifest(WriteManifest(manifest));
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->header.sensors.back().clock_sigma_s, 0.002);
  EXPECT_EQ(WriteManifest(*read), WriteManifest(manifest));
}

TEST(ManifestDocument, HoldsThePolishOfLidarsWhereOneIsAskedFor) {
  Manifest manifest = SampleManifest();
  for (const char* name : {"top", "rear"}) {
    Sensor lidar;
    lidar.id = SensorId(name);
    lidar.kind = SensorKind::kLidar;
    manifest.header.sensors.push_back(lidar);
  }
  const std::string plain = WriteManifest(manifest);
  EXPECT_EQ(plain.find("lidar_polish"), std::string::npos);
  EXPECT_EQ(ReadManifest(plain)->header.lidar_polish, LidarPolish::kNone);
  manifest.header.lidar_polish = LidarPolish::kGicp;
  std::string polished = WriteManifest(manifest);
  const Result<Manifest> read = ReadManifest(polished);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->header.lidar_polish, LidarPolish::kGicp);
  EXPECT_EQ(WriteManifest(*read), polished);
  EXPECT_NE(Sha256Of(polished), Sha256Of(plain));  // another session
  polished.replace(polished.find("gicp"), 4, "icp");
  EXPECT_EQ(ReadManifest(polished).error().what, "manifest: lidar_polish: polish \"icp\" is not known");
}

// A server from before reads format 1 only: it would take the clouds for KITTI's.
TEST(ManifestDocument, FieldsOfABinMakeItFormat2) {
  Manifest manifest = SampleManifest();
  Sensor lidar;
  lidar.id = SensorId("top");
  lidar.kind = SensorKind::kLidar;
  manifest.header.sensors.push_back(lidar);
  const std::string plain = WriteManifest(manifest);
  EXPECT_NE(plain.find("\"format\":1,"), std::string::npos);
  EXPECT_EQ(plain.find("\"fields\""), std::string::npos);
  manifest.header.sensors.back().layout = CloudLayout{{"x", "y", "z", "intensity", "ring"}, PointType::kFloat64};
  std::string text = WriteManifest(manifest);
  EXPECT_NE(text.find("\"format\":2,"), std::string::npos);
  EXPECT_NE(text.find("{\"T_ref_nominal\":null,\"fields\":[\"x\",\"y\",\"z\",\"intensity\",\"ring\"],\"id\":\"top\""),
            std::string::npos);
  const Result<Manifest> read = ReadManifest(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->header.sensors.back().layout, manifest.header.sensors.back().layout);
  EXPECT_EQ(WriteManifest(*read), text);
  text.replace(text.find("\"ring\""), 6, "\"x\"");
  EXPECT_NE(ReadManifest(text).error().what.find("sensor top: fields: \"x\" occurs twice"), std::string::npos);
}

struct BadManifest {
  std::string from, to, what;
};

class RefusedManifest : public testing::TestWithParam<BadManifest> {};

TEST_P(RefusedManifest, NamesTheField) {
  std::string text = WriteManifest(SampleManifest());
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos) << text;
  text.replace(at, GetParam().from.size(), GetParam().to);
  const Result<Manifest> read = ReadManifest(text);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().what, GetParam().what);
  EXPECT_FALSE(read.error().cure.empty());
}

// Older servers would take such a board to stand still: they refuse the format.
TEST(ManifestDocument, ATargetOnATrackerIsFormatThree) {
  Manifest manifest = SampleManifest();
  Sensor arm;
  arm.id = SensorId("arm");
  arm.kind = SensorKind::kTracker;
  manifest.header.sensors.push_back(arm);
  for (Target& target : manifest.header.targets) target.mounted_on = arm.id;
  const std::string text = WriteManifest(manifest);
  EXPECT_NE(text.find("\"format\":3"), std::string::npos) << text;
  EXPECT_NE(text.find("\"mounted_on\":\"arm\""), std::string::npos) << text;
  const Result<Manifest> read = ReadManifest(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(read->header.targets, manifest.header.targets);
  EXPECT_EQ(WriteManifest(*read), text);
  EXPECT_EQ(WriteManifest(SampleManifest()).find("mounted_on"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, RefusedManifest,
    testing::Values(
        BadManifest{"\"format\":1", "\"format\":2",
                    "manifest: format: must be 1, or 2 where a sensor has fields, 3 where a target is mounted on a "
                    "tracker, 4 where "
                    "one has ids or an offset of its plate"},
        BadManifest{"\"robot\":\"mapper-01\"", "\"robot\":\"../x\"",
                    "manifest: robot: robot id \"../x\" is not a valid name"},
        BadManifest{"\"type\":\"camera\"", "\"type\":\"camra\"",
                    "manifest: sensors[0].type: sensor kind \"camra\" is not known"},
        BadManifest{"\"type\":\"camera\"", "\"type\":\"tracker\"", "sensor right: a tracker has no intrinsics"},
        BadManifest{"pinhole_radtan", "fisheye",
                    "manifest: sensors[0].intrinsics.model: camera model \"fisheye\" is not known"},
        BadManifest{"0.0,0.6,0.0,0.8", "0.0,0.6,0.0,0.7",
                    "manifest: sensors[0].T_ref_nominal.q_xyzw: must have unit length (it is 0.921954)"},
        BadManifest{"\"inner_corners\":[9,6]", "\"inner_corners\":[9]",
                    "manifest: targets[0].inner_corners: must be two integers: columns and rows"},
        BadManifest{"\"checkerboard\"", "\"charuco\"", "manifest: targets[0]: \"dictionary\" is missing"},
        BadManifest{"\"sees\":\"board\"", "\"sees\":\"b\"",
                    "sensor right: it sees target \"b\", which the session does not list"},
        BadManifest{"left/01.png", "left/../../etc/passwd",
                    "manifest: payloads[0].path: file \"left/../../etc/passwd\": it is not in a sensor's folder"},
        BadManifest{"left/01.png", "left/01.exe",
                    "manifest: payloads[0].path: file \"left/01.exe\": its name does not end in .png, .jpg, "
                    ".jpeg, .pcd, .ply, .bin or .csv"},
        BadManifest{"left/01.png", "left/.png",
                    "manifest: payloads[0].path: file \"left/.png\": capture id \"\" is not a valid name"},
        BadManifest{"left/01.png", "up/01.png", "file \"up/01.png\": sensor up is not in the session"},
        BadManifest{"left/01.png", "right/02.png", "file \"right/02.png\": it is listed twice or out of order"},
        BadManifest{"aaaa\"", "aaa\"",
                    "manifest: payloads[0].sha256: sha256 \"" + std::string(63, 'a') + "\" is not a sha256 digest"},
        BadManifest{"\"size_bytes\":123", "\"size_bytes\":-1",
                    "manifest: payloads[0].size_bytes: must be an integer from 1 to 2147483648"},
        BadManifest{
            "2026-01-31T", "31.1.2026 ",
            "manifest: captured_at: time \"31.1.2026 12:00:00.123456789Z\" is not a date between 1970 and 2200"}));

}  // namespace
}  // namespace rigcal::formats
