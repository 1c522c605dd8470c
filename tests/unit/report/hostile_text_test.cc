// Every text that a person or another program chose goes through every template without becoming markup.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "server/report/boards/boards_page.h"
#include "server/report/edges/page_data.h"
#include "server/report/pages/certificate.h"
#include "server/report/robot_pages.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kHostile = "<script>alert('x')</script>\"><img src=x onerror=\"y\"> & \xD7\xA9\xD7\x9C\xE2\x80\xAE";

void ExpectHarmless(const std::string& page, const std::string& where) {
  EXPECT_THAT(page, Not(HasSubstr("<script>"))) << where;
  EXPECT_THAT(page, Not(HasSubstr("<img src=x"))) << where;
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;")) << where;
  EXPECT_THAT(page, HasSubstr("\xD7\xA9\xD7\x9C")) << where << ": right-to-left text is kept";
}

struct Field {
  std::string name;
  void (*set)(ReportInput&);
};

class HostileText : public ::testing::TestWithParam<Field> {};

TEST_P(HostileText, IsEscapedOnRevisionPage) {
  ReportInput input = SampleReport();
  GetParam().set(input);
  ExpectHarmless(PageOf(input), GetParam().name);
}

INSTANTIATE_TEST_SUITE_P(
    Fields, HostileText,
    ::testing::Values(
        Field{"verdict_why", [](ReportInput& in) { in.revision.verdict.why = kHostile; }},
        Field{"verdict_what_to_do", [](ReportInput& in) { in.revision.verdict.what_to_do = kHostile; }},
        Field{"diagnosis_what", [](ReportInput& in) { in.revision.edges.back().diagnoses[0].what = kHostile; }},
        Field{"diagnosis_cure", [](ReportInput& in) { in.revision.edges.back().diagnoses[0].cure = kHostile; }},
        Field{"cause",
              [](ReportInput& in) {
                Cause cause;
                cause.why = cause.what_to_do = cause.command = kHostile;
                cause.edges = {in.revision.edges[4].id, in.revision.edges[5].id};
                in.revision.edges[4].state = EdgeState::kFailed;
                in.revision.causes = {cause};
              }},
        Field{"graph_note",
              [](ReportInput& in) {
                in.revision.solution.diagnoses = {{"c", kHostile, kHostile}};
              }},
        Field{"as_found_text",
              [](ReportInput& in) {
                in.as_found.emplace();
                in.as_found->text = kHostile;
              }},
        Field{"as_found_sensors",
              [](ReportInput& in) {
                SensorFound found;
                found.sensor = found.or_else = SensorId(kHostile);
                in.as_found.emplace();
                in.as_found->sensors = {found};
                in.as_found->relative_to = SensorId(kHostile);
              }},
        Field{"cloud_note", [](ReportInput& in) { in.clouds.notes = {kHostile}; }},
        Field{"cloud_lidar",
              [](ReportInput& in) {
                in.clouds.lidars = {{kHostile, kHostile, kHostile, kHostile, kHostile, kHostile, kHostile, 9, 3, 1}};
              }},
        Field{"overlay",
              [](ReportInput& in) {
                in.clouds.overlays = {{kHostile, kHostile, kHostile, kHostile, kHostile, 5}};
              }},
        Field{"influence_why_not", [](ReportInput& in) { in.revision.solution.influences.why_not = kHostile; }},
        Field{"influence_sensor",
              [](ReportInput& in) {
                in.revision.solution.influences.edges = {
                    {in.revision.edges[0].id, true, 1.0, SensorId(kHostile), Vector6d::Ones(), 1.0}};
              }},
        Field{"loop_why_not", [](ReportInput& in) { in.revision.solution.cycles.why_not = kHostile; }},
        Field{"loop_sensor",
              [](ReportInput& in) {
                in.revision.solution.cycles.judged = true;
                in.revision.solution.cycles.worst.resize(1);
                in.revision.solution.cycles.worst[0].sensors = {SensorId(kHostile)};
              }},
        Field{"retired_sensor",
              [](ReportInput& in) {
                in.revision.retired = {{SensorId(kHostile), {Stamp{1}, kHostile, kHostile}}};
              }},
        Field{"method", [](ReportInput& in) { in.revision.edges[0].method = kHostile; }},
        Field{"capture_note", [](ReportInput& in) { in.revision.edges[0].captures[4].note = kHostile; }},
        Field{"picture_title", [](ReportInput& in) { in.revision.edges[0].evidence[0].title = kHostile; }},
        Field{"missing_picture_title", [](ReportInput& in) { in.revision.edges[0].evidence.back().title = kHostile; }},
        Field{"contribution",
              [](ReportInput& in) { in.revision.edges[0].uncertainty.contributions[0].name = kHostile; }},
        Field{"figure",
              [](ReportInput& in) {
                in.revision.edges[0].figures = {{kHostile, 1.0}};
              }},
        Field{"software", [](ReportInput& in) { in.software_version = kHostile; }},
        // Ids cannot hold such text when they come through Parse; the pages do not rely on it.
        Field{"robot", [](ReportInput& in) { in.revision.robot = RobotId(kHostile); }},
        Field{"sensor", [](ReportInput& in) { in.revision.solution.poses[1].sensor = SensorId(kHostile); }},
        Field{"frame", [](ReportInput& in) { in.revision.edges[0].frame_b = SensorId(kHostile); }},
        Field{"capture", [](ReportInput& in) { in.revision.edges[0].captures[0].capture = CaptureId(kHostile); }},
        Field{"session", [](ReportInput& in) { in.revision.edges[0].session = SessionId(kHostile); }}),
    [](const auto& field) { return field.param.name; });

