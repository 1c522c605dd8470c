#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "client/sim/bound.h"
#include "client/sim/simulate.h"
#include "client/sim/visit/session_text.h"
#include "server/formats/sessions/session_folder.h"
#include "server/model/edges/method.h"
#include "tests/unit/client/sim/sample.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::sim {
namespace {

namespace fs = std::filesystem;

fs::path FreshFolder(const std::string& name) {
  static const TempFolder scratch;  // of this process
  fs::remove_all(scratch.path() / name);
  return scratch.path() / name;
}

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

std::map<std::string, std::string> FilesOf(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = BytesOf(entry.path());
  return files;
}

WriteSummary Written(const Experiment& experiment, const fs::path& folder, int threads,
                     PictureFormat format = PictureFormat::kJpeg) {
  Truth truth = TruthOf(experiment);
  for (const auto& [id, bound] : CramerRaoBound(experiment)) truth.sensors.at(id).bound = bound;
  const auto summary = WriteSession(experiment, truth, folder, {format, threads}, {});
  EXPECT_TRUE(summary) << (summary ? "" : Sentence(summary.error()));
  return summary.value_or(WriteSummary{});
}

Options Small(std::uint64_t seed = 1) {
  Options options;
  options.seed = seed;
  options.scale_ratio = 0.1;
  options.captures = 2;
  return options;
}

TEST(SimSession, SameBytesFromOneAndTwoThreadsOthersFromAnotherSeed) {
  const fs::path one = FreshFolder("one"), two = FreshFolder("two"), other = FreshFolder("other");
  Written(Prepared(MarsMapper(), Small()), one, 1);
  Written(Prepared(MarsMapper(), Small()), two, 2);
  Written(Prepared(MarsMapper(), Small(2)), other, 2);
  const auto files = FilesOf(one), others = FilesOf(other);
  EXPECT_EQ(files.size(), 2u * 11u + 1u + 2u);
  EXPECT_EQ(files, FilesOf(two));
  for (const auto& [path, bytes] : files) EXPECT_NE(bytes, others.at(path)) << path;
}

TEST(SimSession, MarsMapperFolderIsAcceptedWithItsPairs) {
  const fs::path folder = FreshFolder("mars");
  const WriteSummary summary = Written(Prepared(MarsMapper(), Small()), folder, 2);
  EXPECT_EQ(summary.pictures, 18u);
  EXPECT_EQ(summary.clouds, 4u);
  EXPECT_GT(summary.MegapixelsPerSecond(), 0);
  const auto manifest = formats::ReadSessionFolder(folder, {});
  ASSERT_TRUE(manifest) << Sentence(manifest.error());
  EXPECT_EQ(manifest->payloads.size(), 23u);
  const SessionHeader& header = manifest->header;
  std::map<std::string, int> methods;
  int pairs = 0;
  for (auto a = header.sensors.begin(); a != header.sensors.end(); ++a)
    for (auto b = a + 1; b != header.sensors.end(); ++b) {
      const bool skipped = std::any_of(header.skip_pairs.begin(), header.skip_pairs.end(), [&](const SensorPair& pair) {
        return (pair.a == a->id && pair.b == b->id) || (pair.a == b->id && pair.b == a->id);
      });
      if (skipped) continue;
      ++pairs;
      ++methods[NameOf(MethodFor(header, *a, *b).value())];
    }
  const std::map<std::string, int> expected = {
      {"stereo", 4}, {"non_overlapping", 32}, {"lidar_camera", 13}, {"lidar_lidar", 1}, {"tracker_camera", 9}};
  EXPECT_EQ(methods, expected);
  EXPECT_EQ(pairs, 59);
}

// What the robot reports, against what the cameras see: the board sits on the flange the same way in every capture.
TEST(SimSession, ARobotReportsItsFlangeInItsBase) {
  const auto rig = LoadRig("eye-to-hand-cell");
  ASSERT_TRUE(rig) << Sentence(rig.error());
  Options options;
  options.noise_factor = 0;
  options.captures = 6;
  const Experiment experiment = Prepared(*rig, options);
  const RigSensor& arm = experiment.rig.SensorOf(SensorId("arm"));
  const Se3 T_front_arm = experiment.T_ref_sensor(arm.id);
  std::vector<Se3> T_flange_board;
  for (const TrackerRow& row : TrackerRows(experiment, arm)) {
    const Se3 T_front_board = experiment.T_world_sensor(SensorId("front"), row.capture_idx).Inverse() *
                              experiment.BoardAt(TargetId("wrist"), row.capture_idx).T_world_board();
    T_flange_board.push_back(row.T_world_body.Inverse() * T_front_arm.Inverse() * T_front_board);
  }
  ASSERT_EQ(T_flange_board.size(), 6u);
  for (const Se3& T : T_flange_board) EXPECT_LT((T_flange_board[0].Inverse() * T).Log().norm(), 1e-9);
  EXPECT_LT(T_flange_board[0].p_m.norm(), 0.5);
  EXPECT_NE(SessionYaml(experiment).find("mounted_on: arm"), std::string::npos);
  EXPECT_EQ(*MethodFor(experiment.declared, experiment.declared.sensors[0], experiment.declared.sensors[2]),
            Method::kEyeToHand);
}

TEST(SimSession, SaysOfTheLensesWhatIsAskedFor) {
  Options options = Small();
  const auto declared = [&](IntrinsicsKind kind) {
    options.intrinsics = kind;
    const Experiment experiment = Prepared(MarsMapper(), options);
    return std::pair(experiment.declared.sensors[0], experiment.rig.sensors[0].camera);
  };
  const auto [exact, truth] = declared(IntrinsicsKind::kExact);
  EXPECT_EQ(exact.intrinsics->fx_px, truth.intrinsics.fx_px);
  EXPECT_FALSE(exact.intrinsics_sigma);
  EXPECT_FALSE(declared(IntrinsicsKind::kAbsent).first.intrinsics);
  const auto calibrated = declared(IntrinsicsKind::kCalibrated).first;
  const double sigmas = (calibrated.intrinsics->fx_px - truth.intrinsics.fx_px) / calibrated.intrinsics_sigma->at(0);
  EXPECT_NE(sigmas, 0);
  EXPECT_LT(std::abs(sigmas), 6);
}

TEST(SimSession, LeavesOutWhatDropsOutAndRefusesFoldersInUse) {
  Options options = Small();
  options.captures = 20;
  options.dropout_ratio = 0.5;
  const fs::path folder = FreshFolder("dropouts");
  const Experiment experiment = Prepared(SmallRig(), options);
  const WriteSummary summary = Written(experiment, folder, 2);
  EXPECT_GT(summary.pictures, 5u);
  EXPECT_LT(summary.pictures, 35u);
  const auto manifest = formats::ReadSessionFolder(folder, {});
  EXPECT_TRUE(manifest) << Sentence(manifest.error());
  const auto again = WriteSession(experiment, TruthOf(experiment), folder, {}, {});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kConflict);
}

