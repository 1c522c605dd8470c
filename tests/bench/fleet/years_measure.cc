// Years of weekly visits of robots one sensor of which does not stay where it was: does the region that each revision
// tells hold where the sensors sit on the next visit? Prints one JSON object.
// usage: years_measure ROBOTS WEEKS SEED SCATTER_MM CREEP_MM SEASON_MM WALK_MM [EVERY_WEEKS]
//
// A visit every EVERY_WEEKS (1). Every sensor scatters by SCATTER_MM per axis from visit to visit. One sensor of each
// robot goes along a direction and turns about another besides: by CREEP_MM in 30 days; to and fro by SEASON_MM in the
// course of a year; by a step of WALK_MM per axis from each visit to the next. Of each mm it turns by kTurn_rad_per_m.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "server/math/statistics.h"
#include "tests/bench/fleet/drawn_robot.h"
#include "tests/bench/fleet/robot_history.h"

namespace rigcal::drawn_fleet {
namespace {

constexpr std::int64_t kWeek_ns = 7LL * 86'400'000'000'000;
constexpr double kTurn_rad_per_m = 0.6, kWeeksOfYear = 365.25 / 7, kTwoPi = 6.283185307179586;
constexpr std::size_t kMoving = 3;
constexpr int kFirstVisit = 4, kLateVisit = 10;  // that are counted: those up to the tenth apart

struct YearsPlan {
  int robots = 0, weeks = 0;
  unsigned seed = 0;
  int every_weeks = 1;
  double scatter_m = 0.0, creep_m_per_week = 0.0, season_m = 0.0, walk_m = 0.0;
};

double LimitOf(double dof) {
  return dof > 0 ? HotellingLimit(static_cast<int>(dof + 1e-6) + 1) : ChiSquareQuantile(0.95, 6);
}

// Of one sensor, or of several.
struct Regions {
  int count = 0, inside = 0;
  int endless = 0;                                // besides: too few degrees of freedom for a region
  double t2 = 0.0, error_m = 0.0, sigma_m = 0.0;  // sums

  void Add(const Vector6d& e, const fleet::KnownPose& told, const Matrix6d& C) {
    const double squares = e.dot(C.ldlt().solve(e)), limit = LimitOf(told.dof);
    if (!std::isfinite(limit)) ++endless;
    if (!std::isfinite(limit)) return;
    ++count;
    inside += squares <= limit ? 1 : 0;
    t2 += squares;
    error_m += e.head<3>().norm();
    sigma_m += std::sqrt(C.topLeftCorner<3, 3>().trace());
  }
};

struct Tally {
  Regions moving, others, early;  // of revisions that do not say that anybody was moved; early: of up to ten visits
  int revisions = 0, said_moved = 0, warned_apart = 0, rate_told = 0;
};

// T_told^-1 T_true in the sensor's axes, m and rad.
Vector6d ErrorOf(const Se3& told, const Eigen::Isometry3d& true_pose) {
  const Eigen::AngleAxisd turn(told.q.toRotationMatrix().transpose() * true_pose.rotation());
  Vector6d e;
  e << told.q.toRotationMatrix().transpose() * (true_pose.translation() - told.p_m), turn.angle() * turn.axis();
  return e;
}

class AgeingRobot {
 public:
  AgeingRobot(const YearsPlan& plan, int number)
      : plan_(plan),
        number_(number),
        draws_(plan.seed, static_cast<unsigned>(number)),
        engine_(plan.seed + 7'000'000 + static_cast<unsigned>(number)),
        history_(RobotId("robot-" + std::to_string(number)), Names()[kReference]) {
    sizes_.scatter_m = plan.scatter_m;
    sizes_.scatter_rad = plan.scatter_m * kTurn_rad_per_m;
    along_ << Direction(), kTurn_rad_per_m * Direction();
  }

  void Live(Tally& tally) {
    for (int visit = 0; visit * plan_.every_weeks < plan_.weeks; ++visit) {
      const int week = visit * plan_.every_weeks;
      const Places places = PlacesIn(week);
      const VisitDraw draw = draws_.Visit(places, sizes_);
      char name[65];
      std::snprintf(name, sizeof name, "%032x%032x", static_cast<unsigned>(number_), static_cast<unsigned>(week));
      const SessionEstimate estimate = EstimateOf(places, draw, sizes_, SessionId(name));
      if (visit >= kFirstVisit) Count(visit >= kLateVisit, places, draw, estimate, tally);
      history_.Take(estimate, {1'800'000'000'000'000'000 + week * kWeek_ns});
    }
  }

 private:
  Eigen::Vector3d Normal3() { return {normal_(engine_), normal_(engine_), normal_(engine_)}; }
  Eigen::Vector3d Direction() { return Normal3().normalized(); }