TEST(HostileTextElsewhere, FleetAndRobotPage) {
  RobotSummary row{
      RobotId(kHostile), 3, {VerdictLevel::kFail, kHostile, kHostile}, {Stamp{1}, true, std::nullopt, false}, 1, 1};
  Revision revision;
  revision.number = 3;
  revision.verdict = row.verdict;
  row.worst = WorstEdge{SensorId(kHostile), SensorId(kHostile), 1.0};
  FleetCounts fleet;
  fleet.robots = 1;
  ExpectHarmless(RenderFleet(fleet, {{row}, 1, 1, 1}, Stamp{2}, {kHostile, kHostile, kHostile, true, 1}).value(),
                 "fleet");
  SessionRow session{SessionId(kHostile), Stamp{1}, kHostile, false, 2, 1, 1, 1};
  session.retired = Word{Stamp{1}, kHostile, kHostile};
  RobotInput robot{row, {revision, revision}, {session}, {SensorId(kHostile)}, {session}, true, true};
  robot.retired = {{SensorId(kHostile), *session.retired}};
  ExpectHarmless(RenderRobot(robot, Stamp{2}).value(), "robot");
}

TEST(HostileTextElsewhere, BoardsPage) {
  formats::BoardRow row;
  row.measure.serial = row.measure.word.who = kHostile;
  row.measure.length_x_m = row.measure.length_y_m = 0.1;
  row.measure.next_check_at = Stamp{1};
  row.check_due = true;
  ExpectHarmless(RenderBoards({{row}, {}, kHostile}).value(), "boards");
  ExpectHarmless(RenderBoards({{}, {{kHostile, row.measure.pattern, 1}}, ""}).value(), "boards that nobody measured");
}

TEST(HostileTextElsewhere, SessionPage) {
  SessionInput input;
  input.robot = RobotId(kHostile);
  input.row = {SessionId(kHostile), Stamp{1}, kHostile, true, 1, 1, 1, 0};
  input.manifest.header.conditions = {{kHostile, kHostile}};
  Sensor sensor;
  sensor.id = SensorId(kHostile);
  input.manifest.header.sensors = {sensor};
  input.manifest.payloads = {{"a/b.png", sensor.id, CaptureId(kHostile), Digest(), 1}};
  input.edges = {SampleReport().revision.edges[0]};
  input.edges[0].captures[0] = {CaptureId(kHostile), 0.1, false, kHostile};
  input.edges[0].evidence[0] = {kHostile, sensor.id, CaptureId(kHostile), Sha256Of("x"), "jpg"};
  input.row.retired = Word{Stamp{1}, kHostile, kHostile};
  input.retired = {{sensor.id, *input.row.retired}};
  input.robot_now = RobotSummary{};
  input.robot_now->revision = 1;
  input.robot_now->verdict = {VerdictLevel::kUnknown, kHostile, kHostile, kHostile};
  ExpectHarmless(RenderSession(input).value(), "session");
}

