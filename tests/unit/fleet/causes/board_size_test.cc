// The size of a board as a tracker's metres tell it, alone and beside lidars.
#include <gmock/gmock.h>

#include "server/fleet/assess.h"
#include "server/fleet/boards/scale_taken.h"
#include "tests/unit/calib/virtual_motion.h"
#include "tests/unit/fleet/causes/visit.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

constexpr double kSaid_m = 0.085;

using Figures = std::map<std::string, double>;

Figures Larger(double ratio, double sigma_ratio = 0.001) {
  return {{"board_scale_ratio", ratio}, {"board_scale_sigma_ratio", sigma_ratio}, {"board_square_m", kSaid_m}};
}

// Cameras before board "calib", a tracked body and a lidar.
Visit VisitBefore(std::initializer_list<const char*> cameras) {
  Target board = StereoBoard();
  board.square_m = kSaid_m;
  Visit visit(board);
  visit.AddSensor("body", SensorKind::kTracker);
  visit.AddSensor("top", SensorKind::kLidar);
  for (const char* camera : cameras) visit.AddSensor(camera, SensorKind::kCamera);
  return visit;
}

void AddSuspected(Visit& visit, const char* camera, const char* other, double ratio) {
  const bool by_lidar = std::string(other) == "top";
  visit.AddFailed(camera, other, by_lidar ? "lidar_camera" : "tracker_camera", "board_size_suspected", Larger(ratio));
}

TEST(BoardSizeByTracker, PairsThatAgreeAreOneLineWithTheSizeToWrite) {
  Visit visit = VisitBefore({"front", "left", "rear"});
  AddSuspected(visit, "front", "body", 0.0588);
  visit.AddFailed("body", "left", "tracker_camera", "board_size_suspected", Larger(0.0589));  // either way round
  visit.AddFailed("rear", "body", "tracker_camera", "high_residual");
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_THAT(cause.boards, ElementsAre(TargetId("calib")));
  EXPECT_EQ(cause.said.why,
            "the squares of board calib are probably 90.00 mm, not 85.00 mm (2 pairs see it 5.9 % larger)");
  EXPECT_EQ(
      FindingOf(cause).what_to_do,
      "Measure one with a caliper and correct session.yaml, probably to `square_size_m: 0.0900`, or the tracker's "
      "scale, if the size is as given, then `rigcal push FOLDER`");
}

// Off by 0.8 % of each distance, at nine sigmas: no pair fails for it, and poses are off by more than is told of them.
TEST(BoardSizeByTracker, OneThatIsOffByLittleAndSurelyIsAWarning) {
  const auto visit_with = [](double ratio, double sigma_ratio) {
    Visit visit = VisitBefore({"front", "left"});
    for (const char* camera : {"front", "left"}) {
      visit.AddGood("body", camera);
      visit.edges.back().method = "tracker_camera";
      visit.edges.back().figures = Larger(ratio, sigma_ratio);
    }
    return visit;
  };
  const RootCause cause = OneCause(visit_with(0.008, 0.0009), CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(0));
  EXPECT_THAT(cause.doubted, SizeIs(0));
  EXPECT_EQ(cause.said.why,
            "the squares of board calib are probably 85.68 mm, not 85.00 mm (2 pairs see it 0.8 % larger)");
  EXPECT_THAT(cause.said.what_to_do, HasSubstr("or the tracker's scale"));
  EXPECT_THAT(visit_with(0.0018, 0.0001).Causes(), SizeIs(0)) << "nobody prints better";
  EXPECT_THAT(visit_with(0.008, 0.0018).Causes(), SizeIs(0)) << "two pairs of one tracker know it no better than one";
}

// What moves between captures is measured in board sizes.
TEST(BoardSizeByTracker, AWrongOneAccusesNoSensorOfHavingMoved) {
  Visit visit = VisitBefore({"front", "left"});
  SessionEstimate estimate;
  estimate.session = visit.session;
  Vector6d step = Vector6d::Zero();
  step[0] = 0.008;
  estimate.moved = {{SensorId("body"), CaptureId("15"), CaptureId("16"), step}};
  visit.AddGood("body", "left");
  const GraphSolution solution = SolutionOf({"left", "body"}, {});
  const auto assess = [&] { return Assess(visit.edges, solution, {}, visit.Times(), {estimate}, visit.Headers()); };
  EXPECT_THAT(assess().why, HasSubstr("ody was moved"));
  AddSuspected(visit, "front", "body", 0.0588);
  EXPECT_EQ(assess().level, VerdictLevel::kFail);
  EXPECT_THAT(assess().why, StartsWith("The squares of board calib are probably 90.00 mm, not 85.00 mm"));
  EXPECT_THAT(assess().why, Not(HasSubstr("body was moved")));
  EXPECT_THAT(assess().what_to_do, Not(HasSubstr("mount")));
}

