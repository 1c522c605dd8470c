// Two sensors that sit where the drawing has the other: when they are said to be exchanged, and when the drawing may be
// wrong.
#include <gmock/gmock.h>

#include "tests/unit/fleet/causes/drawn.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;

const Se3 kLeft = At({1, 0.211, 0.5}), kRight = At({1, -0.211, 0.5});
const Se3 kMast = At({0.3, 0.25, 1.2}), kRear = At({-1, 0, 0.5}, M_PI);

// Nobody relies on them, and nobody is told to rename anything before he has looked.
void ExpectDoubt(const Drawn& drawn, const std::string& first, const std::string& second, const std::string& off) {
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, CauseKind::kFarFromNominal);
  EXPECT_THAT(causes[0].sensors, ElementsAre(SensorId(first), SensorId(second)));
  EXPECT_EQ(causes[0].command, "rigcal push FOLDER");
  const Verdict verdict = drawn.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.unverified, first + " and " + second);
  EXPECT_THAT(verdict.why,
              StartsWith(first + " and " + second + " sit at each other's nominal (CAD) places (" + off +
                         " from nominal): they are exchanged, or the sign or direction of T_ref_nominal is wrong"));
  EXPECT_THAT(verdict.what_to_do, StartsWith("Open one file of " + first + "/: is it from " + first +
                                             "? No: exchange the names of the two folders."));
}

// The mast, which is not half-way between them, is where the drawing has it: so its signs are right.
TEST(Exchanged, TwoCamerasAtEachOthersPlaces) {
  Drawn drawn = WithReference();
  drawn.Add("front_left", SensorKind::kCamera, kLeft, kRight);
  drawn.Add("front_right", SensorKind::kCamera, kRight, kLeft * At({0.004, 0, 0}));
  drawn.Add("mast", SensorKind::kLidar, kMast, kMast * At({0.01, 0, 0}));
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, CauseKind::kExchanged);
  EXPECT_THAT(causes[0].sensors, ElementsAre(SensorId("front_left"), SensorId("front_right")));
  const Verdict verdict = drawn.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why,
            "front_left and front_right look exchanged: each sits where the other should be (422 mm and 0 deg "
            "from nominal).");
  EXPECT_EQ(verdict.what_to_do, "Exchange their folders, or their names in session.yaml, then `rigcal push FOLDER`.");
}

// They are drawn at places that no sign makes each other's.
TEST(Exchanged, TwoLidarsExplainWhyTheirCloudsDoNotMatch) {
  Drawn drawn = WithReference(SensorKind::kCamera);
  const Se3 up = At({0.2, 0, 1.5}), down = At({0.2, 0, 0.3}, 90 * kDegree);
  drawn.Add("lidar_up", SensorKind::kLidar, up, down);
  drawn.Add("lidar_down", SensorKind::kLidar, down, up);
  drawn.visit.AddFailed("lidar_up", "lidar_down", "lidar_lidar", "low_overlap");
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, CauseKind::kExchanged);
  EXPECT_THAT(causes[0].edges, SizeIs(1));
  EXPECT_THAT(causes[0].said.why, HasSubstr("(1200 mm and 90 deg from nominal)"));
}

// Boards that were tilted one way only leave a direction of each open, a turn together with a shift; the turns by which
// they are exchanged are measured all the same.
TEST(Exchanged, TwoLidarsThatAreKnownInPart) {
  const Vector6d open_of_up = (Vector6d() << -2.8, 0.3, -0.4, 0.16, 1, -0.44).finished(),
                 open_of_down = (Vector6d() << -0.24, 0.52, 3.4, -0.4, 1, -0.16).finished();
  for (const double held : {0.0, 0.03, -0.3}) {
    Drawn drawn = WithReference(SensorKind::kCamera);
    drawn.Add("back", SensorKind::kCamera, kRear, kRear);
    const Se3 up = At({0.2, 0, 1.5}), down = At({0.25, 0, 1.3}, 90 * kDegree);
    drawn.Add("lidar_up", SensorKind::kLidar, up, down * At({0.03, 0.02, 0}));
    drawn.LeaveOpen(open_of_up, held);
    drawn.Add("lidar_down", SensorKind::kLidar, down, up * At({0, 0.02, 0.04}));
    drawn.LeaveOpen(open_of_down, -held);
    drawn.visit.AddFailed("lidar_up", "lidar_down", "lidar_lidar", "poor_fit");
    const std::vector<RootCause> causes = drawn.Causes();
    ASSERT_THAT(causes, SizeIs(1)) << held;
    EXPECT_EQ(causes[0].kind, CauseKind::kExchanged);
    EXPECT_THAT(causes[0].edges, SizeIs(1));
    const Verdict verdict = drawn.Judge();
    EXPECT_EQ(verdict.level, VerdictLevel::kFail);
    EXPECT_THAT(verdict.why,
                StartsWith("lidar_up and lidar_down look exchanged: each sits where the other should be ("));
    EXPECT_THAT(verdict.why, HasSubstr(" from nominal, by what was measured of it)"));
    EXPECT_EQ(verdict.what_to_do, "Exchange their folders, or their names in session.yaml, then `rigcal push FOLDER`.");
  }
}

