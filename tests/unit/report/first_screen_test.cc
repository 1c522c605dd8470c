// What somebody beside the robot sees before they scroll: one word, one action, three numbers; no page contradicts
// another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/boards/boards_page.h"
#include "server/report/edges/edge_fit.h"
#include "server/report/robot_pages.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RobotSummary Robot(VerdictLevel level) {
  RobotSummary robot;
  robot.robot = RobotId("r");
  robot.revision = 3;
  robot.verdict = {level, "left and right look exchanged.", "Check which sensor the files come from."};
  robot.validity.calibrated_at = Stamp{100 * kDay_ns};
  return robot;
}

std::string RobotPage(const RobotSummary& robot) {
  return RenderRobot({robot, {}, {}, {}}, Stamp{102 * kDay_ns}).value();
}

std::string FleetPageOf(const RobotSummary& robot) {
  FleetCounts fleet;
  fleet.robots = 1;
  return RenderFleet(fleet, {{robot}, 1, 1, 1}, Stamp{102 * kDay_ns}).value();
}

// A warning that became overdue asks for one thing first.
TEST(FirstScreen, WhatIsOverdueIsNoWarning) {
  RobotSummary late = Robot(VerdictLevel::kWarn);
  late.validity.overdue = true;
  EXPECT_THAT(RobotPage(late), AllOf(HasSubstr("capture again.</p><p class=\"word\">Overdue</p>"),
                                     HasSubstr("<p class=\"word then\">Warning</p>"),
                                     HasSubstr("<strong class=\"now\">After that:</strong>")));
  EXPECT_THAT(FleetPageOf(late), HasSubstr("<span class=\"badge warn then\">Warning</span>"));
  late.verdict.level = VerdictLevel::kFail;  // stays what it is
  EXPECT_THAT(RobotPage(late), Not(HasSubstr("<p class=\"word\">Overdue</p>")));
}

TEST(FirstScreen, ARobotsPageHasThreeNumbersBesideTheirLimits) {
  RobotSummary robot = Robot(VerdictLevel::kWarn);
  robot.worst = WorstEdge{SensorId("left"), SensorId("mast"), 4.25};
  robot.sensors = {{SensorId("left"), {}},
                   {SensorId("mast"), {StatusWord::kUnknown, "", ""}},
                   {SensorId("rear"), {StatusWord::kOutOfTolerance, "", ""}},
                   {SensorId("right"), {StatusWord::kDrifted, "", ""}}};
  const std::string page = RobotPage(robot);
  EXPECT_THAT(page, HasSubstr("<h2>Measured</h2><p class=\"value\">2 days ago</p><p class=\"hint\">11 Apr 1970; limit "
                              "90 days: 10 Jul 1970</p>"));
  EXPECT_THAT(page, HasSubstr("<p class=\"value\">2 of 4</p><p class=\"hint\">mast: unknown, and 1 more</p>"));
  EXPECT_THAT(page,
              HasSubstr("<div class=\"card figure fit3\"><h2>Worst edge</h2><p class=\"value\">4.2 \xCF\x83</p>"));
  EXPECT_THAT(page, HasSubstr("left \xE2\x86\x92 mast; red from 3 \xCF\x83 on, no limit of the policy"));
  EXPECT_LT(page.find("aria-label=\"Verdict\""), page.find("aria-label=\"Key figures\""));
  robot.revision = 0;
  EXPECT_THAT(RobotPage(robot), Not(HasSubstr("Key figures")));
}

