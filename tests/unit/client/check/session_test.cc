// A simulated visit as a folder: looked at, found, judged; then with what goes wrong in the field.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "client/check/advice.h"
#include "client/check/look.h"
#include "client/sim/rig/rig_yaml.h"
#include "client/sim/simulate.h"
#include "server/model/edges/captures_wanted.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::check {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

// Two cameras, a lidar and a tracker; the board moves in the pictures as the robot does.
std::string RigYaml(const std::string& motion, const std::string& board_rpy_deg) {
  return R"(format: 1
name: two
robot: two-01
reference: left
motion: )" +
         motion + R"(
room: {size_m: [6, 5, 3]}
boards:
  front: {inner_corners: [6, 5], square_size_m: 0.1, plate_size_m: [0.8, 0.7], T_world_plate: {p_m: [1.6, 0, 1], rpy_deg: )" +
         board_rpy_deg + R"(}}
camera: {size_px: [480, 360], corner_sigma_px: 0.1, intrinsics_sigma: [0.2, 0.2, 0.2, 0.2, 0.001, 0, 0, 0, 0]}
lidar: {elevations_deg: [-15, -12, -9, -6, -3, 0, 3, 6, 9], firings_per_turn: 300, range_sigma_m: 0.02}
tracker: {sigma_m: 0.0005, sigma_deg: 0.05}
sensors:
  left: {type: camera, sees: front, T_body_sensor: {p_m: [0, 0.06, 0], rpy_deg: [0.3, -0.2, 0.4]}, lens: {fx_px: 420, fy_px: 421, cx_px: 238, cy_px: 182, distortion: [-0.05, 0.01, 0, 0, 0]}}
  right: {type: camera, sees: front, T_body_sensor: {p_m: [0, -0.06, 0], rpy_deg: [-0.2, 0.3, -0.3]}, lens: {fx_px: 418, fy_px: 419, cx_px: 242, cy_px: 178, distortion: [-0.04, 0.01, 0, 0, 0]}}
  top: {type: lidar, T_body_sensor: {p_m: [0, 0, 0.3], rpy_deg: [1, 2, 3]}}
  body: {type: tracker, T_body_sensor: {p_m: [-0.05, 0, 0.4], rpy_deg: [0, 0, 10]}}
skip_pairs: [[top, body], [left, top], [right, top]]
)";
}

constexpr const char* kFree =
    "{captures: 20, start_m: [0, 0, 1], position_range_m: [0.15, 0.15, 0.05], yaw_range_deg: 9, tilt_rms_deg: 4}";
constexpr const char* kStraight =
    "{captures: 20, start_m: [0, 0, 1], position_range_m: [0.15, 0.15, 0.05], yaw_range_deg: 0, tilt_rms_deg: 0}";

