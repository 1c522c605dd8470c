// What the companion says of a session so far: boards held before a simulated rig, folders that fill, the page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "client/companion/growing_folder.h"
#include "client/companion/placement_words.h"
#include "client/companion/shown.h"
#include "server/model/edges/captures_wanted.h"
#include "tests/bench/companion/held_board.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::companion {
namespace {

namespace fs = std::filesystem;
using calib::placement::NextPlacement;
using calib::placement::PlannedRig;
using testing::HasSubstr;

PlannedRig RigOfTwo() {
  PlannedRig rig;
  rig.cameras.resize(2);
  rig.cameras[0].id = SensorId("front");
  rig.cameras[1].id = SensorId("left_back");
  rig.boards.resize(1);
  return rig;
}

NextPlacement Placement() {
  NextPlacement next;
  next.camera = next.of = 1;
  next.stand = {-0.6981, 0.02, 3.02, 0.5236, 0.0};
  next.axis = 2;
  next.sigma_now = 0.0091, next.sigma_then = 0.0032;
  return next;
}

TEST(PlacementWords, SayWhereAndWhatComesOfIt) {
  EXPECT_EQ(
      PlacementText(RigOfTwo(), Placement()),
      "Hold the board 40 deg left of left_back at 3.0 m, tilted 30 deg to the right: z of left_back falls from 9.1 to "
      "3.2 mm.");
}

TEST(PlacementWords, SayThatTheBoardIsOnItsSide) {
  NextPlacement next = Placement();
  next.stand.turned_rad = -1.55;
  EXPECT_THAT(PlacementText(RigOfTwo(), next), HasSubstr("at 3.0 m, on its side, tilted 30 deg to the right: "));
  next.stand.tilt_right_rad = 0;
  EXPECT_THAT(PlacementText(RigOfTwo(), next), HasSubstr("at 3.0 m, on its side, facing it: "));
}

TEST(PlacementWords, NoSigmaIsZero) {
  NextPlacement next = Placement();
  next.sigma_now = 0.0006, next.sigma_then = 0.00003;
  EXPECT_THAT(PlacementText(RigOfTwo(), next), HasSubstr("z of left_back falls from 0.6 to less than 0.1 mm."));
}

TEST(PlacementWords, SayWhatIsNotKnownYet) {
  NextPlacement next = Placement();
  next.stand = {0.0, 0.3, 1.0, 0.0, 0.0};
  next.sigma_now = 0.39;
  EXPECT_EQ(PlacementText(RigOfTwo(), next),
            "Hold the board 17 deg up of left_back at 1.0 m, facing it: z of left_back becomes known, to 3.2 mm.");
}

TEST(PlacementWords, NameTheBoardOfSeveral) {
  PlannedRig rig = RigOfTwo();
  rig.boards.resize(2);
  rig.boards[0].id = TargetId("large");
  EXPECT_THAT(PlacementText(rig, Placement()), HasSubstr("Hold board large "));
}

TEST(MostAgreedOn, IsNotMovedByOneThatIsFlipped) {
  const auto at = [](double x_m) { return Se3{{x_m, 0, 0}, Eigen::Quaterniond::Identity()}; };
  EXPECT_NEAR(MostAgreedOn({{at(5)}, {at(0.3)}, {at(0.301)}, {at(-4)}}, at(5)).p_m.x(), 0.3, 0.002)
      << "two against a drawing";
}

TEST(MostAgreedOn, OfOneCaptureIsTheNearestToTheDrawing) {
  const auto at = [](double x_m) { return Se3{{x_m, 0, 0}, Eigen::Quaterniond::Identity()}; };
  EXPECT_EQ(MostAgreedOn({{at(5), at(0.3)}}, at(0.25)).p_m.x(), 0.3);
  EXPECT_EQ(MostAgreedOn({{at(5), at(0.3)}}, std::nullopt).p_m.x(), 5) << "without one the likeliest";
}

HeldBoard Held(bool lenses_given = true) {
  auto held = HeldBoard::Prepare(RingYaml(3, 40, 0.0), 3, lenses_given, 40);
  EXPECT_TRUE(held) << held.error().what;
  return *std::move(held);
}

TEST(Standing, OfAFollowedAdviceComesToItsEnd) {
  HeldBoard held = Held();
  Standing standing = StandingOf(held.Captured());
  EXPECT_FALSE(standing.is_enough);
  EXPECT_THAT(standing.headline, HasSubstr("becomes known"));
  bool few_are_told = false;
  while (standing.advice.next && held.Captures() < 30) {
    for (const std::string& remark : standing.remarks)
      few_are_told |= remark.find("of the 8 captures") != std::string::npos;
    const NextPlacement next = *standing.advice.next;
    held.Hold(standing.so_far.rig.cameras[next.camera].id, next.T_camera_board);
    standing = StandingOf(held.Captured());
  }
  EXPECT_TRUE(standing.is_enough) << standing.headline;
  EXPECT_EQ(standing.headline, "Enough, close the session.");
  ASSERT_FALSE(standing.remarks.empty());
  EXPECT_THAT(standing.remarks.front(), HasSubstr("until it was pushed")) << "it is expected, not known";
  EXPECT_TRUE(few_are_told) << "before the server believes a sigma";
  EXPECT_LE(held.Captures(), 20U);
}

// What `rigcal check` and the server want of a loop: one number, of the server's code.
TEST(Standing, IsNotEnoughBeforeThePairsOfALoopCanBeTested) {
  auto held = HeldBoard::Prepare(RingYaml(3, 15, 0.1), 3, true, 40);
  ASSERT_TRUE(held) << held.error().what;
  Standing standing = StandingOf(held->Captured());
  bool is_told = false;
  while (standing.advice.next && held->Captures() < 40) {
    for (const std::string& remark : standing.remarks)
      is_told |= remark.find("Too few captures together to test whether pairs agree, of c") != std::string::npos;
    const NextPlacement next = *standing.advice.next;
    held->Hold(standing.so_far.rig.cameras[next.camera].id, next.T_camera_board);
    standing = StandingOf(held->Captured());
  }
  EXPECT_EQ(standing.headline, "Enough, close the session.");
  EXPECT_TRUE(is_told);
  std::map<std::pair<std::size_t, std::size_t>, int> together;
  for (std::size_t k = 0; k < held->Captures(); ++k)
    for (const std::size_t a : held->SeeingIn(k))
      for (const std::size_t b : held->SeeingIn(k))
        if (a < b) ++together[{a, b}];
  EXPECT_EQ(together.size(), 3U);
  for (const auto& [pair, captures] : together) EXPECT_GE(captures, CapturesToTest(3));
  EXPECT_LE(held->Captures(), static_cast<std::size_t>(CapturesToTest(3)) + 4);
}

TEST(Standing, OfACameraThatNoCarriedBoardTiesIsNotDone) {
  auto held = HeldBoard::Prepare(RingYaml(2, 180, 0.0), 3, true, 40);
  ASSERT_TRUE(held) << held.error().what;
  held->Hold(SensorId("c0"), calib::placement::PoseOf({0, 0, 2.2, 0, 0}, held->Board()));
  const Standing standing = StandingOf(held->Captured());
  EXPECT_FALSE(standing.is_enough);
  EXPECT_EQ(standing.headline,
            "Not done: a carried board cannot tie c1 to c0. Move the robot before a board that stands still, with a "
            "tracker or odometry in the session: `rigcal check` judges that, not this page.");
  EXPECT_FALSE(nlohmann::json::parse(StandingJson(standing))["enough"]);
}

TEST(Standing, DoesNotCloseASessionWithSensorsThatItDoesNotJudge) {
  HeldBoard held = Held();
  Standing standing = StandingOf(held.Captured());
  while (standing.advice.next && held.Captures() < 30) {
    held.Hold(standing.so_far.rig.cameras[standing.advice.next->camera].id, standing.advice.next->T_camera_board);
    standing = StandingOf(held.Captured());
  }
  ASSERT_TRUE(standing.is_enough) << standing.headline;
  Captured captured = held.Captured();
  Sensor lidar;
  lidar.id = SensorId("top");
  lidar.kind = SensorKind::kLidar;
  captured.header.sensors.push_back(lidar);
  standing = StandingOf(captured);
  EXPECT_FALSE(standing.is_enough);
  EXPECT_EQ(standing.headline,
            "The cameras have enough. Not done: top is not judged here: see by `rigcal check` before you close the "
            "session.");
}

TEST(Standing, WithoutAnyCaptureIsNeverEnough) {
  auto held = HeldBoard::Prepare(RingYaml(1, 0, 0.0), 3, true, 4);
  ASSERT_TRUE(held) << held.error().what;
  const Standing standing = StandingOf(held->Captured());
  EXPECT_FALSE(standing.is_enough);
  EXPECT_THAT(standing.headline, HasSubstr("a carried board tells nothing more of it here"));
}

TEST(RigSoFar, PlacesCamerasByTheBoardsThatTwoSaw) {
  HeldBoard held = Held();
  for (int i = 0; i < 6; ++i) {
    const Standing standing = StandingOf(held.Captured());
    ASSERT_TRUE(standing.advice.next);
    held.Hold(standing.so_far.rig.cameras[standing.advice.next->camera].id, standing.advice.next->T_camera_board);
  }
  Captured captured = held.Captured();
  for (Sensor& sensor : captured.header.sensors) sensor.T_ref_nominal.reset();
  const RigSoFar so_far = RigOf(captured);
  ASSERT_TRUE(so_far.unplaced.empty());
  for (const auto& camera : so_far.rig.cameras)
    EXPECT_TRUE(AreNear(camera.T_ref_camera, held.Experiment().T_ref_sensor(camera.id), 0.05, 0.03)) << camera.id.str();
}

// Of a board seen small the likelier of its two poses may be the wrong one: the drawing tells them apart.
TEST(RigSoFar, IsNotMisledByTheOtherPoseOfAFlatBoard) {
  HeldBoard held = Held();
  ASSERT_EQ(held.Hold(SensorId("c0"), calib::placement::PoseOf({-0.35, 0.05, 3.0, 0.5, 0.2, 1.57}, held.Board())), 2U);
  Captured captured = held.Captured();
  CameraSoFar& camera = captured.cameras.at(SensorId("c1"));
  for (auto& [capture, T_cam_board] : camera.found.T_cam_board) {
    calib::placement::Stand mirrored = calib::placement::StandOf(T_cam_board, held.Board());
    mirrored.tilt_right_rad *= -1, mirrored.tilt_up_rad *= -1;
    camera.other_poses[capture] = {T_cam_board};
    T_cam_board = calib::placement::PoseOf(mirrored, held.Board());
  }
  const RigSoFar so_far = RigOf(captured);
  EXPECT_TRUE(AreNear(so_far.rig.cameras.at(1).T_ref_camera, held.Experiment().T_ref_sensor(SensorId("c1")), 0.1, 0.1));
}

// A board that looks the same turned by 180 degrees: which end is up is chance, in each picture anew.
TEST(RigSoFar, TakesABoardThatIsSeenTurnedAsTheSameBoard) {
  std::string yaml = RingYaml(2, 40, 0.0);
  yaml.replace(yaml.find("[9, 6]"), 6, "[10, 6]");
  auto held = HeldBoard::Prepare(yaml, 3, true, 20);
  ASSERT_TRUE(held) << held.error().what;
  for (const double tilt_rad : {-0.5, 0.0, 0.5})
    held->Hold(SensorId("c0"), calib::placement::PoseOf({-0.35, 0.05, 3.2, tilt_rad, 0.2}, held->Board()));
  for (const double tilt_rad : {-0.5, 0.0, 0.5})
    held->Hold(SensorId("c0"), calib::placement::PoseOf({0.35, 0.05, 3.2, tilt_rad, 0.2}, held->Board()));
  Captured captured = held->Captured();
  const Standing as_it_is = StandingOf(captured);
  ASSERT_EQ(as_it_is.advice.poses.at(1).tied_by, 3);
  const Se3 T_board_middle{CentreOf(held->Board()), Eigen::Quaterniond::Identity()};
  const Se3 turn = T_board_middle * Se3{{0, 0, 0}, Eigen::Quaterniond(0, 0, 0, 1)} * T_board_middle.Inverse();
  for (auto& [capture, T_cam_board] : captured.cameras.at(SensorId("c1")).found.T_cam_board)
    T_cam_board = T_cam_board * turn;
  const Standing turned = StandingOf(captured);
  for (int axis = 0; axis < 6; ++axis)
    EXPECT_NEAR(turned.advice.poses.at(1).sigma[axis] / as_it_is.advice.poses.at(1).sigma[axis], 1, 1e-3) << axis;
}

TEST(RigSoFar, NamesWhatNothingPlaces) {
  Captured captured = Held().Captured();
  captured.header.sensors[1].T_ref_nominal.reset();
  const Standing standing = StandingOf(captured);
  EXPECT_EQ(standing.so_far.unplaced, std::vector<SensorId>{SensorId("c1")});
  EXPECT_THAT(standing.headline, HasSubstr("nothing is known of where it sits"));
  EXPECT_FALSE(standing.is_enough);
}

TEST(StandingJson, HasWhatThePageDraws) {
  HeldBoard held = Held();
  held.Hold(SensorId("c0"), calib::placement::PoseOf({0.35, 0, 2.2, 0, 0}, held.Board()));
  const auto told = nlohmann::json::parse(StandingJson(StandingOf(held.Captured())));
  EXPECT_EQ(told["captures"].size(), 1U);
  EXPECT_FALSE(told["enough"]);
  ASSERT_EQ(told["sensors"].size(), 3U);
  EXPECT_EQ(told["sensors"][0]["picture"]["corners_px"].size(), 54U);
  EXPECT_TRUE(told["next"]["turned_rad"].is_number());
  EXPECT_GE(told["next"]["seen_by"].size(), 2U);
  EXPECT_EQ(told["next"]["seen_by"][0]["outline_px"].size(), 32U);
  EXPECT_EQ(told["next"]["from_above"]["cameras"].size(), 3U);
}

TEST(StandingText, HasARowForEachCamera) {
  std::ostringstream out;
  PrintStanding(StandingOf(Held().Captured()), out);
  EXPECT_THAT(out.str(), HasSubstr("next     Hold the board"));
  EXPECT_THAT(out.str(), HasSubstr("\nc2 "));
}

constexpr const char* kSession =
    "format: 1\nrobot: r\nrig_model: m\ncaptured_at: 2026-01-31T12:00:00Z\nreference: left\ntargets:\n"
    "  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025}\n"
    "sensors:\n  left: {type: camera, sees: board}\n  right: {type: camera, sees: board}\n";

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(path_ / "left");
    fs::create_directories(path_ / "right");
  }
  void Write(const std::string& name, const std::string& bytes) {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
  }

 private:
  const TempFolder temporary_;

 protected:
  const fs::path path_ = temporary_.path();
};

