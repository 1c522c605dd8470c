// How fast sensors go on moving, over visits that are drawn; and the sentence that tells what was found.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/unit/fleet/as_found_rig.h"

namespace rigcal::fleet {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::int64_t kDay_ns = 86'400'000'000'000;

AsFound FoundBeside(const SensorId& frame) {
  AsFound found;
  found.relative_to = frame;
  for (const SensorId& sensor : {kRear, kRight, kTop}) {
    found.sensors.emplace_back();
    found.sensors.back().sensor = sensor;
    found.sensors.back().state = FoundState::kUnchanged;
  }
  return found;
}

// The right camera creeps along its y by so much in 30 days, and about its z.
std::vector<VisitPoses> Creeping(const std::vector<int>& days, double m_per_30_days, double rad_per_30_days,
                                 Draws& draws) {
  std::vector<VisitPoses> visits;
  for (const int day : days) {
    Vector6d step = Vector6d::Zero();
    step(tangent::kY) = m_per_30_days * day / 30;
    step(tangent::kRz) = rad_per_30_days * day / 30;
    const AsFoundInput visit = Visit(DrawnRig(), Bumped(DrawnRig(), kRight, step), SomeErrors(), draws);
    visits.push_back({{1'700'000'000'000'000'000 + day * kDay_ns}, visit.session});
  }
  return visits;
}

KnownPoses NowWithScatter() {
  KnownPoses now = DrawnRig();
  for (KnownPose& pose : now.poses) pose.visit_variance.setConstant(1e-8);
  return now;
}

TEST(DriftRate, IsThatOfTheCreepWithinItsSigma) {
  Draws draws(1);
  double sum = 0.0, squares = 0.0;
  constexpr int kTimes = 400;
  for (int i = 0; i < kTimes; ++i) {
    AsFound found = FoundBeside(kLeft);
    AddDriftRates(Creeping({0, 4, 9, 15, 22, 27, 31, 38, 44, 47, 52, 60}, 3e-4, -2e-4, draws), NowWithScatter(), found);
    const DriftRate& rate = *Of(kRight, found).rate;
    const double z = (rate.per_30_days(tangent::kY) - 3e-4) / rate.sigma_per_30_days(tangent::kY);
    sum += z, squares += z * z;
    EXPECT_LT(std::abs(rate.per_30_days(tangent::kRz) + 2e-4), 6 * rate.sigma_per_30_days(tangent::kRz));
    EXPECT_EQ(rate.visits, 12);
    EXPECT_EQ(rate.last.ns - rate.first.ns, 60 * kDay_ns);
  }
  EXPECT_NEAR(sum / kTimes, 0.0, 0.25);
  EXPECT_NEAR(squares / kTimes, 10.0 / 8, 0.45);  // t of ten degrees of freedom
}

// Weekly visits of a rig of which one sensor creeps by `m_per_30_days`; how many of 400 say that it does, or that
// another does.
struct DriftsTold {
  int right = 0, another = 0;
};
DriftsTold Told(int visits, double m_per_30_days, const PoseLimit& least, unsigned seed) {
  Draws draws(seed);
  std::vector<int> days;
  for (int k = 0; k < visits; ++k) days.push_back(7 * k);
  DriftsTold told;
  for (int i = 0; i < 400; ++i) {
    AsFound found = FoundBeside(kLeft);
    found.alpha = 0.1;  // so that chance is counted: 1 % of sessions for rates
    found.tests = 18;
    for (SensorFound& sensor : found.sensors) sensor.axes.fill(FoundState::kUnchanged);
    AddDriftRates(Creeping(days, m_per_30_days, 0.0, draws), NowWithScatter(), found);
    told.right += DriftingOf(Of(kRight, found), found, least) ? 1 : 0;
    told.another += DriftingOf(Of(kRear, found), found, least) || DriftingOf(Of(kTop, found), found, least) ? 1 : 0;
  }
  return told;
}

TEST(Drifting, NobodyIsAccusedByChanceMoreOftenThanItsPartOfAlpha) {
  for (const int visits : {4, 6, 12, 26}) {
    const DriftsTold told = Told(visits, 0.0, {}, 20 + static_cast<unsigned>(visits));
    EXPECT_LE(told.right + told.another, 16) << visits << " visits";  // 4 on average; more has odds below 1e-6
  }
}

TEST(Drifting, OfADriftTheSensorIsNamed) {
  const DriftsTold told = Told(12, 1e-3, {}, 31);
  EXPECT_GE(told.right, 392);
  EXPECT_LE(told.another, 16);
}

TEST(Drifting, OneThatDoesNotMatterIsNotTold) { EXPECT_EQ(Told(12, 1e-3, {2e-3, 1.0}, 32).right, 0); }

TEST(Drifting, TheSmallestIsToldInNineteenOfTwenty) {
  Draws draws(33);
  AsFound found = FoundBeside(kLeft);
  found.tests = 18;
  for (SensorFound& sensor : found.sensors) sensor.axes.fill(FoundState::kUnchanged);
  found.sensors[1].rate = DriftRate{12, {0}, {kDay_ns}};
  std::mt19937 engine(34);
  std::normal_distribution<double> normal;
  std::chi_squared_distribution<double> chi_square(10);
  DriftRate& rate = *found.sensors[1].rate;
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    rate.per_30_days(0) = 1e-2, rate.sigma_per_30_days.head<3>().setConstant(1e-4 * std::sqrt(chi_square(engine) / 10));
    const Drifting drifting = *DriftingOf(found.sensors[1], found, {});
    rate.per_30_days(0) = drifting.smallest.m + 1e-4 * normal(engine);
    const auto told = DriftingOf(found.sensors[1], found, {});
    seen += told && told->per_30_days(0) > 0 ? 1 : 0;
  }
  EXPECT_NEAR(seen / 2000.0, 0.95, 0.02);
}