TEST(HostileTextElsewhere, Certificate) {
  for (const auto& set : std::vector<void (*)(ReportInput&)>{
           [](ReportInput& in) { in.revision.robot = RobotId(kHostile); },
           [](ReportInput& in) { in.revision.verdict.why = kHostile; },
           [](ReportInput& in) { in.revision.solution.poses[1].sensor = SensorId(kHostile); },
           [](ReportInput& in) { in.software_version = kHostile; },
           [](ReportInput& in) {
             in.sessions = {{in.revision.edges[0].session, Stamp{1}, kHostile, "", {}, 1}};
           },
           [](ReportInput& in) {
             in.sessions = {{in.revision.edges[0].session, Stamp{1}, "", kHostile, {}, 1}};
           },
           [](ReportInput& in) {
             in.sessions = {{in.revision.edges[0].session, Stamp{1}, "", "", {kHostile}, 1}};
           },
           [](ReportInput& in) {
             in.sessions = {{in.revision.edges[0].session, Stamp{1}, "", "", {}, 1, {}, {{kHostile, kHostile}}}};
           },
           [](ReportInput& in) {
             in.approval = {
                 RevisionState::kApproved, Decision{1, 7, kHostile, {Stamp{1}, kHostile, kHostile}}, {}, kHostile};
           },
           [](ReportInput& in) { in.as_found = AsFound{}, in.as_found->text = kHostile; }}) {
    ReportInput input = SampleReport();
    set(input);
    ExpectHarmless(RenderCertificate(input, StandingWhenDrawn(input), "").value(), "certificate");
  }
}

TEST(HostileTextElsewhere, Comparison) {
  auto revision = std::make_shared<formats::RevisionInput>(SampleReport().revision);
  revision->solution.poses[1].sensor = SensorId(kHostile);
  revision->edges[0].method = kHostile;
  ExpectHarmless(RenderCompare({RobotId(kHostile), {1, revision}, {2, revision}, 2}).value(), "compare");
  CompareInput input{RobotId("r"),
                     {1, std::make_shared<formats::RevisionInput>()},
                     {2, std::make_shared<formats::RevisionInput>()},
                     2};
  LensChange change;
  change.camera = SensorId(kHostile);
  input.lenses = {{change}, {}, {}};
  ExpectHarmless(RenderCompare(input).value(), "changed lens");
  input.lenses = {{}, {SensorId(kHostile)}, {}};
  ExpectHarmless(RenderCompare(input).value(), "same lens");
  input.lenses = {{}, {}, {{SensorId(kHostile), "why"}}};
  ExpectHarmless(RenderCompare(input).value(), "lens not compared");
}

// A spreadsheet runs what begins like a formula.
TEST(HostileTextElsewhere, CsvHoldsNoFormula) {
  EXPECT_EQ(CsvField("=HYPERLINK(\"x\")"), "\"'=HYPERLINK(\"\"x\"\")\"");
  EXPECT_EQ(CsvField("@a"), "'@a");
  EXPECT_EQ(CsvField("a,b"), "\"a,b\"");
  EXPECT_EQ(CsvField("front_left"), "front_left");
}

TEST(HostileTextElsewhere, Drawing) {
  ReportInput input = SampleReport();
  input.revision.edges.back().diagnoses[0].what = kHostile;
  ExpectHarmless(RenderGraphSvg(input.revision), "drawing");
}

// A template without this line escapes nothing at all.
TEST(HostileTextElsewhere, EveryTemplateEscapesByItself) {
  int templates = 0;
  for (const auto& entry : std::filesystem::directory_iterator(RIGCAL_SOURCE_DIR "/server/report/templates")) {
    std::string first;
    std::ifstream file(entry.path());
    std::getline(file, first);
    EXPECT_EQ(first, "{{%AUTOESCAPE context=\"HTML\"}}") << entry.path();
    ++templates;
  }
  EXPECT_EQ(templates, 27);
}

TEST(HostileTextElsewhere, PictureSuffixCannotLeaveTheFolder) {
  ReportInput input = SampleReport();
  input.revision.edges[0].evidence[0].suffix = "jpg/../../../../secret";
  EXPECT_THAT(PageOf(input), Not(HasSubstr("secret")));
}

}  // namespace
}  // namespace rigcal::report