class CheckSession : public testing::Test {
 protected:
  void Simulate(const std::string& rig_yaml, const sim::Options& options = {}) const {
    auto rig = sim::ReadRig(rig_yaml, "two.yaml");
    ASSERT_TRUE(rig) << Sentence(rig.error());
    const auto experiment = sim::Prepare(*std::move(rig), options);
    ASSERT_TRUE(experiment) << Sentence(experiment.error());
    const sim::WriteOptions write{sim::PictureFormat::kPng, 0};
    const auto written = sim::WriteSession(*experiment, sim::TruthOf(*experiment), folder_, write, {});
    ASSERT_TRUE(written) << Sentence(written.error());
  }
  [[nodiscard]] Findings Found() const {
    const auto session = Look(folder_, {});
    EXPECT_TRUE(session) << Sentence(session.error());
    return session ? FindAll(*session, {}) : Findings{};
  }
  void Overwrite(const std::string& path, const std::string& bytes) const {
    std::ofstream(folder_ / path, std::ios::binary | std::ios::trunc) << bytes;
  }
  [[nodiscard]] std::string Bytes(const std::string& path) const {
    std::ifstream file(folder_ / path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TempFolder place_;
  fs::path root_ = place_.path(), folder_ = root_ / "visit";
};

const PairFound& PairOf(const Findings& findings, const std::string& a, const std::string& b) {
  return *std::find_if(findings.pairs.begin(), findings.pairs.end(), [&](const PairFound& pair) {
    return pair.pair == SensorPair{SensorId(a), SensorId(b)};
  });
}

std::string TextOf(const Judgement& judgement) {
  std::string text;
  for (const Advice& advice : judgement.advice) text += testing::PrintToString(advice.of) + ": " + advice.text + "\n";
  return text;
}

TEST_F(CheckSession, AGoodVisitIsEnough) {
  Simulate(RigYaml(kFree, "[4, 12, 9]"));
  const Findings findings = Found();
  EXPECT_EQ(findings.captures.size(), 20u);
  EXPECT_TRUE(findings.refusals.empty());
  for (const char* name : {"left", "right"}) {
    const CameraFound& camera = findings.cameras.at(SensorId(name));
    EXPECT_EQ(camera.with_board.size(), 20u) << name;
    EXPECT_EQ(camera.corners, 20u * 30u) << name;
    EXPECT_GT(camera.coverage.share_ratio, 0.1) << name;
    ASSERT_TRUE(camera.distances) << name;
    EXPECT_NEAR(camera.distances->near_widths, 2.1, 0.5) << name;  // 1.6 m less the drawn position over 0.7 m
    ASSERT_TRUE(camera.edge_px) << name;
    EXPECT_NEAR(*camera.edge_px, 2.2, 0.7) << name;
    EXPECT_TRUE(camera.blurred.empty()) << name;
  }
  const PairFound& pair = PairOf(findings, "left", "right");
  ASSERT_TRUE(pair.edge);
  EXPECT_EQ(pair.edge->state, EdgeState::kGood);
  EXPECT_EQ(pair.both, 20u);
  EXPECT_LT(SigmaOf(pair.edge->uncertainty, 0).value, 0.003);
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_TRUE(judgement.IsEnough()) << TextOf(judgement);
}

TEST_F(CheckSession, ThreeCapturesAreNotEnough) {
  sim::Options options;
  options.captures = 3;
  Simulate(RigYaml(kFree, "[4, 12, 9]"), options);
  const Judgement judgement = JudgeFindings(Found());
  EXPECT_EQ(Headline(judgement), "Take at least 17 more captures.") << TextOf(judgement);
  EXPECT_THAT(TextOf(judgement), HasSubstr("the board is in 3 of 3 pictures, 20 are wanted: take 17 more"));
}

// A push of as many warns that too few captures stand behind the pairs to test them: one number, of the server's code.
TEST_F(CheckSession, FewerCapturesThanTheServerTestsPairsByAreNotEnough) {
  for (const int captures : {CapturesToTest(3) - 1, CapturesToTest(3)}) {
    sim::Options options;
    options.captures = captures;
    fs::remove_all(folder_);
    Simulate(RigYaml(kFree, "[4, 12, 9]"), options);
    const Judgement judgement = JudgeFindings(Found());
    EXPECT_EQ(judgement.IsEnough(), captures == CapturesToTest(3)) << TextOf(judgement);
    if (judgement.IsEnough()) continue;
    EXPECT_EQ(captures + static_cast<int>(judgement.captures_more), kCapturesUsual);
  }
}

// Of each row the position times 1000.
std::string InMillimetres(const std::string& table) {
  std::istringstream rows(table);
  std::string row, text;
  std::getline(rows, text);
  while (std::getline(rows, row)) {
    std::istringstream fields(row);
    std::string field;
    text += "\n";
    for (int column = 0; std::getline(fields, field, ','); ++column) {
      const bool is_position = column >= 2 && column <= 4;
      text += (column == 0 ? "" : ",") + (is_position ? std::to_string(1000.0 * std::stod(field)) : field);
    }
  }
  return text + "\n";
}

TEST_F(CheckSession, ATrackerInMillimetresIsAskedAbout) {
  Simulate(RigYaml(kFree, "[4, 12, 9]"));
  EXPECT_TRUE(Found().unit_doubts.empty());
  Overwrite("body/poses.csv", InMillimetres(Bytes("body/poses.csv")));
  const Judgement judgement = JudgeFindings(Found());
  EXPECT_THAT(judgement.remarks,
              Contains(testing::AllOf(testing::StartsWith("body/poses.csv: "), HasSubstr(" m between captures "),
                                      testing::EndsWith(": are these millimetres? Positions are taken "
                                                        "in metres."))));
}

TEST_F(CheckSession, ABoardHeldFrontalAlwaysIsToldToBeTilted) {
  sim::Options options;
  options.intrinsics = sim::IntrinsicsKind::kAbsent;
  Simulate(RigYaml(kStraight, "[0, 0, 0]"), options);
  const Judgement judgement = JudgeFindings(Found());
  EXPECT_FALSE(judgement.IsEnough());
  EXPECT_THAT(TextOf(judgement), HasSubstr("tilt the board 30 degrees left, right, up and down"));
}

TEST_F(CheckSession, FilesThatAreMissingAreNamed) {
  Simulate(RigYaml(kFree, "[4, 12, 9]"));
  for (int i = 7; i <= 20; ++i) fs::remove(folder_ / "right" / ((i < 10 ? "0" : "") + std::to_string(i) + ".png"));
  const Judgement judgement = JudgeFindings(Found());
  EXPECT_THAT(TextOf(judgement), HasSubstr("files for 6 of 20 captures: 07 to 20 are missing; unless it took no part "
                                           "in these, as in another pass, copy these files into right/, or take "
                                           "these captures again"));
  EXPECT_EQ(judgement.captures_more, 0u) << TextOf(judgement);
}

TEST_F(CheckSession, ASensorWithoutAnyFileIsNamed) {
  Simulate(RigYaml(kFree, "[4, 12, 9]"));
  fs::remove_all(folder_ / "right");
  fs::remove_all(folder_ / "body");
  const Findings findings = Found();
  EXPECT_TRUE(findings.refusals.empty());
  const std::string text = TextOf(JudgeFindings(findings));
  EXPECT_THAT(text, HasSubstr("no files: put its pictures into right/"));
  EXPECT_THAT(text, HasSubstr("no poses: put them into body/poses.csv"));
}

// Each is told once, with what to do; the others are still looked at.
TEST_F(CheckSession, BadFilesDoNotKeepTheRestFromBeingLookedAt) {
  Simulate(RigYaml(kFree, "[4, 12, 9]"));
  Overwrite("left/01.png", "");
  Overwrite("left/02.png", Bytes("left/02.png").substr(0, 2000));
  Overwrite("right/03.png", Bytes("left/03.png"));
  Overwrite("top/04.pcd",
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 8000000000\nHEIGHT "
            "1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 8000000000\nDATA binary\n");
  const Findings findings = Found();
  ASSERT_EQ(findings.refusals.size(), 1u);
  EXPECT_THAT(findings.refusals[0].what, HasSubstr("left/01.png\": it is empty"));
  const Judgement judgement = JudgeFindings(findings);
  EXPECT_THAT(judgement.remarks, Contains("left has files for 19 of 20 captures: 01 is missing."));
  EXPECT_THAT(judgement.remarks, Contains(HasSubstr("left/02.png: ")));
  EXPECT_THAT(judgement.remarks, Contains(HasSubstr("top/04.pcd")));
  EXPECT_THAT(judgement.remarks, Contains(HasSubstr("left/03.png and right/03.png are one and the same file")));
  EXPECT_EQ(findings.cameras.at(SensorId("left")).with_board.size(), 18u);
  EXPECT_EQ(PairOf(findings, "left", "right").both, 17u);
}

TEST_F(CheckSession, PicturesOfAnotherSizeAreNamed) {
  Simulate(RigYaml(kFree, "[4, 12, 9]"));
  fs::rename(folder_, root_ / "full");
  sim::Options half;
  half.scale_ratio = 0.5;
  Simulate(RigYaml(kFree, "[4, 12, 9]"), half);
  fs::copy_file(folder_ / "left/05.png", root_ / "full/left/05.png", fs::copy_options::overwrite_existing);
  folder_ = root_ / "full";
  const Judgement judgement = JudgeFindings(Found());
  EXPECT_THAT(judgement.remarks, Contains(HasSubstr("left: the pictures of 05 are not of 480 x 360 pixels")));
  EXPECT_THAT(TextOf(judgement), HasSubstr("differ in size"));
}

TEST_F(CheckSession, WhatIsNoSessionIsOneSentence) {
  const auto none = Look(root_ / "nowhere", {});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().what, HasSubstr("there is no such folder"));
  fs::create_directories(folder_);
  EXPECT_THAT(Look(folder_, {}).error().what, HasSubstr("it has no session.yaml"));
  Overwrite("session.yaml", "format: 1\nrobot: [\n");
  EXPECT_THAT(Look(folder_, {}).error().what, HasSubstr("session.yaml"));
}

TEST_F(CheckSession, ProgressGoesToTheEnd) {
  sim::Options options;
  options.captures = 2;
  Simulate(RigYaml(kFree, "[4, 12, 9]"), options);
  std::int64_t bytes = 0, all_bytes = -1, files = 0, all_files = -1;
  const auto session = Look(folder_, {[&](std::int64_t done, std::int64_t all) { bytes = done, all_bytes = all; },
                                      [&](std::int64_t done, std::int64_t all) { files = done, all_files = all; }});
  ASSERT_TRUE(session);
  EXPECT_EQ(bytes, all_bytes);
  EXPECT_EQ(files, all_files);
  EXPECT_EQ(all_files, 7);  // two of each camera and of the lidar, and a table
}

}  // namespace
}  // namespace rigcal::check