  Places PlacesIn(int week) {
    Vector6d step;
    step << Normal3(), kTurn_rad_per_m * Normal3();
    walked_ += plan_.walk_m * step;
    const double along_m =
        plan_.creep_m_per_week * week + plan_.season_m * std::sin(kTwoPi * (week / kWeeksOfYear + 0.1 * number_));
    Places places = Mounted();
    places[kMoving] = Stepped(places[kMoving], along_m * along_ + walked_);
    return places;
  }

  void Count(bool is_late, const Places& places, const VisitDraw& draw, const SessionEstimate& estimate, Tally& tally) {
    ++tally.revisions;
    tally.said_moved += history_.SaysMoved() ? 1 : 0;
    tally.warned_apart += history_.WarnsOfApart() ? 1 : 0;
    AsFound found = history_.Test(estimate);
    history_.AddRates(found);
    for (const SensorFound& one : found.sensors)
      if (one.sensor == Names()[kMoving] && one.rate)
        tally.rate_told +=
            (one.rate->per_30_days.array().abs() > 4 * one.rate->sigma_per_30_days.array()).any() ? 1 : 0;
    if (history_.SaysMoved()) return;
    const fleet::KnownPoses& told = history_.Newest();
    const Eigen::Isometry3d reference = Stepped(places[kReference], draw.scatter[kReference]);
    Eigen::Index row = 0;
    for (const fleet::KnownPose& pose : told.poses) {
      if (pose.sensor == Names()[kReference]) continue;
      for (std::size_t s = 0; s < kSensors; ++s)
        if (Names()[s] == pose.sensor)
          (!is_late       ? tally.early
           : s == kMoving ? tally.moving
                          : tally.others)
              .Add(ErrorOf(pose.T_ref_sensor, reference.inverse() * Stepped(places[s], draw.scatter[s])), pose,
                   told.covariance.block<6, 6>(row, row));
      row += 6;
    }
  }

  const YearsPlan& plan_;
  int number_;
  Sizes sizes_;
  Draws draws_;
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
  Vector6d along_, walked_ = Vector6d::Zero();
  RobotHistory history_;
};

bool Read(int count, char** arguments, YearsPlan& plan) {
  if (count != 8 && count != 9) return false;
  plan.robots = std::atoi(arguments[1]);
  plan.weeks = std::atoi(arguments[2]);
  plan.seed = static_cast<unsigned>(std::atoi(arguments[3]));
  plan.scatter_m = 1e-3 * std::atof(arguments[4]);
  plan.creep_m_per_week = 1e-3 * std::atof(arguments[5]) * 7 / 30;
  plan.season_m = 1e-3 * std::atof(arguments[6]);
  plan.walk_m = 1e-3 * std::atof(arguments[7]);
  if (count == 9) plan.every_weeks = std::atoi(arguments[8]);
  return plan.robots > 0 && plan.robots <= 10'000 && plan.every_weeks > 0 &&
         plan.weeks > kLateVisit * plan.every_weeks && plan.weeks <= 5200;
}

void Print(const char* name, const Regions& regions, const char* end) {
  const double count = std::max(1, regions.count);
  std::printf(
      "\"%s\": {\"count\": %d, \"inside\": %d, \"endless\": %d, \"mean_t2\": %.3f, \"error_mm\": %.4f, \"sigma_mm\": "
      "%.4f}%s",
      name, regions.count, regions.inside, regions.endless, regions.t2 / count, 1e3 * regions.error_m / count,
      1e3 * regions.sigma_m / count, end);
}

int Run(int count, char** arguments) {
  YearsPlan plan;
  if (!Read(count, arguments, plan)) {
    std::fprintf(stderr,
                 "usage: years_measure ROBOTS WEEKS SEED SCATTER_MM CREEP_MM SEASON_MM WALK_MM [EVERY_WEEKS]\n");
    return 2;
  }
  const auto began = std::chrono::steady_clock::now();
  Tally tally;
  for (int number = 0; number < plan.robots; ++number) AgeingRobot(plan, number).Live(tally);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("{\"took_s\": %.3f, \"revisions\": %d, \"said_moved\": %d, \"warned_apart\": %d, \"rate_told\": %d, ",
              took.count(), tally.revisions, tally.said_moved, tally.warned_apart, tally.rate_told);
  Print("moving", tally.moving, ", ");
  Print("early", tally.early, ", ");
  Print("others", tally.others, "}\n");
  return 0;
}

}  // namespace
}  // namespace rigcal::drawn_fleet

int main(int count, char** arguments) { return rigcal::drawn_fleet::Run(count, arguments); }
