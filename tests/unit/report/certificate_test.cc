// The certificate of a revision: what it says, what it leaves out, and that it says so.
#include "server/report/pages/certificate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/pages/certified_sensors.h"
#include "server/report/robot_pages.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// With sessions, a rig and degrees of freedom behind one sensor: sigma 0.28 mm and 0.0321 deg at worst.
ReportInput Sample() {
  ReportInput input = SampleReport();
  input.revision.policy = PolicyInForce{};
  input.revision.policy->policy.all.tolerance_m = 0.001;
  input.calibrated_at = *ParseIso("2026-01-30T09:30:00Z");
  SensorPose& right = input.revision.solution.poses[1];
  right.by_jackknife = true, right.dof = 10.0;
  input.sessions = {{SessionId(Sha256Of("session").str()),
                     *input.calibrated_at,
                     "Ada",
                     "mars-mapper",
                     {"board: checkerboard 9 x 6, 25 mm"},
                     20}};
  return input;
}

std::string CertificateOf(const ReportInput& input) { return RenderCertificate(input).value(); }

std::string RowOf(const std::string& page, const std::string& sensor) {
  const auto from = page.find("<th scope=\"row\"><span class=\"name\">" + sensor + "</span></th>");
  return from == std::string::npos ? "" : page.substr(from, page.find("</tr>", from) - from);
}

TEST(Certificate, NamesTheRobotAndWhatItWasMeasuredWith) {
  const std::string page = CertificateOf(Sample());
  for (const char* part :
       {"mapper-01", "rig <bdi>mars-mapper</bdi>", "revision 7",
        "Measured 2026-01-30 09:30:00 UTC, solved 2026-01-31 12:00:00 UTC", "board: checkerboard 9 x 6, 25 mm",
        "captured 2026-01-30 09:30:00 UTC by <bdi>Ada</bdi>", "rigcald <bdi>0.1.0</bdi>",
        "One edge failed: front_left to rear", "Repeat the session for front_left and rear",
        "1 edge pushed as finished results", "Signature"})
    EXPECT_THAT(page, HasSubstr(part));
  EXPECT_THAT(page, HasSubstr("sha256 " + Sha256Of("document").str()));
  EXPECT_EQ(page, CertificateOf(Sample()));
}

// Student's t for 95 % on both sides, from a table: 2.228 with 10 degrees of freedom.
TEST(Certificate, TellsPosesWithLimitsAndIntervals) {
  const std::string page = CertificateOf(Sample());
  EXPECT_EQ(RowOf(page, "front_right"),
            "<th "
            "scope=\"row\"><span "
            "class=\"name\">front_right</span></th><td>83.18</td><td>0.40</td><td>-1.20</td><td>0.000</td><td>0.000</"
            "td><td>0.498</td>"
            "<td>0.28 (1.0)</td><td>0.032 (0.29)</td><td>2.23</td><td>0.62</td><td>0.071</td><td>yes</td>");
  EXPECT_THAT(page, HasSubstr("&sigma; (limit)"));
  // 1.1 mm times 1.4, above the limit of 1 mm; degrees of freedom not known.
  EXPECT_THAT(RowOf(page, "lidar"),
              HasSubstr("<td>1.5 (1.0)</td><td>0.18 "
                        "(0.29)</td><td>\xE2\x80\x93</td><td>\xE2\x80\x93</td><td>\xE2\x80\x93</td><td>no</td>"));
  EXPECT_THAT(page, HasSubstr("these are not known"));
  EXPECT_THAT(RowOf(page, "front_left"), HasSubstr("reference: fixed"));
  EXPECT_THAT(RowOf(page, "tracker"), HasSubstr("unknown"));
}

TEST(Certificate, CoverageFactorIsStudents) {
  SensorPose pose;
  EXPECT_FALSE(CoverageFactor(pose));
  for (const auto& [dof, k] :
       {std::pair(1.0, 12.706), std::pair(4.0, 2.776), std::pair(30.0, 2.042), std::pair(1e6, 1.960)}) {
    pose.dof = dof;
    EXPECT_NEAR(*CoverageFactor(pose), k, 1e-3) << dof;
  }
}

// One truth per page: the rule above says not to rely on it.
TEST(Certificate, WhatTheVerdictDoesNotRelyOnIsNotWithinLimits) {
  ReportInput input = Sample();
  EXPECT_THAT(RowOf(CertificateOf(input), "front_right"), HasSubstr("<td>yes</td>"));
  input.revision.verdict = {VerdictLevel::kUnknown, "Why; also, more.", "What; then more.", "front_right"};
  input.revision.basis.doubted = {SensorId("front_right")};
  input.revision.basis.reasons = {{"Why.", "What."}, {"More.", "More."}};
  const std::string page = CertificateOf(input);
  EXPECT_THAT(RowOf(page, "front_right"), HasSubstr("<td>not verified</td>"));
  EXPECT_THAT(page, HasSubstr("Why. (1 more finding is in the report.)</p>"));
}

TEST(Certificate, BeginsWithTheDriveRule) {
  ReportInput input = Sample();
  input.max_age_ns = 10LL * 86'400'000'000'000;
  const std::string page = CertificateOf(input);
  EXPECT_THAT(
      page,
      HasSubstr("OK to drive; repeat the session for front_left and rear, and connect tracker, by 9 Feb 2026.</p>"));
  EXPECT_LT(page.find("OK to drive"), page.find("class=\"word then\""));
}

TEST(Certificate, EachSensorHasItsOwnLimit) {
  ReportInput input = Sample();
  input.revision.policy->policy.sensors[SensorId("lidar")].tolerance_m = 0.01;
  EXPECT_THAT(RowOf(CertificateOf(input), "lidar"), HasSubstr("<td>1.5 (10)</td>"));
  EXPECT_THAT(RowOf(CertificateOf(input), "lidar"), HasSubstr("<td>yes</td>"));
}