// Cameras have no metre of their own.
TEST(ScaleTakenAsExact, IsSaidWhereCamerasAreAlone) {
  Visit visit = VisitBefore({"front", "left"});
  visit.AddGood("front", "left");
  visit.edges.back().method = "stereo";
  EXPECT_THAT(ScaleTakenAsExact(visit.edges, visit.Headers()),
              StartsWith("distances are as right as the stated size of board calib (85 mm)"));
  EXPECT_THAT(visit.Judge(SolutionOf({"front", "left"}, {})).why, HasSubstr("Distances are as right as"));
  Visit known = visit;
  known.header.targets.front().serial = "B-7";
  EXPECT_EQ(ScaleTakenAsExact(known.edges, known.Headers()), "");
  known = visit;
  known.header.targets.front().square_sigma_m = 1e-4;
  EXPECT_EQ(ScaleTakenAsExact(known.edges, known.Headers()), "");
  visit.AddGood("front", "top");
  EXPECT_EQ(ScaleTakenAsExact(visit.edges, visit.Headers()), "") << "a lidar has one";
}

TEST(BoardSizeByTracker, OfTheEstimatorsOwnPair) {
  calib::VirtualView view;
  view.board = StereoBoard();
  view.board.square_m = 0.09;
  calib::HandEyeProblem problem =
      calib::TrackerAndCamera(calib::Looking(view, 25, 0.25, 0.12, 3), view, {0.0005, 0.0009}, 0, 3);
  problem.b.board->square_m = kSaid_m;
  Visit visit = VisitBefore({"camera"});
  visit.Add(calib::EstimateHandEyeEdge(problem));
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.said.why, testing::MatchesRegex("the squares of board calib are probably (89|90)\\.[0-9]+ mm, not "
                                                    "85\\.00 mm \\(1 pair sees it [56]\\.?[0-9]* % larger\\)"));
}

TEST(BoardSizeByTracker, LidarsAndTrackersThatAgreeAreOneLine) {
  Visit visit = VisitBefore({"front", "left"});
  AddSuspected(visit, "front", "body", 0.0588);
  AddSuspected(visit, "left", "top", 0.0587);
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(2));
  EXPECT_THAT(cause.said.why, HasSubstr("(2 pairs see it 5.9 % larger)"));
}

TEST(BoardSizeByTracker, LidarsAndTrackersThatDoNotAgreeAreBothTold) {
  Visit visit = VisitBefore({"front", "left"});
  AddSuspected(visit, "front", "body", 0.0588);
  AddSuspected(visit, "left", "body", 0.059);
  AddSuspected(visit, "left", "top", -0.03);
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_EQ(cause.said.why,
            "the squares of board calib are 82.45 mm (1 pair) by lidars and 90.01 mm (2 pairs) by trackers, which do "
            "not agree; they are given as 85.00 mm");
  EXPECT_EQ(cause.said.what_to_do,
            "Measure one with a caliper and correct session.yaml, or the scale of what differs from it");
}

// Cameras have no other measure than the board: their pairs fit, and are as wrong as it is.
TEST(BoardSizeByTracker, PosesThatRestOnTheBoardAreNotToBeReliedOn) {
  Visit visit = VisitBefore({"front", "left"});
  AddSuspected(visit, "front", "top", 0.0588);
  visit.AddGood("front", "left");
  visit.edges.back().method = "stereo";
  Verdict verdict = visit.Judge(SolutionOf({"front", "left"}, {"top"}));
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.unverified, "left and top");
  EXPECT_THAT(verdict.why, HasSubstr("(1 pair sees it 5.9 % larger); so the pose of top is not known, and distances "
                                     "between cameras are 5.6 % too short."));
  visit.AddGood("left", "top");  // known in another way
  visit.edges.back().method = "lidar_camera";
  verdict = visit.Judge(SolutionOf({"front", "left", "top"}, {}));
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.unverified, "left and top");
  EXPECT_THAT(verdict.why, HasSubstr("larger); so distances between cameras are 5.6 % too short."));
}

