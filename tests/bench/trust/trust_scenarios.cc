#include "tests/bench/trust/trust_scenarios.h"

#include <array>
#include <cmath>

#include "client/sim/rig/random.h"

namespace rigcal {
namespace {

constexpr double kRadPerDeg = M_PI / 180;
constexpr std::array kSensors = {"front_left",  "front_right",    "left_front",       "left_back",
                                 "right_front", "right_back",     "up_left",          "up_right",
                                 "back",        "lidar_vertical", "lidar_horizontal", "body"};
constexpr std::array kRatios = {0.25, 0.5, 0.75};
constexpr int kShiftedOf = 30;  // captures
constexpr int kLateOf = 40;     // captures
constexpr int kVisits = 10, kNextVisits = 20;

HostileVisit Plain(int idx) {
  HostileVisit visit;
  visit.options.seed = static_cast<std::uint64_t>(idx);
  return visit;
}

// Every sensor with every ratio in 36; the first few are of every kind.
HostileVisit Bumped(int idx, double m, double deg) {
  HostileVisit visit = Plain(idx);
  const int at = idx - 1;
  visit.options.bump = SensorId(kSensors[static_cast<std::size_t>(5 * at % 12)]);
  visit.options.bump_m = m;
  visit.options.bump_rad = deg * kRadPerDeg;
  visit.options.bump_at_ratio = kRatios[static_cast<std::size_t>((at + at / 12) % 3)];
  return visit;
}

// Before the last `after` captures: one sensor after the other.
HostileVisit BumpedLate(int idx, int after, int burst) {
  HostileVisit visit = Plain(idx);
  visit.options.captures = kLateOf;
  visit.options.disturb.burst = burst;
  visit.options.bump = SensorId(kSensors[static_cast<std::size_t>(5 * (idx - 1) % 12)]);
  visit.options.bump_m = 0.01;
  visit.options.bump_rad = 1 * kRadPerDeg;
  visit.options.bump_at_ratio = 1 - (after - 0.5) / kLateOf;
  return visit;
}

// One of the robot's only two sensors.
HostileVisit PairBumped(int idx, double m, double deg) {
  HostileVisit visit = Plain(idx);
  visit.two_cameras = true;
  visit.options.bump = SensorId(idx % 2 == 1 ? "front_left" : "front_right");
  visit.options.bump_m = m;
  visit.options.bump_rad = deg * kRadPerDeg;
  return visit;
}

// Of a camera and another sensor that are all the robot has.
HostileVisit CameraPairBumped(int idx, const SensorId& other) {
  HostileVisit visit = PairBumped(idx, 0.012, 1);
  visit.two_cameras = false;
  visit.only = {SensorId("front_left"), other};
  visit.options.bump = visit.only[static_cast<std::size_t>(idx % 2)];
  return visit;
}

HostileVisit BoardMoved(int idx, bool no_tracker) {
  HostileVisit visit = Plain(idx);
  visit.options.disturb.board_move = sim::BoardMove{{0.005, 0.5 * kRadPerDeg}, 0.5, {}};
  visit.no_tracker = no_tracker;
  return visit;
}

HostileVisit Bent(int idx, double px, sim::IntrinsicsKind intrinsics) {
  HostileVisit visit = Plain(idx);
  visit.options.disturb.lens_misfit_px = px;
  visit.options.intrinsics = intrinsics;
  return visit;
}

HostileVisit Stretched(int idx, double ratio) {
  HostileVisit visit = Plain(idx);
  visit.options.disturb.board_stretch_ratio = ratio;
  return visit;
}

HostileVisit Shifted(int idx, double px, bool two_cameras) {
  HostileVisit visit = Plain(idx);
  visit.options.captures = kShiftedOf;
  visit.two_cameras = two_cameras;
  if (px > 0) visit.options.disturb.capture_shift = sim::CaptureShift{px, {}};
  return visit;
}

// Robots do not share visits.
HostileVisit Scattered(int idx, bool two_cameras) {
  HostileVisit visit = Plain(1 + (idx - 1) * (kVisits + kNextVisits));
  visit.options.disturb.visit_scatter = {3e-4, 0.01 * kRadPerDeg};
  visit.two_cameras = two_cameras;
  visit.visits = kVisits;
  visit.next_visits = kNextVisits;
  return visit;
}

HostileVisit Bursts(int idx, int captures, int burst) {
  HostileVisit visit = Plain(idx);
  visit.options.captures = captures;
  visit.options.disturb.burst = burst;
  return visit;
}

// The robot does not stop for its captures; the tracker's clock is off by up to 40 ms.
HostileVisit Swaying(int idx, bool clock_is_off) {
  HostileVisit visit = Plain(idx);
  visit.options.disturb.sway_per_s = {0.2, 10 * kRadPerDeg};
  sim::Random random(sim::KeyOf(visit.options.seed, "clock offset"));
  visit.options.disturb.pose_clock_late_s = clock_is_off ? random.Uniform(-0.04, 0.04) : 0.0;
  return visit;
}

HostileVisit WithBound(int idx) {
  HostileVisit visit = Plain(idx);
  visit.bound = true;
  return visit;
}

HostileVisit WithFoundPlates(int idx) {
  HostileVisit visit = Plain(idx);
  visit.found_plates = true;
  return visit;
}

template <typename Change>
TrustScenario Changed(const std::string& name, const Change& change) {
  return {name, [change](int idx) {
            HostileVisit visit = Plain(idx);
            change(visit);
            return visit;
          }};
}

// Printed wrong, or what looks like it: lenses given with a wrong fx.
void AddWrongPrints(std::vector<TrustScenario>& all) {
  for (const auto& [percent, ratio] : {std::pair{"0.1_percent", 0.001}, {"0.3_percent", 0.003}}) {
    const std::string name = std::string("stretched_boards_") + percent;
    all.push_back({name, [ratio = ratio](int idx) { return Stretched(idx, ratio); }});
    all.push_back({"no_tracker_" + name, [ratio = ratio](int idx) {
                     HostileVisit visit = Stretched(idx, ratio);
                     visit.no_tracker = true;
                     return visit;
                   }});
    all.push_back({"pair_" + name, [ratio = ratio](int idx) {
                     HostileVisit visit = Stretched(idx, ratio);
                     visit.two_cameras = true;
                     return visit;
                   }});
  }
  for (const bool two : {false, true})
    all.push_back(Changed(two ? "pair_wrong_aspect_0.1_percent" : "wrong_aspect_0.1_percent", [two](HostileVisit& v) {
      v.options.intrinsics = sim::IntrinsicsKind::kExact;
      v.aspect_ratio = 0.001;
      v.two_cameras = two;
    }));
}

// Mounts that give way for a while, more and more, or at every capture; a tracker that drifts.
void AddLooseMounts(std::vector<TrustScenario>& all) {
  constexpr sim::Displacement kLarge{0.02, 2 * kRadPerDeg}, kSmall{0.005, 0.5 * kRadPerDeg};
  for (const auto& [name, by] : {std::pair{"excursion_20_mm", kLarge}, {"excursion_5_mm", kSmall}})
    all.push_back(Changed(name, [by = by](HostileVisit& v) { v.options.disturb.excursion = {by, 0.5, 0.7, {}}; }));
  all.push_back(Changed("creep_5_mm", [kSmall](HostileVisit& v) { v.options.disturb.creep = {kSmall, {}}; }));
  all.push_back(Changed("rattle", [](HostileVisit& v) { v.options.disturb.rattle = {5e-4, 0.03 * kRadPerDeg}; }));
  all.push_back(Changed("rattle_0.1_mm", [](HostileVisit& v) {
    v.options.disturb.rattle = {1e-4, 0.006 * kRadPerDeg};
  }));
  all.push_back(Changed("tracker_drift", [](HostileVisit& v) {
    v.options.disturb.pose_drift = {1e-3, 0.02 * kRadPerDeg};
  }));
  all.push_back(Changed("two_bumps", [kSmall](HostileVisit& v) {
    v = Bumped(static_cast<int>(v.options.seed), 0.005, 0.5);
    const SensorId other(kSensors[(5 * (v.options.seed - 1) + 4) % kSensors.size()]);
    v.options.bump_at_ratio = 0.3;
    v.options.disturb.excursion = {kSmall, 0.65, 1.0, other};
  }));
  for (const bool two : {false, true})
    all.push_back(Changed(two ? "pair_exchanged_lenses" : "exchanged_lenses", [two](HostileVisit& v) {
      v.exchanged_lenses = true;
      v.two_cameras = two;
    }));
}

// Rays of a lens that do not meet in one point: near boards are seen elsewhere than far ones.
void AddShiftedPupils(std::vector<TrustScenario>& all) {
  for (const bool two : {false, true})
    for (const auto& [name, m] : {std::pair{"pupil_shift_0.5_mm", 5e-4}, {"pupil_shift_2_mm", 2e-3}})
      all.push_back(Changed((two ? "pair_" : "") + std::string(name), [two, m = m](HostileVisit& v) {
        v.options.disturb.pupil_shift_m = m;
        v.two_cameras = two;
      }));
  // By another law than what looks for it takes.
  all.push_back(Changed("pupil_tangent_2_mm", [](HostileVisit& v) {
    v.options.disturb.pupil_shift_m = 2e-3;
    v.options.disturb.pupil_by_tangent = true;
  }));
}

// Two trackers, each with a world of its own: a motion capture system and odometry, say.
void AddSecondTrackers(std::vector<TrustScenario>& all) {
  constexpr sim::Displacement kNone{}, kMoved{0.005, 0.5 * kRadPerDeg}, kDrift{1e-3, 0.02 * kRadPerDeg};
  const auto add = [&](const std::string& name, const OtherWorld& world, const auto& change) {
    all.push_back(Changed("second_tracker" + name, [world, change](HostileVisit& v) {
      change(v);
      v.second_tracker = world;
    }));
  };
  const auto nothing = [](HostileVisit&) {};
  add("", {kNone, kNone}, nothing);
  add("_misfit_0.1_px_given", {kNone, kNone},
      [](HostileVisit& v) { v = Bent(static_cast<int>(v.options.seed), 0.1, sim::IntrinsicsKind::kCalibrated); });
  add("_bump_5_mm", {kNone, kNone}, [](HostileVisit& v) {
    v = Bumped(static_cast<int>(v.options.seed), 0.005, 0.5);
    v.options.bump = SensorId("mast");
  });
  add("_world_moved_5_mm", {kMoved, kNone}, nothing);
  add("_drift", {kNone, kDrift}, nothing);
}

std::vector<TrustScenario> MakeScenarios() {
  std::vector<TrustScenario> all = {{"clean", WithBound},
                                    {"coverage", WithFoundPlates},
                                    {"visits", [](int idx) { return Scattered(idx, false); }},
                                    {"pair_visits", [](int idx) { return Scattered(idx, true); }}};
  const std::pair<const char*, std::pair<double, double>> bumps[] = {
      {"bump_20_mm", {0.02, 2}}, {"bump_5_mm", {0.005, 0.5}}, {"bump_2_mm", {0.002, 0.2}}};
  for (const auto& [name, by] : bumps)
    all.push_back({name, [by](int idx) { return Bumped(idx, by.first, by.second); }});
  for (const int after : {1, 2, 4})
    all.push_back({(after == 4 ? "bump_before_last_burst_of_" : "bump_before_last_") + std::to_string(after),
                   [after](int idx) { return BumpedLate(idx, after, after == 4 ? 4 : 1); }});
  for (const auto& [name, by] : {std::pair{"pair_bump_5_mm", std::pair{0.005, 0.5}},
                                 {"pair_bump_12_mm", {0.012, 1}},
                                 {"pair_bump_20_mm", {0.02, 2}},
                                 {"pair_bump_100_mm", {0.1, 10}}})
    all.push_back({name, [by = by](int idx) { return PairBumped(idx, by.first, by.second); }});
  for (const auto& [name, other] :
       {std::pair{"camera_tracker_bump_12_mm", "body"}, {"camera_lidar_bump_12_mm", "lidar_vertical"}})
    all.push_back({name, [other = SensorId(other)](int idx) { return CameraPairBumped(idx, other); }});
  for (const double px : {0.05, 0.1})
    for (const auto kind : {sim::IntrinsicsKind::kCalibrated, sim::IntrinsicsKind::kAbsent})
      all.push_back({std::string("misfit_") + (px < 0.07 ? "0.05" : "0.1") +
                         (kind == sim::IntrinsicsKind::kAbsent ? "_px_estimated" : "_px_given"),
                     [px, kind](int idx) { return Bent(idx, px, kind); }});
  for (const int px : {0, 3, 8, 20})
    for (const bool two : {false, true})
      all.push_back({(two ? "pair_" : "rig_") + std::string("shift_") + std::to_string(px) + "_px",
                     [px, two](int idx) { return Shifted(idx, px, two); }});
  for (const bool two : {false, true})
    all.push_back(Changed(two ? "pair_single_tags" : "single_tags", [two](HostileVisit& visit) {
      visit.single_tags = true;
      visit.two_cameras = two;
    }));
  all.push_back({"bursts", [](int idx) { return Bursts(idx, 40, 4); }});
  all.push_back({"thousand", [](int idx) { return Bursts(idx, 1000, 20); }});
  for (const bool no_tracker : {false, true})
    all.push_back({no_tracker ? "no_tracker_board_moved" : "board_moved",
                   [no_tracker](int idx) { return BoardMoved(idx, no_tracker); }});
  for (const bool is_off : {false, true})
    all.push_back(
        {is_off ? "pose_clock_offset" : "pose_clock_right", [is_off](int idx) { return Swaying(idx, is_off); }});
  all.push_back(Changed("refocus", [](HostileVisit& v) { v.options.disturb.refocus = sim::Refocus{0.003, 0.5, {}}; }));
  all.push_back(Changed("wrong_instant", [](HostileVisit& v) { v.options.disturb.wrong_instant.emplace(); }));
  all.push_back(Changed("bent_boards", [](HostileVisit& v) { v.options.disturb.board_bend_m = 5e-4; }));
  AddWrongPrints(all);
  AddLooseMounts(all);
  AddShiftedPupils(all);
  AddSecondTrackers(all);
  all.push_back(Changed("incidence_bias", [](HostileVisit& v) { v.options.disturb.incidence_bias_m = 0.01; }));
  all.push_back(Changed("mixed_pixels", [](HostileVisit& v) {
    v.options.disturb.mixed_pixels_ratio = 0.5;
    v.found_plates = true;
  }));
  return all;
}

}  // namespace

const std::vector<TrustScenario>& TrustScenarios() {
  static const std::vector<TrustScenario> kScenarios = MakeScenarios();
  return kScenarios;
}

}  // namespace rigcal