TEST(FirstScreen, WhatDecidedIsTheFirstFigureAndNothingIsKnownThatTheVerdictDoubts) {
  RobotSummary robot = Robot(VerdictLevel::kFail);
  robot.worst = WorstEdge{SensorId("left"), SensorId("right"), 1.6};
  robot.sensors = {{SensorId("left"), {}}, {SensorId("right"), {}}};
  robot.basis.decided_by = {"Loop open by", "20 mm", "limit 1 mm: left and right"};
  const std::string page = RobotPage(robot);
  EXPECT_THAT(page, HasSubstr("<div class=\"card figure fail\"><h2>Loop open by</h2><p class=\"value\">20 mm</p><p "
                              "class=\"hint\">limit 1 mm: left and right</p>"));
  EXPECT_LT(page.find("<h2>Loop open by"), page.find("<h2>Measured"));
  EXPECT_THAT(page, HasSubstr("<p class=\"value\">0 of 2</p><p class=\"hint\">the verdict vouches for none</p>"));
  EXPECT_THAT(page, Not(HasSubstr("1.6 \xCF\x83")));
  robot.basis.culprits = {SensorId("right")};
  EXPECT_THAT(RobotPage(robot), HasSubstr("<p class=\"value\">1 of 2</p><p class=\"hint\">right: not verified</p>"));
  robot.verdict.level = VerdictLevel::kUnknown;
  robot.verdict.unverified = "left";
  robot.basis = {};
  robot.basis.doubted = {SensorId("left")};
  EXPECT_THAT(RobotPage(robot), HasSubstr("<p class=\"value\">1 of 2</p><p class=\"hint\">left: not verified</p>"));
  robot.basis = {};  // of a revision from before it was kept
  EXPECT_THAT(RobotPage(robot), HasSubstr("<p class=\"value\">2 of 2</p>"));
}

TEST(FirstScreen, AReportCountsAsKnownWhatItsVerdictReliesOn) {
  ReportInput input = SampleReport();
  input.revision.verdict = {VerdictLevel::kUnknown, "Why.", "What.", "front_right and lidar"};
  EXPECT_THAT(PageOf(input), HasSubstr("5 known, 1 unknown"));
  input.revision.basis.doubted = {SensorId("front_right"), SensorId("lidar")};
  EXPECT_THAT(PageOf(input), HasSubstr("3 known, 2 not verified, 1 unknown"));
}

TEST(FirstScreen, OfSeveralReasonsOneIsToldAndTheOthersAreInAFold) {
  RobotSummary robot = Robot(VerdictLevel::kWarn);
  robot.basis.reasons = {{"First.", "Do this."}, {"Second.", "Do that."}, {"News.", ""}};
  const std::string page = RobotPage(robot);
  EXPECT_THAT(page, HasSubstr("<p class=\"why\" dir=\"auto\">First.</p>"));
  EXPECT_THAT(page, HasSubstr("<strong>What to do:</strong> Do this.</p>"));
  EXPECT_THAT(page, HasSubstr("<details class=\"more\"><summary>2 more findings</summary><ul><li dir=\"auto\">Second. "
                              "<strong>What to do:</strong> Do that.</li><li dir=\"auto\">News.</li></ul></details>"));
}

TEST(FirstScreen, BoardsWithoutASerialAreOneLine) {
  ReportInput input = SampleReport();
  input.sessions.resize(1);
  for (const Edge& edge : input.revision.edges)
    if (!edge.session.empty()) input.sessions[0].id = edge.session;
  for (const char* board : {"wall", "floor"}) {
    BoardRemark remark;
    remark.target = TargetId(board), remark.code = "no_serial", remark.what = std::string(board) + " has no serial";
    input.sessions[0].board_remarks.push_back(remark);
  }
  EXPECT_THAT(PageOf(input),
              AllOf(HasSubstr("boards floor and wall have no serial"), Not(HasSubstr("wall has no serial"))));
}

// Red is for what must not drive.
TEST(FirstScreen, AStatusIsNotWorseThanTheRule) {
  RobotSummary robot = Robot(VerdictLevel::kWarn);
  robot.found = {StatusWord::kOutOfTolerance, "The pose of right is known to 12 mm only.", "Capture it again."};
  EXPECT_THAT(FleetPageOf(robot), HasSubstr("<span class=\"badge warn\">out-of-tolerance</span>"));
  robot.verdict.level = VerdictLevel::kUnknown;
  EXPECT_THAT(FleetPageOf(robot), HasSubstr("<span class=\"badge fail\">out-of-tolerance</span>"));
}