// Each is where it is drawn in all that was measured; what it holds along the rest is the other's place.
TEST(Exchanged, WhatWasNotMeasuredAccusesNobody) {
  Drawn drawn = WithReference();
  drawn.Add("front_left", SensorKind::kCamera, kLeft, kLeft);
  drawn.LeaveOpen(Vector6d::Unit(tangent::kY), -0.422);
  drawn.Add("front_right", SensorKind::kCamera, kRight, kRight);
  drawn.LeaveOpen(Vector6d::Unit(tangent::kY), 0.422);
  drawn.Add("mast", SensorKind::kLidar, kMast, kMast);
  EXPECT_THAT(drawn.Causes(), SizeIs(0));
}

// Only along what nobody measured would it be seen that the mast is not mirrored: so it bears nothing out.
TEST(DrawnWrong, WhatWasNotMeasuredBearsNothingOut) {
  Drawn drawn = WithReference();
  drawn.Add("front_left", SensorKind::kCamera, kRight, kLeft);
  drawn.Add("front_right", SensorKind::kCamera, kLeft, kRight);
  drawn.Add("mast", SensorKind::kLidar, kMast, kMast);
  ASSERT_EQ(drawn.Causes().at(0).kind, CauseKind::kExchanged);
  drawn.LeaveOpen(Vector6d::Unit(tangent::kY));
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, CauseKind::kFarFromNominal);
  EXPECT_EQ(drawn.Judge().unverified, "front_left, front_right and mast");
}

// Measured from a camera that is in truth the other one, all others are elsewhere.
TEST(Exchanged, TheReferenceAndAnotherCamera) {
  const Se3 left = At({0, 0.3, 0}, 20 * kDegree), top = At({0.1, 0.1, 0.6});
  const Se3 from_left = left.Inverse();
  Drawn drawn = WithReference(SensorKind::kCamera);
  drawn.Add("left", SensorKind::kCamera, left, from_left);
  drawn.Add("top", SensorKind::kLidar, top, from_left * top);
  drawn.Add("rear", SensorKind::kCamera, kRear, from_left * kRear);
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_THAT(causes[0].sensors, ElementsAre(SensorId("base"), SensorId("left")));
  EXPECT_THAT(causes[0].said.what_to_do, StartsWith("Exchange their folders"));
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kFail);
}

TEST(Exchanged, ACameraIsNeverTakenForALidar) {
  Drawn drawn = WithReference();
  const Se3 left = At({1, 0.4, 0.5}), right = At({1, -0.4, 0.5});
  drawn.Add("front", SensorKind::kCamera, left, right);
  drawn.Add("low", SensorKind::kLidar, right, left);
  drawn.Add("mast", SensorKind::kLidar, kMast, kMast);
  const std::vector<RootCause> causes = drawn.Causes();
  ASSERT_THAT(causes, SizeIs(1));
  EXPECT_EQ(causes[0].kind, CauseKind::kFarFromNominal);
  EXPECT_THAT(causes[0].said.why, HasSubstr("do not sit at their nominal (CAD) poses"));
}

// Of two cameras, an exchange and a wrong drawing are the same numbers.
TEST(DrawnWrong, ASignOfTwoCameras) {
  Drawn drawn = WithReference(SensorKind::kCamera);
  drawn.Add("right", SensorKind::kCamera, At({-0.12, 0, 0}), At({0.12, 0.001, 0}));
  ExpectDoubt(drawn, "base", "right", "240 mm and 0 deg");
}

