#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/pages/experiments_page.h"
#include "server/report/robot_pages.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RobotSummary SummaryOf(const std::string& robot, VerdictLevel level, int revision) {
  return {RobotId(robot),
          revision,
          {level, "because of " + robot, ""},
          {Stamp{100 * kDay_ns}, false, std::nullopt, false},
          2,
          5};
}

// The page of a fleet that has no other robots.
std::string PageWith(const std::vector<RobotSummary>& robots, Stamp now, const FleetQuery& query = {},
                     std::size_t experiments = 0) {
  FleetCounts fleet;
  for (const RobotSummary& robot : robots) {
    ++fleet.robots;
    ++fleet.verdicts[robot.verdict.level];
    ++fleet.kinds[DriveRuleOf(robot.verdict, robot.validity, robot.runs).kind];
    fleet.overdue += robot.validity.overdue ? 1 : 0;
  }
  return RenderFleet(fleet, {robots, robots.size(), 1, 1}, now, query, experiments).value();
}

TEST(ReportFleet, EmptyFleetTellsHowToPush) {
  const std::string page = PageWith({}, Stamp{0});
  EXPECT_THAT(page, HasSubstr("rigcal push"));
  EXPECT_THAT(page, Not(HasSubstr("<table")));
}

TEST(ReportFleet, RowsWithAgeAndLinks) {
  RobotSummary late = SummaryOf("late", VerdictLevel::kPass, 4);
  late.validity.overdue = true;
  const std::string page =
      PageWith({SummaryOf("bad", VerdictLevel::kFail, 2), late, SummaryOf("good", VerdictLevel::kPass, 1)},
               Stamp{103 * kDay_ns});
  EXPECT_LT(page.find("because of bad"), page.find("because of late"));
  EXPECT_LT(page.find("because of late"), page.find("because of good"));
  EXPECT_THAT(page, HasSubstr("href=\"robots/late/revisions/4/\""));
  EXPECT_THAT(page, HasSubstr("href=\"robots/bad/\""));
  EXPECT_THAT(page, HasSubstr(AgeText(3 * kDay_ns) + " ago"));
  EXPECT_THAT(page, HasSubstr("<strong class=\"drive\" dir=\"auto\">Do not drive.</strong>"));
  EXPECT_THAT(page, HasSubstr("<strong class=\"drive\">Not verified: do not rely on it, overdue since 10 Jul 1970; "
                              "capture again.</strong>"));
  EXPECT_THAT(page, HasSubstr("<strong class=\"drive until\" dir=\"auto\">OK to drive until 10 Jul 1970.</strong>"));
  EXPECT_THAT(page, Not(HasSubstr("badge fail\">overdue"))) << "amber";
  EXPECT_THAT(page,
              HasSubstr("3 robots &middot; <a href=\"?verdict=do_not_drive\">1 do not drive</a> &middot; <a "
                        "href=\"?verdict=not_verified\">1 not verified</a> &middot; <a href=\"?verdict=ok\">1 OK to "
                        "drive</a> &middot; <a href=\"?verdict=overdue\">1 of these overdue</a>"));
}

// A pass that nobody approved is counted as its row says.
TEST(ReportFleet, ACandidateIsToBeApproved) {
  RobotSummary candidate = SummaryOf("new", VerdictLevel::kPass, 2);
  candidate.state = RevisionState::kCandidate;
  candidate.validity.approved = false;
  candidate.verdict.what_to_do = "Nothing; calibrate again when it is due.";
  const std::string page = PageWith({candidate}, Stamp{103 * kDay_ns});
  EXPECT_THAT(page, HasSubstr("<a href=\"?verdict=to_approve\">1 to be approved</a>"));
  EXPECT_THAT(page, HasSubstr("rigcal approve new 2 --reason TEXT"));
  EXPECT_THAT(page, Not(HasSubstr("Nothing; calibrate")));
}

TEST(ReportFleet, SaysWhatToDoAndWhatIsUnderWay) {
  RobotSummary bad = SummaryOf("bad", VerdictLevel::kFail, 2), good = SummaryOf("good", VerdictLevel::kPass, 2);
  bad.verdict.what_to_do = "Repeat the session.";
  good.verdict.what_to_do = "Go on as before.";
  bad.jobs_waiting = 3;
  const std::string page = PageWith({bad, good}, Stamp{103 * kDay_ns});
  EXPECT_THAT(page, HasSubstr("Repeat the session."));
  EXPECT_THAT(page, HasSubstr("3 pairs being calibrated"));
  EXPECT_THAT(page, Not(HasSubstr("Go on as before.")));
}