// Of a pair that is good a tracker says that the size is right.
TEST(BoardSizeByTracker, AGoodPairSpeaksAgainstALidar) {
  Visit visit = VisitBefore({"front", "left"});
  AddSuspected(visit, "left", "top", 0.03);
  visit.AddGood("body", "front");
  visit.edges.back().method = "tracker_camera";
  visit.edges.back().figures = Larger(0.0001);
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(1));
  EXPECT_THAT(cause.said.why, HasSubstr("87.55 mm (1 pair) by lidars and 85.01 mm (1 pair) by trackers"));
}

TEST(BoardSizeByTracker, TrackersThatDisagreeAccuseNoBoard) {
  Visit visit = VisitBefore({"front", "left"});
  AddSuspected(visit, "front", "body", 0.06);
  AddSuspected(visit, "left", "body", -0.04);
  EXPECT_THAT(visit.Causes(), SizeIs(0));
}

// Three cameras before a board each, of which the last is given by another size.
Visit VisitOfThreeBoards() {
  Visit visit = VisitBefore({"front", "left", "rear"});
  Target second = StereoBoard(), third = StereoBoard();
  visit.header.targets.front().id = TargetId("a");
  second.id = TargetId("b"), second.square_m = kSaid_m;
  third.id = TargetId("c"), third.square_m = 0.06;
  visit.header.targets.push_back(second);
  visit.header.targets.push_back(third);
  for (Sensor& sensor : visit.header.sensors)
    for (const auto& [camera, board] : {std::pair("front", "a"), {"left", "b"}, {"rear", "c"}})
      if (sensor.id == SensorId(camera)) sensor.sees = TargetId(board);
  return visit;
}

void AddSuspectedOf(Visit& visit, const char* camera, double ratio, double square_m) {
  std::map<std::string, double> figures = Larger(ratio);
  figures["board_square_m"] = square_m;
  visit.AddFailed(camera, "top", "lidar_camera", "board_size_suspected", figures);
}

TEST(BoardsOfOnePrint, AreOneLineWithOneThingToDo) {
  Visit visit = VisitOfThreeBoards();
  AddSuspectedOf(visit, "front", -0.0301, kSaid_m);
  AddSuspectedOf(visit, "left", -0.0299, kSaid_m);
  AddSuspectedOf(visit, "rear", -0.03, 0.06);
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_THAT(cause.boards, ElementsAre(TargetId("a"), TargetId("b"), TargetId("c")));
  EXPECT_EQ(cause.said.why,
            "the squares of board a, board b and board c are probably 82.45 mm instead of 85.00 mm and 58.20 mm "
            "instead of 60.00 mm (3 pairs see them 3 % smaller)");
  EXPECT_EQ(FindingOf(cause).what_to_do,
            "Measure one of each with a caliper and correct session.yaml, probably to `square_size_m: 0.0825` and "
            "`square_size_m: 0.0582`, then `rigcal push FOLDER`");
  EXPECT_EQ(visit.Judge(SolutionOf({"top"}, {"front", "left", "rear"})).what_to_do.find("; then"), std::string::npos);
}

TEST(BoardsOfOnePrint, OfOneSizeTellItOnce) {
  Visit visit = VisitOfThreeBoards();
  AddSuspectedOf(visit, "front", 0.0588, kSaid_m);
  AddSuspectedOf(visit, "left", 0.059, kSaid_m);
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_EQ(cause.said.why,
            "the squares of board a and board b are probably 90.01 mm, not 85.00 mm (2 pairs see them 5.9 % larger)");
}

TEST(BoardsOfOnePrint, BoardsThatAreWrongByUnlikeRatiosAreNotOfOne) {
  Visit visit = VisitOfThreeBoards();
  AddSuspectedOf(visit, "front", 0.03, kSaid_m);
  AddSuspectedOf(visit, "left", 0.06, kSaid_m);
  AddSuspectedOf(visit, "rear", -0.03, 0.06);
  EXPECT_THAT(visit.Causes(), SizeIs(3));
}

}  // namespace
}  // namespace rigcal::fleet