TEST(Drifting, TheSmallestIsAsLargeAsItsSigma) {
  AsFound found = FoundBeside(kLeft);
  found.tests = 18;
  for (SensorFound& sensor : found.sensors) sensor.axes.fill(FoundState::kUnchanged);
  found.sensors[1].rate = DriftRate{12, {0}, {kDay_ns}};
  found.sensors[1].rate->sigma_per_30_days << 1e-4, 1e-4, 1e-4, 2e-4, 2e-4, 2e-4;
  found.sensors[1].rate->per_30_days(0) = 1e-2;
  const Drifting drifting = *DriftingOf(found.sensors[1], found, {});
  EXPECT_NEAR(drifting.smallest.rad, 2 * drifting.smallest.m, 1e-9);
}

TEST(DriftRate, OfEqualVisitsItIsTheLineThroughThem) {
  std::vector<VisitPoses> visits;
  for (const int day : {0, 30, 60}) {
    Vector6d step = Vector6d::Zero();
    step(tangent::kX) = 1e-3 * day / 30;
    VisitPoses visit{{day * kDay_ns}, Bumped(DrawnRig(), kTop, step)};
    visit.poses.covariance = 1e-8 * Eigen::MatrixXd::Identity(18, 18);
    visits.push_back(visit);
  }
  AsFound found = FoundBeside(kLeft);
  AddDriftRates(visits, DrawnRig(), found);
  const DriftRate& rate = *Of(kTop, found).rate;
  EXPECT_NEAR(rate.per_30_days(tangent::kX), 1e-3, 1e-9);
  EXPECT_NEAR(rate.sigma_per_30_days(tangent::kX), 1e-4 / std::sqrt(2.0), 1e-9);  // spread of -1, 0, 1
  EXPECT_NEAR(Of(kRear, found).rate->per_30_days.norm(), 0.0, 1e-12);
}

TEST(DriftRate, NeedsThreeVisitsOfSeveralTimes) {
  Draws draws(2);
  AsFound found = FoundBeside(kLeft);
  AddDriftRates(Creeping({0, 30}, 0, 0, draws), NowWithScatter(), found);
  EXPECT_FALSE(Of(kRight, found).rate);
  AddDriftRates(Creeping({7, 7, 7}, 0, 0, draws), NowWithScatter(), found);
  EXPECT_FALSE(Of(kRight, found).rate);
  std::vector<VisitPoses> visits = Creeping({0, 10, 20}, 0, 0, draws);
  visits[1].poses.poses.pop_back();  // the lidar on top was not there
  visits[1].poses.covariance = Eigen::MatrixXd(visits[1].poses.covariance.topLeftCorner(12, 12));
  AddDriftRates(visits, NowWithScatter(), found);
  EXPECT_TRUE(Of(kRight, found).rate);
  EXPECT_FALSE(Of(kTop, found).rate);
}

AsFound OneMoved() {
  AsFound found = FoundBeside(kLeft);
  found.session = SessionId(std::string(64, 'a'));
  found.in_use = 2;
  found.visits = 5;
  for (SensorFound& sensor : found.sensors) {
    sensor.axes.fill(FoundState::kUnchanged);
    sensor.sigma << 1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4;
    sensor.smallest << 6e-4, 5e-4, 5e-4, 3e-4, 3e-4, 3.5e-4;
  }
  SensorFound& right = found.sensors[1];
  right.state = right.axes[0] = FoundState::kDrifted;
  right.change(0) = 1.2e-3;
  right.change(5) = 7e-4;
  return found;
}