TEST(ReportFleet, RobotWithoutRevisionHasNoAge) {
  const std::string page = PageWith({SummaryOf("new", VerdictLevel::kUnknown, 0)}, Stamp{0});
  EXPECT_THAT(page, HasSubstr("never"));
  EXPECT_THAT(page, Not(HasSubstr("revisions/")));
}

// There is no date that it could be late by.
TEST(ReportFleet, WhatIsNotCalibratedIsNotCalledOverdue) {
  RobotSummary failed = SummaryOf("odd", VerdictLevel::kFail, 2);
  failed.validity.calibrated_at.reset();
  failed.validity.overdue = true;
  FleetCounts fleet;
  fleet.robots = fleet.not_calibrated = 1;
  const std::string page = RenderFleet(fleet, {{failed}, 1, 1, 1}, Stamp{103 * kDay_ns}, {}).value();
  EXPECT_THAT(page, HasSubstr("<span class=\"badge warn\">not calibrated</span>"));
  EXPECT_THAT(page, Not(HasSubstr("badge warn\">overdue")));
  EXPECT_THAT(page, HasSubstr("<a href=\"?verdict=not_calibrated\">1 of these not calibrated</a>"));
  EXPECT_THAT(page, HasSubstr("<a href=\"?verdict=not_calibrated\">not calibrated</a>: 1 robot"));
}

TEST(ReportFleet, ClockThatWentBackIsNamed) {
  EXPECT_THAT(PageWith({SummaryOf("a", VerdictLevel::kPass, 1)}, Stamp{0}), HasSubstr("check the clock"));
}

TEST(ReportFleet, LastSessionAndWorstEdgeAreShown) {
  RobotSummary quiet = SummaryOf("quiet", VerdictLevel::kPass, 1), off = SummaryOf("off", VerdictLevel::kPass, 1),
               fine = SummaryOf("fine", VerdictLevel::kPass, 1);
  quiet.last_session_at = Stamp{10 * kDay_ns};
  off.last_session_at = Stamp{99 * kDay_ns};
  off.worst = WorstEdge{SensorId("left"), SensorId("mast"), 4.25};
  fine.last_session_at = Stamp{98 * kDay_ns};
  fine.worst = WorstEdge{SensorId("left"), SensorId("right"), 0.5};
  const std::string page = PageWith({quiet, off, fine}, Stamp{100 * kDay_ns});
  EXPECT_THAT(page, HasSubstr("<span class=\"badge fit3\">4.2 &sigma;</span> <span class=\"pair\">left &rarr; mast"));
  EXPECT_THAT(page, HasSubstr("<span class=\"badge fit0\">0.5 &sigma;</span>"));
  EXPECT_THAT(page, HasSubstr("90 days ago"));
}

TEST(ReportFleet, WhatStandsBetweenBackticksIsCodeAndEscaped) {
  RobotSummary row = SummaryOf("a", VerdictLevel::kWarn, 1);
  row.verdict.what_to_do = "Type `<b>--remounted a&b` or `` or ` alone.";
  EXPECT_THAT(PageWith({row}, Stamp{0}), HasSubstr("Type <code class=\"typed\">&lt;b&gt;--remounted a&amp;b</code> or "
                                                   "<code class=\"typed\"></code> or ` alone."));
}

// A stop of its own line on a phone, and copied along with the command.
TEST(ReportFleet, NoStopStandsBehindACommandThatEndsASentence) {
  RobotSummary row = SummaryOf("a", VerdictLevel::kWarn, 1);
  row.verdict.what_to_do = "Was it moved? Yes: `rigcal push A`. No: measure again, then `rigcal push B`.";
  EXPECT_THAT(PageWith({row}, Stamp{0}),
              HasSubstr("Yes: <code class=\"typed\">rigcal push A</code>. No: measure again, "
                        "then <code class=\"typed\">rigcal push B</code><"));
}

TEST(ReportFleet, ExperimentsAreLinkedWhereThereAreAny) {
  const std::vector<RobotSummary> rows = {SummaryOf("a", VerdictLevel::kPass, 1)};
  EXPECT_THAT(PageWith(rows, Stamp{0}), Not(HasSubstr("experiments/")));
  EXPECT_THAT(PageWith(rows, Stamp{0}, {}, 2), HasSubstr("<a href=\"experiments/\">2 experiments</a>"));
}