TEST(SimTruth, ReadsBackWhatWasWritten) {
  Options options = Small();
  options.bump = SensorId("side");
  options.disturb.lens_misfit_px = 0.05;
  options.disturb.board_move = BoardMove{{0.005, 0.01}, 0.5, TargetId("front")};
  const Experiment experiment = Prepared(SmallRig(), options);
  Truth truth = TruthOf(experiment);
  truth.sensors.at(SensorId("top")).bound = BoundSigma{0.001, std::nullopt, 0.003, 0.1, 0.2, 0.3};
  const auto read = ReadTruth(WriteTruth(truth), "truth.yaml");
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(WriteTruth(*read), WriteTruth(truth));
  const SensorTruth& top = read->sensors.at(SensorId("top"));
  EXPECT_EQ(top.bound->at(0), 0.001);
  EXPECT_FALSE(top.bound->at(1));
  EXPECT_TRUE(read->sensors.at(SensorId("side")).T_ref_bumped);
  EXPECT_EQ(read->disturbances.at("lens_misfit"), "0.05 px rms, every camera");
  EXPECT_EQ(read->disturbances.at("board_moved").substr(0, 13), "front by 5 mm");
  EXPECT_FALSE(ReadTruth("format: 1\nrig: x\n", "truth.yaml"));
  // By another road: through the world at a capture.
  const Se3 expected =
      experiment.T_world_sensor(SensorId("left"), 0).Inverse() * experiment.T_world_sensor(SensorId("top"), 0);
  EXPECT_LT((expected.Inverse() * top.T_ref_sensor).Log().norm(), 1e-12);
}

}  // namespace
}  // namespace rigcal::sim