std::string TextOf(const AsFound& found) {
  return AsFoundText(found, {{found.session, ParseIso("2026-11-03T00:00:00Z").value()}});
}

TEST(AsFoundText, TellsWhoMovedByHowMuchAndWhatCouldHaveBeenSeen) {
  EXPECT_EQ(TextOf(OneMoved()),
            "As found (session of 2026-11-03, against revision 2): rear and top unchanged; right moved 1.2 mm, 0.0401 "
            "deg (12 "
            "sigma); smallest change this session could have seen: 0.6 mm, 0.02 deg.");
}

TEST(AsFoundText, OfTwoNamesBothAndSaysWhatIsNotKnown) {
  AsFound found = OneMoved();
  found.sensors[1].or_else = kLeft;
  found.sensors[0].state = FoundState::kMovedOnPurpose;
  found.sensors[2].state = FoundState::kNew;
  found.visits = 1;
  const std::string text = TextOf(found);
  EXPECT_THAT(text, HasSubstr("right moved against left 1.2 mm, 0.0401 deg (12 sigma), either of the two may have; "));
  EXPECT_THAT(text, HasSubstr("rear moved on purpose; top new; "));
  EXPECT_THAT(text, HasSubstr("; with 1 visit in use the scatter from visit to visit is not known yet: the policy's "
                              "moved_min is taken for it."));
  EXPECT_THAT(text, Not(HasSubstr("unchanged")));
  found.visits = 2;
  EXPECT_THAT(TextOf(found), HasSubstr("with 2 visits in use the scatter from visit to visit is hardly known yet."));
}

TEST(AsFoundText, SaysWhyNothingWasTested) {
  AsFound found = OneMoved();
  found.in_use = 0;
  found.why_not = "No calibration was in use before it.";
  EXPECT_EQ(TextOf(found), "As found (session of 2026-11-03): not tested. No calibration was in use before it.");
  found = OneMoved();
  found.sensors[0].smallest(2) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(TextOf(found), HasSubstr("too few captures to tell the smallest change it could have seen"));
}

TEST(AsFoundText, NobodyIsUnchangedOfWhomNoChangeCouldBeTold) {
  AsFound found = OneMoved();
  found.sensors[0].smallest(2) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(TextOf(found), HasSubstr("): top unchanged; whether rear moved cannot be told; right moved 1.2 mm"));
  found.sensors[1] = found.sensors[2];
  EXPECT_EQ(StateOf(found), FoundState::kUnchanged) << "that top is, was told";
  for (SensorFound& sensor : found.sensors) sensor.smallest.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_THAT(TextOf(found), Not(HasSubstr("unchanged")));
  EXPECT_EQ(StateOf(found), FoundState::kNotMeasured);
}

SensorMovedBetween Elsewhere(const SensorId& sensor, double off_m) {
  SensorMovedBetween one{sensor, SessionId(std::string(64, 'a')), SessionId(std::string(64, 'b')), Vector6d::Zero(),
                         1e-9};
  one.step = off_m * Vector6d::Unit(tangent::kX);
  return one;
}

TEST(AsFoundText, NobodyIsUnchangedWhoSatElsewhereByTheFindings) {
  AsFound found = OneMoved();
  MarkElsewhere({Elsewhere(SensorId("rear"), 6e-3), Elsewhere(SensorId("rear"), 7.75e-3), Elsewhere(kRight, 9e-3)},
                found);
  EXPECT_EQ(found.sensors[0].state, FoundState::kNotToldApart);
  EXPECT_TRUE(IsMeasured(found.sensors[0], 0));
  EXPECT_EQ(found.sensors[1].state, FoundState::kDrifted) << "what drifted did";
  EXPECT_THAT(TextOf(found), HasSubstr("): top unchanged; rear not told apart from scatter: 7.75 mm; right moved "));
  found.sensors[1] = found.sensors[2];
  EXPECT_EQ(StateOf(found), FoundState::kNotMeasured);
}

TEST(AsFoundText, NobodyIsUnchangedAsSeenFromOneThatSatElsewhere) {
  AsFound found = OneMoved();
  found.relative_to = kLeft;
  MarkElsewhere({Elsewhere(kLeft, 7.75e-3)}, found);
  EXPECT_THAT(TextOf(found), HasSubstr("): left not told apart from scatter: 7.75 mm, and so rear and top, which are "
                                       "seen from it; right moved "));
}

}  // namespace
}  // namespace rigcal::fleet