TEST(ReportFleet, APageOfManySaysWhichAndLeadsToTheOthers) {
  FleetCounts fleet;
  fleet.robots = 1000;
  const FleetQuery query{"ab", "fail", "edges", true, 2};
  const FleetPage list{{SummaryOf("a", VerdictLevel::kFail, 1)}, 250, 3, 2};
  const std::string page = RenderFleet(fleet, list, Stamp{0}, query).value();
  EXPECT_THAT(page, HasSubstr("250 of 1000 robots"));
  EXPECT_THAT(page, HasSubstr("page 2 of 3"));
  const std::string same = "?q=ab&amp;verdict=fail&amp;sort=edges&amp;order=down";
  EXPECT_THAT(page, HasSubstr(same + "&amp;page=1\">Previous"));
  EXPECT_THAT(page, HasSubstr(same + "&amp;page=3\">Next"));
  const std::string none = RenderFleet(fleet, {}, Stamp{0}, query).value();
  EXPECT_THAT(none, HasSubstr("0 of 1000 robots"));
  EXPECT_THAT(none, HasSubstr("No robot is like that."));
}

TEST(ReportFleet, ALongListOfExperimentsSaysThatItIsCut) {
  std::vector<ExperimentRow> rows;
  for (int idx = 0; idx < 1000; ++idx) rows.push_back({"run" + std::to_string(idx), Stamp{1}, false});
  EXPECT_THAT(RenderExperiments(rows).value(), Not(HasSubstr("are listed")));
  rows.push_back({"zz_last", Stamp{1}, false});
  const std::string page = RenderExperiments(rows).value();
  EXPECT_THAT(page, HasSubstr("1000 of 1001 experiments are listed"));
  EXPECT_THAT(page, Not(HasSubstr("zz_last")));
}

SessionInput SessionWithPoses(bool with_pictures) {
  SessionInput input;
  input.robot = RobotId("r");
  Sensor camera, tracked;
  camera.id = SensorId("eye");
  tracked.id = SensorId("body");
  tracked.kind = SensorKind::kTracker;
  input.manifest.header.sensors = {tracked};
  input.manifest.payloads = {{"body/poses.csv", tracked.id, CaptureId("poses"), Digest(), 1}};
  if (!with_pictures) return input;
  input.manifest.header.sensors.push_back(camera);
  input.manifest.payloads.push_back({"eye/07.png", camera.id, CaptureId("07"), Digest(), 1});
  return input;
}

// A file of poses is of the whole session: a row of its own would say "no file" of every camera.
TEST(ReportSession, PosesAreNoCapture) {
  const std::string page = RenderSession(SessionWithPoses(true)).value();
  EXPECT_THAT(page, HasSubstr("<bdi>07</bdi>"));
  EXPECT_THAT(page, Not(HasSubstr("no file")));
  EXPECT_THAT(page, Not(HasSubstr("<bdi>poses</bdi>")));
  EXPECT_THAT(page, HasSubstr("The poses of <bdi>body</bdi> come as one file per sensor, of the whole session."));
  EXPECT_THAT(RenderSession(SessionWithPoses(false)).value(), Not(HasSubstr("class=\"sheet\"")));
}

Edge SessionEdge(const std::string& a, const std::string& b, EdgeState state) {
  Edge edge = SampleEdge(a, b, Se3());
  edge.state = state;
  return edge;
}

// One good pair that used capture 01 and not 02, one failed pair, a picture that nobody could read.
SessionInput SessionOfThree() {
  SessionInput input;
  input.robot = RobotId("r");
  input.row = {SessionId(Sha256Of("session").str()), Stamp{kDay_ns}, "", true, 4, 4, 2, 0, 1, 1};
  for (const char* name : {"left", "right", "rear"}) {
    Sensor camera;
    camera.id = SensorId(name);
    input.manifest.header.sensors.push_back(camera);
    for (const char* capture : {"01", "02"})
      input.manifest.payloads.push_back(
          {std::string(name) + "/" + capture + ".png", camera.id, CaptureId(capture), Digest(), 1});
  }
  Edge good = SessionEdge("left", "right", EdgeState::kGood), bad = SessionEdge("left", "rear", EdgeState::kFailed);
  good.captures = {{CaptureId("01"), 0.2, true, ""}, {CaptureId("02"), 0.0, false, "left: no board"}};
  bad.captures = {{CaptureId("01"), 0.0, false, "the pair was not solved"}};
  bad.diagnoses = {{"too_few_captures", "rear sees nothing.", "Turn the robot."}};
  for (const char* capture : {"01", "02"})
    good.evidence.push_back({std::string("left / ") + capture + ": 54 corners", SensorId("left"), CaptureId(capture),
                             Digest(Sha256Of(capture).str()), "jpg"});
  bad.evidence.push_back(
      {"rear / 01: 54 corners", SensorId("rear"), CaptureId("01"), Digest(Sha256Of("rear").str()), "jpg"});
  input.edges = {good, bad};
  input.unreadable[{CaptureId("02"), SensorId("rear")}] = "the picture is cut off";
  return input;
}