TEST(Certificate, WithoutLimitsNothingIsHeldAgainstThem) {
  ReportInput input = Sample();
  input.revision.policy.reset();
  const std::string page = CertificateOf(input);
  EXPECT_THAT(page, Not(HasSubstr("(limit)")));
  EXPECT_THAT(RowOf(page, "front_right"), HasSubstr("<td>0.071</td><td>\xE2\x80\x93</td>"));
}

// Sessions that nothing counts of are not what a robot was measured with.
TEST(Certificate, SessionsOfPastAndFailedEdgesAreLeftOut) {
  ReportInput input = Sample();
  input.sessions.push_back(
      {SessionId(Sha256Of("other").str()), Stamp{1}, "Bob", "", {"old: checkerboard 5 x 4, 30 mm"}, 2});
  input.revision.edges.back().session = input.sessions.back().id;
  EXPECT_THAT(CertificateOf(input), Not(HasSubstr("Bob")));
  input.revision.edges[0].session = input.sessions.back().id;
  const std::string page = CertificateOf(input);
  EXPECT_LT(page.find("Ada"), page.find("Bob")) << "the newest first";
  EXPECT_THAT(page, HasSubstr("old: checkerboard"));
  for (Edge& edge : input.revision.edges) edge.state = EdgeState::kFailed;
  EXPECT_THAT(CertificateOf(input), HasSubstr("none that counts"));
}

TEST(Certificate, OfManyItHasTheLeastCertainAndTheNewestAndSaysSo) {
  ReportInput input = Sample();
  for (int i = 0; i < 30; ++i) {
    const std::string name = "extra-" + std::to_string(i);
    AddPose(input.revision, name, true, SamplePose(1, 2, 3, 0.5), 0.0001 * (i + 1));
    input.sessions.push_back({SessionId(Sha256Of(name).str()), Stamp{i}, "", "", {name + ": checkerboard"}, 2});
    input.revision.edges.push_back(SampleEdge("front_left", name, Se3()));
    input.revision.edges.back().session = input.sessions.back().id;
  }
  const std::string page = CertificateOf(input);
  EXPECT_THAT(page, HasSubstr("22 sensors more, all more certain than these"));
  EXPECT_NE(RowOf(page, "extra-29"), "");
  EXPECT_EQ(RowOf(page, "extra-0"), "");
  EXPECT_NE(RowOf(page, "tracker"), "") << "what is not known comes first";
  EXPECT_THAT(page, HasSubstr("and 27 older sessions"));
  EXPECT_THAT(page, HasSubstr("and 27 boards more"));
}

// A sheet with a place for a signature reads as a permit.
TEST(Certificate, WhatMustNotBeReliedOnIsNoCertificateAndIsNotSigned) {
  ReportInput input = Sample();
  for (const VerdictLevel level : {VerdictLevel::kPass, VerdictLevel::kWarn}) {
    input.revision.verdict.level = level;
    EXPECT_THAT(CertificateOf(input),
                AllOf(HasSubstr("<h1>Calibration certificate <"), HasSubstr("class=\"signature\"")));
  }
  for (const VerdictLevel level : {VerdictLevel::kFail, VerdictLevel::kUnknown}) {
    input.revision.verdict.level = level;
    EXPECT_THAT(CertificateOf(input),
                AllOf(HasSubstr("<h1>Calibration record, no certificate <"), Not(HasSubstr("class=\"signature\""))));
  }
}

TEST(Certificate, ALongVerdictIsCutAtASentence) {
  ReportInput input = Sample();
  input.revision.verdict.why.clear();
  for (int i = 0; i < 100; ++i) input.revision.verdict.why += "Sentence " + std::to_string(i) + ". ";
  const std::string page = CertificateOf(input);
  EXPECT_THAT(page, HasSubstr("Sentence 25. "));
  EXPECT_THAT(page, Not(HasSubstr("Sentence 80")));
  EXPECT_THAT(page, HasSubstr(". [...] The report has the rest."));
}

TEST(Certificate, NothingOddBecomesANumber) {
  ReportInput input = Sample();
  input.revision.solution.poses[1].covariance(0, 0) = NAN;
  input.revision.solution.poses[2].covariance.setZero();
  const std::string page = CertificateOf(input);
  EXPECT_THAT(RowOf(page, "front_right"), HasSubstr("not known"));
  EXPECT_THAT(RowOf(page, "lidar"), HasSubstr("not known"));
  EXPECT_THAT(page, Not(HasSubstr(">nan")));
}

TEST(Certificate, IsBesideTheReportAndLinked) {
  const auto files = RenderRevision(Sample(), "{}").value();
  ASSERT_TRUE(files.contains(kCertificateFile));
  EXPECT_EQ(files.at(kCertificateFile), CertificateOf(Sample()));
  EXPECT_THAT(files.at("index.html"), HasSubstr("href=\"certificate.html\""));
  RobotInput robot;
  robot.row.robot = RobotId("mapper-01");
  robot.row.revision = 7;
  EXPECT_THAT(RenderRobot(robot, Stamp{1}).value(), HasSubstr("href=\"revisions/7/certificate.html\""));
  robot.row.verdict.level = VerdictLevel::kFail;
  robot.row.site = "hall <3>";
  EXPECT_THAT(RenderRobot(robot, Stamp{1}).value(),
              AllOf(HasSubstr(">Record to print</a>"), HasSubstr(", at <bdi>hall &lt;3&gt;</bdi>")));
}

}  // namespace
}  // namespace rigcal::report