TEST_F(Folder, WithoutASessionSaysSo) {
  GrowingFolder folder(path_);
  const auto listed = folder.List();
  ASSERT_FALSE(listed);
  EXPECT_THAT(listed.error().what, HasSubstr("no session.yaml"));
}

TEST_F(Folder, GrowsAndShrinks) {
  Write("session.yaml", kSession);
  GrowingFolder folder(path_);
  ASSERT_TRUE(folder.List().value());
  EXPECT_FALSE(folder.List().value()) << "nothing came";
  Write("left/001.png", "no picture");
  ASSERT_TRUE(folder.List().value());
  ASSERT_EQ(folder.Waiting(), 1U);
  folder.LookAtNext();
  Captured captured = folder.SoFar();
  EXPECT_EQ(captured.files.at(SensorId("left")).size(), 1U);
  EXPECT_FALSE(captured.pictures.at(SensorId("left")).at(CaptureId("001")).why_not.empty());
  fs::remove(path_ / "left/001.png");
  ASSERT_TRUE(folder.List().value());
  captured = folder.SoFar();
  EXPECT_TRUE(captured.files.at(SensorId("left")).empty());
  EXPECT_TRUE(captured.pictures.at(SensorId("left")).empty());
}

TEST_F(Folder, LooksAgainAtAFileThatGrew) {
  Write("session.yaml", kSession);
  Write("left/001.png", "half");
  GrowingFolder folder(path_);
  ASSERT_TRUE(folder.List().value());
  folder.LookAtNext();
  EXPECT_EQ(folder.Waiting(), 0U);
  Write("left/001.png", "half and the rest");
  ASSERT_TRUE(folder.List().value());
  EXPECT_EQ(folder.Waiting(), 1U);
}