Superseding BySession(const std::string& name) {
  return {SessionId(Sha256Of(name).str()),
          Stamp{kDay_ns},
          "Eve",
          {7, "restored", {Stamp{2 * kDay_ns}, "Ada", "wrong squares"}}};
}

TEST(ReportSession, SaysWhatCameOfItAndWhatToDo) {
  SessionInput input = SessionOfThree();
  EXPECT_THAT(RenderSession(input).value(), AllOf(HasSubstr("1 of 2 pairs of sensors were calibrated, 1 failed. "
                                                            "1 picture of rear cannot be read."),
                                                  HasSubstr("that cannot be read. Turn the robot.</p>")));
  input.all_looked_at = false;
  EXPECT_THAT(RenderSession(input).value(), HasSubstr("1 failed. At least 1 picture of rear cannot be read."));
  input.row.good = 0, input.row.failed = 2;
  EXPECT_THAT(RenderSession(input).value(), HasSubstr("None of 2 pairs of sensors could be calibrated."));
  input.row.superseded_by = BySession("b");
  EXPECT_THAT(RenderSession(input).value(),
              HasSubstr("This session does not count: session " + Sha256Of("b").str().substr(0, 12) +
                        " of the same pictures (captured 1970-01-02 00:00:00 UTC, by Eve), restored by Ada (wrong "
                        "squares) on 1970-01-03 00:00:00 UTC, supersedes it."));
  EXPECT_THAT(RenderSession(input).value(), HasSubstr("<code class=\"typed\">rigcal restore " +
                                                      input.row.id.str().substr(0, 16) + "</code> takes it back."));
  input.row.pairs_waiting = 1;
  const std::string working = RenderSession(input).value();
  EXPECT_THAT(working, HasSubstr("is being calibrated: 1 of 2 pairs are done."));
  EXPECT_THAT(working, HasSubstr("data-live=\"../../../../api/v1/live?robot=r\""));
  input.row.closed = false, input.row.files_held = 3;
  EXPECT_THAT(RenderSession(input).value(), HasSubstr("is arriving, or its push broke off: 3 of 4 files are here."));
  input.edges.clear();
  EXPECT_THAT(RenderSession(input).value(), AllOf(HasSubstr("not looked at yet"), Not(HasSubstr("nothing drawn"))));
}

TEST(ReportSession, EachPictureIsUsedOrSaysWhyNot) {
  const std::string page = RenderSession(SessionOfThree()).value();
  EXPECT_THAT(page, Not(HasSubstr("data-live")));
  EXPECT_THAT(page, HasSubstr("<span class=\"used\">used</span>: 54 corners</span>"));
  EXPECT_THAT(page, HasSubstr("54 corners<br><span class=\"unused\">not used</span>: left: no board</span>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"unused\">not used</span>: none of its pairs could be solved</span>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"unused\">not readable</span>: the picture is cut off</span>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"soft\">nothing drawn</span>"));
  EXPECT_THAT(page, HasSubstr("<summary>1 of 2 pairs</summary>"));
  SessionInput fresh = SessionOfThree();
  fresh.edges.clear();
  EXPECT_THAT(RenderSession(fresh).value(), Not(HasSubstr("<summary>")));
}

TEST(ReportRobot, SessionsSayWhatTheyGave) {
  RobotInput input{SummaryOf("mapper", VerdictLevel::kPass, 3), {}, {}, {}};
  input.sessions = {{SessionId(Sha256Of("a").str()), Stamp{kDay_ns}, "", true, 4, 4, 14, 0, 11, 3},
                    {SessionId(Sha256Of("b").str()), Stamp{kDay_ns}, "", true, 4, 4, 14, 0, 14, 0, 0, BySession("a")},
                    {SessionId(Sha256Of("c").str()), Stamp{kDay_ns}, "", true, 4, 4, 14, 5, 9, 0}};
  input.open = {input.sessions.back()};
  const std::string page = RenderRobot(input, Stamp{2 * kDay_ns}).value();
  EXPECT_THAT(page, HasSubstr("11 of 14 pairs good <span class=\"badge fail\">3 failed</span>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"badge unknown\">superseded</span>"));
  const std::string a = Sha256Of("a").str(), b = Sha256Of("b").str();
  EXPECT_THAT(page, HasSubstr("by <a href=\"sessions/" + a + "/\"><code>" + a.substr(0, 12) +
                              "</code></a> (captured 1970-01-02 00:00:00 UTC, by <bdi>Eve</bdi>), restored by Ada "
                              "(wrong squares) on 1970-01-03 00:00:00 UTC."));
  EXPECT_THAT(page, HasSubstr("<code class=\"typed\">rigcal restore " + b.substr(0, 16) + "</code>"));
  EXPECT_THAT(page, HasSubstr("is being calibrated: 9 of 14 pairs"));
}

