// What a certificate says, whatever it is drawn on.
#include "server/report/certificate/content.h"

#include <gmock/gmock.h>

#include "tests/unit/report/certificate/sample.h"

namespace rigcal::report {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

Certificate Of(const ReportInput& input) { return CertificateOf(input, StandingWhenDrawn(input)); }

// Cells of a sensor's row, in part `part`; none: there is no such row.
std::vector<std::string> CellsOf(const Certificate& certificate, const std::string& sensor, std::size_t part = 0) {
  std::vector<std::string> texts;
  for (const auto& row : certificate.parts[part].table.rows)
    if (row[0].text == sensor)
      for (const CertificateCell& cell : row) texts.push_back(cell.text);
  return texts;
}

TEST(CertificateContent, SaysWhatWhenByWhomAndWithWhat) {
  const Certificate certificate = Of(CertificateSample());
  EXPECT_EQ(certificate.title, "Calibration certificate");
  EXPECT_EQ(certificate.rig_model, "mars-mapper");
  EXPECT_EQ(certificate.measured, "Measured 2026-01-30 09:30:00 UTC, solved 2026-01-31 12:00:00 UTC.");
  EXPECT_EQ(certificate.state, "In use: approved by Eve, 1 Feb 2026: checked.");
  EXPECT_THAT(
      certificate.parts[2].text,
      ElementsAre("Session " + Sha256Of("session").str().substr(0, 12) +
                      ": captured 2026-01-30 09:30:00 UTC by Ada; conditions: site: hall 3, "
                      "temperature_deg_c: 21.",
                  "1 edge was pushed as finished results.", "Board board: checkerboard 9 x 6, 25 mm.",
                  "Software: rigcald 0.1.0.", "Document: revision.json, sha256 " + Sha256Of("document").str() + "."));
}

TEST(CertificateContent, ABoardThatNoSensorSawIsNoReference) {
  ReportInput input = CertificateSample();
  input.sessions[0].boards_unseen = {"spare: checkerboard 8 x 5, 30 mm"};
  input.sessions[0].boards_perhaps_seen = {"board: checkerboard 9 x 6, 25 mm", "far: checkerboard 7 x 5, 60 mm"};
  const std::vector<std::string> text = Of(input).parts[2].text;
  EXPECT_THAT(text, Contains("Board board: checkerboard 9 x 6, 25 mm."));
  EXPECT_THAT(text, Contains("Board far: checkerboard 7 x 5, 60 mm (it is not known whether a sensor saw it)."));
  EXPECT_THAT(text, Not(Contains(HasSubstr("spare"))));
  EXPECT_EQ(text.size(), 6U) << "each once";
  input.sessions[0].boards.clear();
  input.sessions[0].boards_perhaps_seen.clear();
  EXPECT_THAT(Of(input).parts[2].text, Contains("No board: no sensor saw one."));
}

// Student's t for 95 % on both sides, from a table: 2.228 with 10 degrees of freedom; 2.228 * 0.28 = 0.624.
TEST(CertificateContent, PosesHaveTheirUncertaintyBesideLimitAndDecision) {
  const Certificate certificate = Of(CertificateSample());
  EXPECT_THAT(CellsOf(certificate, "front_right"),
              ElementsAre("front_right", "83.18", "0.40", "-1.20", "0.000", "0.000", "0.498", "0.28 (1.0)",
                          "0.032 (0.29)", "2.23 (10)", "0.62", "0.071", "yes"));
  EXPECT_THAT(CellsOf(certificate, "lidar"), Contains("no")) << "1.1 mm times 1.4, beyond the limit of 1 mm";
  EXPECT_THAT(CellsOf(certificate, "lidar"), Contains("1.96 (inf)")) << "given: nothing in it is estimated";
  EXPECT_EQ(CellsOf(certificate, "front_left").back(), "reference: fixed, without uncertainty");
  EXPECT_THAT(CellsOf(certificate, "tracker"), ElementsAre("tracker", HasSubstr("unknown: ")));
  for (const auto& row : certificate.parts[0].table.rows) {
    int columns = 0;
    for (const CertificateCell& cell : row) columns += cell.span;
    EXPECT_EQ(columns, 13) << row[0].text;
  }
}

// A sigma of 0.5 mm keeps the limit of 1 mm, but U = 2.228 * 0.5 = 1.1 mm does not.
TEST(CertificateContent, ASigmaWithinTheLimitDecidesNothingYet) {
  ReportInput input = CertificateSample();
  input.revision.solution.poses[1].covariance(0, 0) = 0.0005 * 0.0005;
  EXPECT_EQ(CellsOf(Of(input), "front_right").back(), "not decided");
  input.revision.solution.poses[1].dof = 0;
  EXPECT_EQ(CellsOf(Of(CertificateSample()), "front_right").back(), "yes");
  EXPECT_EQ(CellsOf(Of(input), "front_right").back(), "yes") << "by the noise alone U is 1.96 * 0.5 = 0.98 mm";
  input.revision.policy.reset();
  EXPECT_EQ(CellsOf(Of(input), "front_right").back(), "-");
}

TEST(CertificateContent, EachSensorHasItsOwnLimit) {
  ReportInput input = CertificateSample();
  input.revision.policy->policy.sensors[SensorId("lidar")].tolerance_m = 0.01;
  EXPECT_THAT(CellsOf(Of(input), "lidar"), Contains("1.5 (10)"));
}

// One truth: the rule above says not to rely on it.
TEST(CertificateContent, WhatTheVerdictDoesNotRelyOnIsNotWithinLimits) {
  ReportInput input = CertificateSample();
  input.revision.verdict = {VerdictLevel::kUnknown, "Why; also, more.", "What; then more.", "front_right"};
  input.revision.basis.doubted = {SensorId("front_right")};
  input.revision.basis.reasons = {{"Why.", "What."}, {"More.", "More."}};
  const Certificate certificate = Of(input);
  EXPECT_EQ(CellsOf(certificate, "front_right").back(), "not verified");
  EXPECT_EQ(certificate.verdict.why, "Why. (1 more finding is in the report.)");
}

// A tracker whose height is open: forward 0.1 m, to the right 0.2 m, held at 0.777 m.
TEST(CertificateContent, WhatThePolicyDoesNotNeedIsSaidSo) {
  ReportInput input = CertificateSample();
  input.revision.solution.R_ref_robot = Eigen::Matrix3d::Identity();
  SensorPose& top = input.revision.solution.poses[4];
  top.known = false;
  top.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  top.measured_part = MeasuredPart{SamplePose(0.1, -0.2, 0.777, 0.5)};
  for (int axis = 0; axis < 6; ++axis) top.measured_part->covariance(axis, axis) = axis == 2 ? 0 : 4e-8;
  const std::string measured =
      "forward 100.00 mm, sideways -200.00 mm, roll 0.000, pitch 0.000, yaw 28.648 deg; the "
      "height was not measured; the rest is good to 0.20 mm and 0.011 deg";
  EXPECT_THAT(CellsOf(Of(input), "top"),
              ElementsAre("top", measured, "0.20 (1.0)", "0.011 (0.29)", "-", "-", "-", "not decided"));
  input.revision.policy->policy.sensors[SensorId("top")].not_needed = {"height"};
  EXPECT_EQ(CellsOf(Of(input), "top")[1], measured + "; the policy does not need it");
  input.revision.policy->policy.sensors[SensorId("top")].not_needed = {"yaw"};
  EXPECT_EQ(CellsOf(Of(input), "top")[1], measured);
  input.revision.solution.R_ref_robot.reset();
  input.revision.policy->policy.sensors[SensorId("top")].not_needed = {"z of front_left"};
  EXPECT_THAT(CellsOf(Of(input), "top")[1], HasSubstr("; the policy does not need it"));
  input.revision.policy->policy.sensors[SensorId("top")].not_needed = {"z of front_right"};
  EXPECT_THAT(CellsOf(Of(input), "top")[1], Not(HasSubstr("does not need")));
}

// It is in use, but a newer one came about, which failed: what this one says of driving is past.
TEST(CertificateContent, NobodySignsWhatANewerRevisionContradicts) {
  const ReportInput input = CertificateSample();
  CertificateStanding standing = StandingWhenDrawn(input);
  EXPECT_TRUE(CertificateOf(input, standing).to_sign);
  standing.validity.superseded_by = input.number + 1;
  EXPECT_FALSE(CertificateOf(input, standing).to_sign);
}

TEST(CertificateContent, AsFoundIsHeldAgainstTheLimitWithAGuardBand) {
  ReportInput input = CertificateSample();
  EXPECT_THAT(Of(input).parts[1].text, ElementsAre(HasSubstr("Nothing was in use before")));
  AsFound found;
  found.text = "As found: lidar moved.", found.relative_to = SensorId("front_left");
  found.sensors = {{SensorId("lidar"), FoundState::kDrifted}, {SensorId("rear"), FoundState::kMovedOnPurpose}};
  SensorFound& lidar = found.sensors[0];
  lidar.axes.fill(FoundState::kUnchanged);
  lidar.change << 0.0045, 0, 0, 0.001, 0, 0;
  lidar.sigma << 0.0004, 0.0004, 0.0004, 0.0001, 0.0001, 0.0001;
  lidar.left = Vector6d::Constant(0.0002);
  input.as_found = found;
  const Certificate certificate = Of(input);
  EXPECT_THAT(certificate.parts[1].text, ElementsAre("As found: lidar moved."));
  // 4.5 mm less 0.8 mm is beyond 1 mm; 0.0002 m is 0.2 mm, 0.0002 rad 0.0115 deg.
  EXPECT_THAT(CellsOf(certificate, "lidar", 1), ElementsAre("lidar", "drifted", "4.50 \xC2\xB1 0.80 (1.0)",
                                                            "0.057 \xC2\xB1 0.011 (0.29)", "no", "0.20", "0.011"));
  EXPECT_THAT(CellsOf(certificate, "rear", 1), ElementsAre("rear", "moved on purpose"));
  input.as_found->sensors[0].state = FoundState::kNotToldApart;
  EXPECT_THAT(CellsOf(Of(input), "lidar", 1), Contains("not told apart from scatter"));
  input.as_found->sensors[0].change.setZero();
  input.as_found->sensors[0].sigma.head<3>().setConstant(0.0001);
  EXPECT_EQ(CellsOf(Of(input), "lidar", 1)[4], "yes");
  input.revision.verdict.level = VerdictLevel::kFail;
  input.revision.basis.culprits = {SensorId("lidar")};
  EXPECT_EQ(CellsOf(Of(input), "lidar", 1)[4], "not verified") << "its session failed";
  input.as_found->why_not = "Nothing could be tested.", input.as_found->text.clear();
  EXPECT_THAT(Of(input).parts[1].text, ElementsAre("Nothing could be tested."));
  EXPECT_THAT(Of(input).parts[1].table.columns, IsEmpty());
}

// Sessions that nothing counts of are not what a robot was measured with; of many the newest are told.
TEST(CertificateContent, SessionsThatCountTheNewestFirstAndAllAreCounted) {
  ReportInput input = CertificateSample();
  input.sessions.push_back({SessionId(Sha256Of("other").str()), Stamp{1}, "Bob", "", {"old: checkerboard"}, 2});
  input.revision.edges.back().session = input.sessions.back().id;
  EXPECT_THAT(Of(input).parts[2].text, Not(Contains(HasSubstr("Bob")))) << "that edge failed";
  for (int i = 0; i < 30; ++i) {
    const std::string name = "extra-" + std::to_string(i);
    input.sessions.push_back({SessionId(Sha256Of(name).str()), Stamp{i}, "", "", {name + ": checkerboard"}, 2});
    input.revision.edges.push_back(SampleEdge("front_left", name, Se3()));
    input.revision.edges.back().session = input.sessions.back().id;
  }
  const std::vector<std::string> text = Of(input).parts[2].text;
  EXPECT_THAT(text[0], HasSubstr("by Ada"));
  EXPECT_THAT(text, Contains("And 27 older sessions that count."));
  EXPECT_THAT(text, Contains("And 19 boards more."));
  for (Edge& edge : input.revision.edges) edge.state = EdgeState::kFailed;
  EXPECT_EQ(Of(input).parts[2].text[0], "Nothing that counts.");
}

// A sheet with a place for a signature reads as a permit.
TEST(CertificateContent, WhatMustNotBeReliedOnIsNoCertificateAndIsNotSigned) {
  ReportInput input = CertificateSample();
  for (const VerdictLevel level : {VerdictLevel::kPass, VerdictLevel::kWarn}) {
    input.revision.verdict.level = level;
    EXPECT_TRUE(Of(input).to_sign);
    for (const RevisionState state : {RevisionState::kCandidate, RevisionState::kTakenBack, RevisionState::kRolledBack,
                                      RevisionState::kRejected, RevisionState::kSuperseded, RevisionState::kUnusable}) {
      CertificateStanding standing = StandingWhenDrawn(input);
      standing.approval->state = state;
      const Certificate certificate = CertificateOf(input, standing);
      EXPECT_THAT(certificate.title, HasSubstr("no certificate")) << NameOf(state);
      EXPECT_FALSE(certificate.to_sign) << NameOf(state);
    }
  }
  for (const VerdictLevel level : {VerdictLevel::kFail, VerdictLevel::kUnknown}) {
    input.revision.verdict.level = level;
    EXPECT_EQ(Of(input).title, "Calibration record, no certificate");
    EXPECT_FALSE(Of(input).to_sign);
  }
}

TEST(CertificateContent, AnOverdueOneIsNotSigned) {
  const ReportInput input = CertificateSample();
  CertificateStanding standing = StandingWhenDrawn(input);
  standing.validity.overdue = true;
  const Certificate certificate = CertificateOf(input, standing);
  EXPECT_FALSE(certificate.to_sign);
  EXPECT_EQ(certificate.title, "Calibration record, no certificate");
  EXPECT_THAT(certificate.rule, HasSubstr("overdue since"));
}

TEST(CertificateContent, ItsOwnCopyOfACandidateSaysSo) {
  ReportInput input = CertificateSample();
  input.approval = Approval{RevisionState::kCandidate};
  EXPECT_THAT(Of(input).rule, HasSubstr("Not approved"));
  EXPECT_EQ(Of(input).state, "A candidate that nobody approved.");
}

TEST(CertificateContent, ALongVerdictIsCutAtASentence) {
  ReportInput input = CertificateSample();
  input.revision.verdict.why.clear();
  for (int i = 0; i < 100; ++i) input.revision.verdict.why += "Sentence " + std::to_string(i) + ". ";
  EXPECT_THAT(Of(input).verdict.why, HasSubstr("Sentence 25. "));
  EXPECT_THAT(Of(input).verdict.why, Not(HasSubstr("Sentence 80")));
  EXPECT_THAT(Of(input).verdict.why, HasSubstr(". [...] The report has the rest."));
}

}  // namespace
}  // namespace rigcal::report
