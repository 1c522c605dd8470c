#include "tests/bench/fleet/drawn_fleet.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "server/fleet/population/scatter_pool.h"
#include "tests/bench/fleet/robot_history.h"

namespace rigcal::drawn_fleet {
namespace {

constexpr std::int64_t kWeek_ns = 7LL * 86'400'000'000'000;
constexpr int kSettledWeeks = 9;  // in which nothing happens to a new robot
// Of drifts, in 30 days.
constexpr std::array<double, 3> kRates_m = {3e-4, 1e-3, 3e-3};
constexpr double kRateInSigmas = 4.0;

enum class Fate { kBumped, kBumpedMore, kSwapped, kDrifts, kNone };
Fate FateOf(int robot) {
  const int of_ten = robot % 10;
  return of_ten > 3 ? Fate::kNone : static_cast<Fate>(of_ten);
}

std::string SessionName(int robot, int week) {
  char name[65];
  std::snprintf(name, sizeof name, "%032x%032x", static_cast<unsigned>(robot), static_cast<unsigned>(week));
  return name;
}

std::string Times(double times) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f", times);
  return text;
}

Vector6d Along(int axis, double step) {
  Vector6d along = Vector6d::Zero();
  along(axis) = step;
  return along;
}

const SensorFound* Find(const SensorId& sensor, const AsFound& found) {
  for (const SensorFound& one : found.sensors)
    if (one.sensor == sensor) return &one;
  return nullptr;
}

// The sensor and axis along which something happens to it.
struct Where {
  std::size_t sensor = 0;
  int axis = 0;
  double sign = 1.0;
  [[nodiscard]] const SensorId& Name() const { return Names()[sensor]; }
};
Where DrawnWhere(Draws& draws) {
  std::size_t sensor = static_cast<std::size_t>(draws.Below(kSensors - 1));
  if (sensor >= kReference) ++sensor;
  return {sensor, draws.Below(6), draws.Below(2) == 0 ? 1.0 : -1.0};
}

class DrawnRobot {
 public:
  DrawnRobot(const FleetPlan& plan, int number)
      : plan_(plan),
        number_(number),
        joins_(number * (plan.weeks / 4) / plan.robots),
        places_(Mounted()),
        draws_(plan.seed, static_cast<unsigned>(number)),
        beside_(plan.seed + 1'000'000, static_cast<unsigned>(number)),
        history_(RobotId("robot-" + std::to_string(number)), Names()[kReference]),
        where_(DrawnWhere(draws_)) {
    const int first = joins_ + kSettledWeeks, last = plan.weeks - 4;
    happens_ = fate_ == Fate::kDrifts ? first : first + draws_.Below(std::max(1, last - first));
  }

  void Know(const PooledScatter& pooled) { history_.Know(pooled); }
  [[nodiscard]] const fleet::RobotScatter& OwnScatter() const { return history_.OwnScatter(); }
  void Visit(int week, FleetTally& tally) {
    if (week < joins_) return;
    const VisitDraw draw = draws_.Visit(places_, plan_.sizes);
    SessionId session(SessionName(number_, week));
    SessionEstimate estimate = Estimate(places_, draw, session);
    if (history_.HasRevision()) {
      if (fate_ == Fate::kDrifts && week >= happens_ && !repaired_)
        estimate = Drift(week, draw, session, tally);
      else if (fate_ == Fate::kSwapped && week == happens_)
        estimate = Swap(draw, session, tally);
      else if (week == happens_ && (fate_ == Fate::kBumped || fate_ == Fate::kBumpedMore))
        estimate = Bump(draw, session, tally);
      else if (missed_)
        TestMissed(estimate, tally);
      else
        CountQuiet(estimate, tally);
    }
    history_.Take(std::move(estimate), At(week));
    if (week < happens_ || fate_ == Fate::kNone) CountToldMoved(tally);
  }

 private:
  [[nodiscard]] SessionEstimate Estimate(const Places& places, const VisitDraw& draw, const SessionId& session) const {
    return EstimateOf(places, draw, plan_.sizes, session);
  }
  [[nodiscard]] Places Moved(const Where& where, double step) const {
    Places places = places_;
    places[where.sensor] = Stepped(places[where.sensor], Along(where.axis, step));
    return places;
  }
  static Stamp At(int week) { return {1'800'000'000'000'000'000 + week * kWeek_ns}; }

  void CountQuiet(const SessionEstimate& estimate, FleetTally& tally) {
    CountOneQuiet(history_.Test(estimate), tally);
    for (int i = 0; i < plan_.beside; ++i) {
      const VisitDraw draw = beside_.Visit(places_, plan_.sizes);
      const AsFound nothing = history_.Test(Estimate(places_, draw, estimate.session));
      CountOneQuiet(nothing, tally);
      const Where where = DrawnWhere(beside_);
      for (const double times : {1.0, 1.2})
        CountEvent(draw, where, times, nothing, tally.events[Times(times)][nothing.visits]);
    }
  }
  void CountToldMoved(FleetTally& tally) const {
    if (history_.Visits() < 2) return;
    const auto count = [&](std::map<int, Quiet>& by_visits, bool is_told) {
      Quiet& revisions = by_visits[history_.Visits()];
      ++revisions.sessions;
      revisions.accused += is_told ? 1 : 0;
    };
    count(tally.told_moved, history_.SaysMoved());
    count(tally.told_apart, history_.WarnsOfApart());
    count(tally.remarks_apart, history_.RemarksOnApart());
  }
  static void CountOneQuiet(const AsFound& found, FleetTally& tally) {
    Quiet& quiet = tally.quiet[found.visits];
    ++quiet.sessions;
    quiet.accused += IsAccused(found) ? 1 : 0;
  }
  // The same session had the sensor been moved before by so many times the smallest change that it tells. What it tells
  // as the smallest does not depend on what it finds. Nothing where it is told against another sensor, or a change of
  // any size may stay unseen.
  std::optional<double> CountEvent(const VisitDraw& draw, const Where& where, double times, const AsFound& nothing,
                                   Events& events) {
    const SensorFound* told = Find(where.Name(), nothing);
    if (nothing.relative_to != Names()[kReference] || told == nullptr) return std::nullopt;
    const double step = where.sign * times * told->smallest(where.axis);
    if (!std::isfinite(step)) return std::nullopt;  // none would be told
    Count(history_.Test(Estimate(Moved(where, step), draw, SessionId("beside"))), where.Name(), where.axis, step,
          events);
    return step;
  }