TEST(FirstScreen, AReportSaysWhenByWhomAndOfWhichRig) {
  ReportInput input = SampleReport();
  EXPECT_THAT(PageOf(input), HasSubstr("<p class=\"meta\">Solved 2026-01-31 12:00:00 UTC"));
  input.sessions = {{SessionId(Sha256Of("a").str()), Stamp{100 * kDay_ns}, "Eve", "old", {}, 1},
                    {SessionId(Sha256Of("b").str()), Stamp{200 * kDay_ns}, "Ada", "mars", {}, 1}};
  EXPECT_THAT(PageOf(input),
              HasSubstr("<p class=\"meta\">Captured 20 Jul 1970 by <bdi>Ada</bdi>, rig <bdi>mars</bdi>, and 1 visit "
                        "before it; solved 2026-01-31 12:00:00 UTC"));
  input.calibrated_at = Stamp{200 * kDay_ns};
  const std::string page = PageOf(input);
  EXPECT_THAT(
      page,
      HasSubstr("<h2>Measured</h2><p class=\"value\">20 Jul 1970</p><p class=\"hint\">limit 90 days: 18 Oct 1970</p>"));
  EXPECT_LT(page.find("<h2>Measured"), page.find("<h2>Least certain sensor"));
  EXPECT_LT(page.find("<h2>Worst edge"), page.find("<h2>E_global"));
}

SuspectEdge Suspect(const Edge& edge, std::vector<EdgeId> alternatives) {
  SuspectEdge suspect;
  suspect.edge = edge.id;
  suspect.alternatives = std::move(alternatives);
  return suspect;
}

// Of a loop that does not close any of its edges may be wrong; no edge is good and something else as well.
TEST(FirstScreen, NobodyIsBlamedWhereSeveralMayBeWrong) {
  ReportInput input = SampleReport();
  const auto& edges = input.revision.edges;
  input.revision.solution.suspects.edges = {Suspect(edges[0], {edges[1].id})};
  const Contradictions several = ContradictionsOf(input.revision.solution.suspects);
  EXPECT_TRUE(several.suspects.empty());
  EXPECT_EQ(several.alternatives, (std::set<EdgeId>{edges[0].id, edges[1].id}));
  const std::string doubtful = PageOf(input);
  EXPECT_THAT(doubtful, AllOf(HasSubstr("<td class=\"text\"><span class=\"badge warn\">doubtful</span></td>"),
                              HasSubstr("may be wrong"), Not(HasSubstr("contradicts the rest"))));
  input.revision.solution.suspects.edges = {Suspect(edges[0], {})};
  EXPECT_THAT(PageOf(input), AllOf(HasSubstr("<td class=\"text\"><span class=\"badge fail\">contradicts</span></td>"),
                                   HasSubstr("contradicts the rest")));
}

SessionInput GoodSession() {
  SessionInput input;
  input.robot = RobotId("r");
  input.row = {SessionId(Sha256Of("session").str()), Stamp{kDay_ns}, "", true, 4, 4, 1, 0, 1, 0};
  input.edges = {SampleEdge("left", "right", Se3())};
  return input;
}

// Pairs that are all good may be what the robot fails by.
TEST(FirstScreen, ASessionSaysWhatItsRobotMayDo) {
  SessionInput input = GoodSession();
  EXPECT_THAT(RenderSession(input).value(), HasSubstr("card moved still"));
  input.robot_now = Robot(VerdictLevel::kPass);
  EXPECT_THAT(RenderSession(input).value(),
              AllOf(HasSubstr("card moved still"), HasSubstr("badge pass\">good<"), Not(HasSubstr("look exchanged"))));
  input.robot_now = Robot(VerdictLevel::kFail);
  EXPECT_THAT(
      RenderSession(input).value(),
      AllOf(HasSubstr("now: <span class=\"badge fail\">Do not drive.</span> left and right look exchanged. <a "
                      "href=\"../../revisions/3/\">"),
            HasSubstr("card moved under-way"), HasSubstr("badge unknown\">good<"), Not(HasSubstr("card moved still"))));
}

TEST(FirstScreen, APairWithARemarkIsNotPlainlyGood) {
  SessionInput input = GoodSession();
  input.edges[0].diagnoses = {
      {"intrinsics_off", "k1 is 8.69 sigmas from where it was given.", "Calibrate this camera anew."}};
  EXPECT_THAT(RenderSession(input).value(), AllOf(HasSubstr("<span class=\"badge warn\">good, but</span>"),
                                                  HasSubstr("Calibrate this camera anew."), Not(HasSubstr(">good<"))));
}