// As `cp -p` and `rsync -t` write it.
TEST_F(Folder, LooksAgainAtACopyOfTheSameSizeAndTime) {
  Write("session.yaml", kSession);
  Write("left/001.png", "damaged");
  const auto written = fs::last_write_time(path_ / "left/001.png");
  GrowingFolder folder(path_);
  ASSERT_TRUE(folder.List().value());
  folder.LookAtNext();
  Write("copy", "is good");
  fs::last_write_time(path_ / "copy", written);
  fs::rename(path_ / "copy", path_ / "left/001.png");
  ASSERT_TRUE(folder.List().value());
  EXPECT_EQ(folder.Waiting(), 1U);
}

TEST_F(Folder, BeginsAnewWithAnotherSession) {
  Write("session.yaml", kSession);
  Write("left/001.png", "half");
  GrowingFolder folder(path_);
  ASSERT_TRUE(folder.List().value());
  folder.LookAtNext();
  std::string other = kSession;
  other.replace(other.find("robot: r"), 8, "robot: another");
  Write("session.yaml", other);
  ASSERT_TRUE(folder.List().value());
  EXPECT_EQ(folder.Waiting(), 1U);
  EXPECT_EQ(folder.SoFar().header.robot.str(), "another");
}

TEST_F(Folder, TellsWhichFilesAreMissing) {
  Write("session.yaml", kSession);
  for (const char* name : {"left/001.png", "left/002.png", "right/001.png"}) Write(name, "no picture");
  GrowingFolder folder(path_);
  ASSERT_TRUE(folder.List().value());
  while (folder.Waiting() > 0) folder.LookAtNext();
  const Standing standing = StandingOf(folder.SoFar());
  EXPECT_EQ(MissingOf(standing, SensorId("right")), std::vector<CaptureId>{CaptureId("002")});
  EXPECT_THAT(standing.remarks, testing::Contains(HasSubstr("right has files for 1 of 2 captures")));
}

TEST_F(Folder, ShowsItsPicturesAndNothingElse) {
  Write("session.yaml", kSession);
  Write("left/001.png", "no picture");
  Write("left/secret.txt", "not for the page");
  GrowingFolder folder(path_);
  ASSERT_TRUE(folder.List().value());
  while (folder.Waiting() > 0) folder.LookAtNext();
  Shown shown(path_);
  EXPECT_TRUE(shown.Answer("/api/v1/companion"));
  EXPECT_FALSE(shown.Answer("/pictures/left/001.png")) << "before anything is shown";
  shown.Show(StandingOf(folder.SoFar()));
  EXPECT_EQ(shown.Answer("/pictures/left/001.png")->body, "no picture");
  for (const char* path : {"/pictures/left/secret.txt", "/pictures/session.yaml",
                           "/pictures/../companion_folder/session.yaml", "/pictures/", "/x"})
    EXPECT_FALSE(shown.Answer(path)) << path;
  for (const char* path : {"/", "/companion.js", "/companion.css"})
    EXPECT_FALSE(shown.Answer(path)->body.empty()) << path;
}

}  // namespace
}  // namespace rigcal::companion