  SessionEstimate Bump(const VisitDraw& draw, const SessionId& session, FleetTally& tally) {
    const double times = fate_ == Fate::kBumped ? 1.0 : 1.2;
    const AsFound nothing = history_.Test(Estimate(places_, draw, session));
    const auto step = CountEvent(draw, where_, times, nothing, tally.bumps[Times(times)]);
    if (step) places_ = Moved(where_, *step);
    SessionEstimate estimate = Estimate(places_, draw, session);
    missed_ = step && !IsAccused(history_.Test(estimate));
    tally.missed += missed_ ? 1 : 0;
    if (!missed_) history_.BeginEpoch(where_.Name());  // who reads it looks, and says so
    return estimate;
  }
  void TestMissed(const SessionEstimate& estimate, FleetTally& tally) {
    if (!IsAccused(history_.Test(estimate))) return;
    missed_ = false;
    ++tally.missed_later;
    history_.BeginEpoch(where_.Name());
  }
  SessionEstimate Swap(const VisitDraw& draw, const SessionId& session, FleetTally& tally) {
    places_ = Moved(where_, where_.sign * (where_.axis < 3 ? 0.01 : 0.03));
    SessionEstimate estimate = Estimate(places_, draw, session);
    const AsFound found = history_.Test(estimate, {where_.Name()});
    const SensorFound* told = Find(where_.Name(), found);
    ++tally.swaps;
    tally.swaps_told += told != nullptr && told->state == FoundState::kMovedOnPurpose ? 1 : 0;
    tally.swaps_accused += IsAccused(found) ? 1 : 0;
    history_.BeginEpoch(where_.Name());
    return estimate;
  }
  SessionEstimate Drift(int week, const VisitDraw& draw, const SessionId& session, FleetTally& tally) {
    const double rate_m = kRates_m[static_cast<std::size_t>(number_ / 10) % kRates_m.size()];
    const Where where{where_.sensor, where_.axis % 3, where_.sign};
    Drifts& drifts = tally.drifts[Times(1e3 * rate_m)];
    if (week == happens_) ++drifts.robots;
    places_ = Moved(where, where.sign * rate_m * 7 / 30);
    SessionEstimate estimate = Estimate(places_, draw, session);
    AsFound found = history_.Test(estimate);
    const int weeks = week - happens_ + 1;
    CountRate(where, weeks, found, drifts);
    if (!IsAccused(found)) return estimate;
    const SensorFound* told = Find(where.Name(), found);
    if (told != nullptr && told->state == FoundState::kDrifted)
      drifts.weeks.push_back(weeks);
    else
      ++drifts.wrong;
    repaired_ = true;
    history_.BeginEpoch(where.Name());
    return estimate;
  }
  void CountRate(const Where& where, int weeks, AsFound& found, Drifts& drifts) {
    history_.AddRates(found);
    const SensorFound* told = Find(where.Name(), found);
    if (rate_told_ || told == nullptr || !told->rate) return;
    if (std::abs(told->rate->per_30_days(where.axis)) < kRateInSigmas * told->rate->sigma_per_30_days(where.axis))
      return;
    rate_told_ = true;
    drifts.weeks_until_rate.push_back(weeks);
  }

  const FleetPlan& plan_;
  int number_, joins_, happens_ = 0;
  Places places_;
  Draws draws_, beside_;
  RobotHistory history_;
  Where where_;
  Fate fate_ = FateOf(number_);
  bool missed_ = false, repaired_ = false, rate_told_ = false;
};

// Of server/pipeline/rig_models/pooled_scatter.cc: so many others are read.
constexpr std::size_t kPooledRobotsMax = 200;

PooledScatter PoolFor(std::size_t robot, const std::vector<DrawnRobot>& robots) {
  std::vector<fleet::RobotScatter> others;
  for (std::size_t i = 0; i < robots.size() && others.size() < kPooledRobotsMax; ++i)
    if (i != robot && !robots[i].OwnScatter().empty()) others.push_back(robots[i].OwnScatter());
  return fleet::PoolScatter(others);
}

// As of the week before.
void LetThemKnow(std::vector<DrawnRobot>& robots) {
  for (std::size_t i = 0; i < robots.size(); ++i) robots[i].Know(PoolFor(i, robots));
}

}  // namespace

FleetTally RunFleet(const FleetPlan& plan) {
  FleetTally tally;
  std::vector<DrawnRobot> robots;
  for (int number = 0; number < plan.robots; ++number) robots.emplace_back(plan, number);
  for (int week = 0; week < plan.weeks; ++week) {
    if (!plan.alone) LetThemKnow(robots);
    for (DrawnRobot& robot : robots) robot.Visit(week, tally);
  }
  return tally;
}

}  // namespace rigcal::drawn_fleet