TEST(FirstScreen, ABoardsSigmaIsNamedOnce) {
  formats::BoardRow row;
  row.measure.length_x_m = row.measure.length_y_m = 0.1;
  row.measure.sigma_is_assumed = true;
  const std::string page = RenderBoards({{row}, {}, ""}).value();
  EXPECT_THAT(page, AllOf(HasSubstr("<span class=\"soft\">, assumed</span>"), Not(HasSubstr("sigma assumed"))));
}

std::shared_ptr<const formats::RevisionInput> MeasuredOnce(const char* session, double x_m) {
  formats::RevisionInput revision;
  revision.reference = SensorId("a");
  AddPose(revision, "a", true, Se3(), 0);
  AddPose(revision, "b", true, SamplePose(1.0, 0, 0, 0), 0.01);  // a mean, that hardly moves
  revision.edges = {SampleEdge("a", "b", SamplePose(x_m, 0, 0, 0))};
  revision.edges[0].id = EdgeId(Sha256Of(session).str());
  revision.edges[0].session = SessionId(Sha256Of(session).str());
  return std::make_shared<const formats::RevisionInput>(std::move(revision));
}

TEST(FirstScreen, AComparisonDoesNotSayThatNothingMovedWhereTheMeasurementsDid) {
  const auto page = [](double x_m) {
    return RenderCompare({RobotId("r"), {1, MeasuredOnce("may", 1.0)}, {2, MeasuredOnce("june", x_m)}, 2}).value();
  };
  EXPECT_THAT(page(1.0), HasSubstr("Nothing moved"));
  EXPECT_THAT(page(1.006),
              AllOf(Not(HasSubstr("Nothing moved")), HasSubstr("<p class=\"what\" dir=\"auto\">Measured anew, a"),
                    HasSubstr("a mean of old and new measurements"), HasSubstr("card moved off")));
}

TEST(FirstScreen, AComparisonOfTheSameMeasurementsIsNoProofThatNothingMoved) {
  const auto once = MeasuredOnce("may", 1.0);
  EXPECT_THAT(
      RenderCompare({RobotId("r"), {1, once}, {2, once}, 2}).value(),
      AllOf(Not(HasSubstr("Nothing moved")), Not(HasSubstr("moved still")),
            HasSubstr("<p class=\"what\" dir=\"auto\">No pair was measured anew: what moved meanwhile is not known.")));
}

Visit VisitAt(int day, double x_m) {
  Visit visit{SessionId(Sha256Of(std::to_string(day)).str()), Stamp{day * kDay_ns}, SensorId("a"), {}};
  SensorPose pose{SensorId("b"), true, SamplePose(x_m, 0, 0, 0), Matrix6d::Identity() * 1e-6};
  visit.poses = {pose};
  return visit;
}

TEST(Trend, VisitsStepByBothTheirSigmasAndNotWhereASensorWasRemounted) {
  const std::vector<SolvedRevision> revisions = {{1, MeasuredOnce("may", 1.0), Stamp{5 * kDay_ns}},
                                                 {2, MeasuredOnce("june", 1.0), Stamp{9 * kDay_ns}}};
  EXPECT_THAT(TrendData(revisions, {VisitAt(5, 1.0)}), Not(HasSubstr("visits")));
  const std::vector<Visit> visits = {VisitAt(5, 1.0), VisitAt(9, 1.01)};
  const std::string data = TrendData(revisions, visits);
  EXPECT_THAT(data, HasSubstr("\"visits\":[{\"d\":[0.0,0.0,0.0,0.0,0.0,0.0],\"date\":\"1970-01-06\""));
  EXPECT_THAT(data, HasSubstr("\"in_sigmas\":7.07"));  // 10 mm over 1 mm twice
  Epoch epoch;
  epoch.sensor = SensorId("b");
  epoch.begins_at = Stamp{9 * kDay_ns};
  const std::string remounted = TrendData(revisions, visits, {epoch});
  EXPECT_THAT(remounted, AllOf(HasSubstr("\"remounted\":true"), Not(HasSubstr("\"in_sigmas\""))));
  epoch.begins_at = Stamp{5 * kDay_ns};  // before the first of them
  EXPECT_THAT(TrendData(revisions, visits, {epoch}), Not(HasSubstr("remounted")));
}

}  // namespace
}  // namespace rigcal::report