TEST(ReportRobot, WhatIsLeftOutIsNamed) {
  RobotInput input{SummaryOf("mapper", VerdictLevel::kPass, 3), {}, {}, {}};
  for (int i = 0; i < 11; ++i)
    input.open.push_back({SessionId(Sha256Of(std::to_string(i)).str()), Stamp{kDay_ns}, "", false, 4, 1, 0, 0});
  const std::string page = RenderRobot(input, Stamp{2 * kDay_ns}).value();
  std::size_t open = 0;
  for (std::size_t at = page.find("is arriving ("); at != std::string::npos; at = page.find("is arriving (", at + 1))
    ++open;
  EXPECT_EQ(open, 5U);  // of 11 pushes that broke off
  EXPECT_THAT(page, HasSubstr("6 older sessions did not come whole"));
}

Revision RevisionOf(int number) {
  Revision revision;
  revision.number = number;
  revision.verdict.level = VerdictLevel::kPass;
  return revision;
}

// One page stays of one size, however long the history.
TEST(ReportRobot, PagesOfAHistoryAreLinked) {
  const SessionRow session{SessionId(Sha256Of("s").str()), Stamp{kDay_ns}, "", true, 4, 4, 1, 0, 1, 0};
  RobotInput input{SummaryOf("mapper", VerdictLevel::kPass, 520), {RevisionOf(520), RevisionOf(519)}, {session}, {}};
  const std::string whole = RenderRobot(input, Stamp{2 * kDay_ns}).value();
  for (const char* link : {"?before=", "?sessions_before=", "The newest"}) EXPECT_THAT(whole, Not(HasSubstr(link)));
  input.older_revisions = input.older_sessions = true;
  const std::string first = RenderRobot(input, Stamp{2 * kDay_ns}).value();
  EXPECT_THAT(first, HasSubstr("<a href=\"?before=519#revisions\">Older revisions</a>"));
  EXPECT_THAT(first, HasSubstr("<a href=\"?sessions_before=" + session.id.str() + "#sessions\">Older sessions</a>"));
  EXPECT_THAT(first, Not(HasSubstr("The newest")));
  input.revisions = {RevisionOf(2), RevisionOf(1)};
  input.older_revisions = input.newest_revisions = false;
  const std::string last = RenderRobot(input, Stamp{2 * kDay_ns}).value();
  EXPECT_THAT(last, HasSubstr("<a href=\"./#revisions\">The newest revisions</a>"));
  EXPECT_THAT(last, Not(HasSubstr("The newest sessions")));
  EXPECT_THAT(last, HasSubstr("href=\"revisions/520/\">Report of revision 520</a>"));
  EXPECT_THAT(last, HasSubstr("href=\"compare?a=519&amp;b=520\">What moved since revision 519</a>"));
  EXPECT_THAT(last, HasSubstr("the first"));
}

TEST(ReportRobot, RevisionsNewestFirst) {
  std::vector<Revision> revisions(3);
  for (int i = 0; i < 3; ++i) {
    auto& revision = revisions[static_cast<std::size_t>(i)];
    revision.number = i + 1;
    revision.digest = Sha256Of(std::to_string(i + 1));
    revision.verdict.level = VerdictLevel::kPass;
  }
  const std::string page =
      RenderRobot({SummaryOf("mapper", VerdictLevel::kPass, 3), revisions, {}, {}}, Stamp{101 * kDay_ns}).value();
  EXPECT_LT(page.find("revisions/3/"), page.find("revisions/2/"));
  EXPECT_LT(page.find("revisions/2/"), page.find("revisions/1/"));
  EXPECT_THAT(page, HasSubstr("href=\"compare?a=2&amp;b=3\">against revision 2</a>"));
  EXPECT_THAT(page, HasSubstr("the first"));
  EXPECT_THAT(page, HasSubstr("href=\"../../style.css\""));
  EXPECT_THAT(page, HasSubstr("banner pass"));
}

}  // namespace
}  // namespace rigcal::report