TEST(DrawnWrong, TheDirectionOfTwoCameras) {
  const Se3 found = At({0.12, 0.02, 0.01}, 25 * kDegree);
  Drawn drawn = WithReference(SensorKind::kCamera);
  drawn.Add("right", SensorKind::kCamera, found.Inverse(), found);
  ExpectDoubt(drawn, "base", "right", "238 mm and 50 deg");
}

// Where left is drawn at the right, the lidar between the two and what is half-way tell nothing.
TEST(DrawnWrong, MirroredCamerasBesideTheReference) {
  Drawn drawn = WithReference();
  drawn.Add("front_left", SensorKind::kCamera, kRight, kLeft);
  drawn.Add("front_right", SensorKind::kCamera, kLeft, kRight);
  drawn.Add("rear", SensorKind::kCamera, kRear, At({-1, 0.01, 0.5}, M_PI));
  ExpectDoubt(drawn, "front_left", "front_right", "422 mm and 0 deg");
}

TEST(DrawnWrong, MirroredCamerasThatAreTurnedApart) {
  const Se3 left = At({0.4, 0.2, 0}, 40 * kDegree), right = At({0.4, -0.2, 0}, -40 * kDegree);
  Drawn drawn = WithReference();
  drawn.Add("left", SensorKind::kCamera, right, left);
  drawn.Add("right", SensorKind::kCamera, left, right);
  ExpectDoubt(drawn, "left", "right", "400 mm and 80 deg");
}

// The mast is mirrored as well: no exchange of the two puts it there.
TEST(DrawnWrong, AMirroredDrawingOfMoreThanTwo) {
  Drawn drawn = WithReference();
  drawn.Add("front_left", SensorKind::kCamera, kRight, kLeft);
  drawn.Add("front_right", SensorKind::kCamera, kLeft, kRight);
  drawn.Add("mast", SensorKind::kLidar, At({0.3, -0.25, 1.2}), kMast);
  ExpectDoubt(drawn, "front_left", "front_right", "422 mm and 0 deg");
}

TEST(DrawnWrong, TheDirectionOfAllIsNoExchange) {
  const Se3 left = At({0, 0.3, 0}, 20 * kDegree), top = At({0.1, 0.3, 0.6});
  Drawn drawn = WithReference(SensorKind::kCamera);
  drawn.Add("left", SensorKind::kCamera, left.Inverse(), left);
  drawn.Add("top", SensorKind::kLidar, top.Inverse(), top);
  for (const RootCause& cause : drawn.Causes()) EXPECT_THAT(cause.said.why, HasSubstr("at their nominal (CAD) poses"));
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kWarn);
}

// A third camera half-way over two moved along: exchanged most likely, but a mirror does not tell.
TEST(Exchanged, InARigThatLooksTheSameMirroredNobodyIsToldToRename) {
  const Se3 right = At({0.2, 0, 0}), top = At({0.1, -0.15, 0});
  Drawn drawn = WithReference(SensorKind::kCamera);
  drawn.Add("right", SensorKind::kCamera, right, right.Inverse());
  drawn.Add("top", SensorKind::kCamera, top, right.Inverse() * top);
  const Verdict verdict = drawn.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why,
            "base and right look exchanged, or the nominal (CAD) poses are mirrored: each sits where the other should "
            "be (400 mm and "
            "0 deg from nominal).");
  EXPECT_EQ(verdict.what_to_do,
            "Open one file of base/: is it from base? No: exchange the names of the two folders. Yes: correct "
            "T_ref_nominal in session.yaml, then `rigcal push FOLDER`.");
}

// Where edges disagree around them the doubt is said first.
TEST(DrawnWrong, FailsOnlyWhereEdgesDisagreeAroundTheTwo) {
  Drawn drawn = WithReference(SensorKind::kCamera);
  drawn.Add("right", SensorKind::kCamera, At({-0.12, 0, 0}), At({0.12, 0, 0}));
  EXPECT_EQ(drawn.Judge().level, VerdictLevel::kUnknown);
  drawn.solution.residuals = {ResidualOf(drawn.visit.edges.front(), 0.5)};
  const Verdict verdict = drawn.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, StartsWith("base and right sit at each other's nominal (CAD) places"));
  EXPECT_THAT(verdict.why, HasSubstr("; also, base - right does not fit the other pairs"));
}

}  // namespace
}  // namespace rigcal::fleet
