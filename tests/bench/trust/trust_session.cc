#include "tests/bench/trust/trust_session.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "client/sim/bound.h"
#include "client/sim/rig/rig_yaml.h"
#include "server/math/statistics.h"
#include "tests/bench/trust/found_plates.h"

namespace rigcal {
namespace {

// Walls relate the two lidars; whole clouds take the time, and no row needs them.
constexpr std::size_t kLidarPairCaptures = 0;

template <typename Value>
Value OrExit(Result<Value> value) {
  if (value) return std::move(*value);
  std::fprintf(stderr, "%s\n", Sentence(value.error()).c_str());
  std::exit(2);
}

// A tag of half a metre in the middle of the same plate.
Target SingleTagOn(Target board) {
  board.kind = TargetKind::kAprilGrid;
  board.cols = board.rows = 1;
  board.square_m = 0.5, board.spacing_ratio = 0.3;
  board.dictionary = "DICT_APRILTAG_36h11";
  return board;
}

sim::Rig FrontCamerasOnly(sim::Rig rig) {
  const auto is_front = [](const sim::RigSensor& sensor) {
    return sensor.kind == SensorKind::kCamera && sensor.sees == TargetId("front");
  };
  std::erase_if(rig.sensors, [&](const sim::RigSensor& sensor) { return !is_front(sensor); });
  std::erase_if(rig.boards, [](const sim::RigBoard& board) { return board.target.id != TargetId("front"); });
  rig.skip_pairs.clear();
  return rig;
}

sim::Rig WithoutTracker(sim::Rig rig) {
  std::erase_if(rig.sensors, [](const sim::RigSensor& sensor) { return sensor.kind == SensorKind::kTracker; });
  rig.skip_pairs.clear();
  return rig;
}

// With the boards that these see; the first is the reference.
sim::Rig WithOnly(const std::vector<SensorId>& sensors, sim::Rig rig) {
  std::erase_if(rig.sensors, [&](const sim::RigSensor& sensor) {
    return std::find(sensors.begin(), sensors.end(), sensor.id) == sensors.end();
  });
  rig.reference = sensors.front();
  rig.skip_pairs.clear();
  return rig;
}

// As when two lines of session.yaml were pasted the wrong way round.
void ExchangeLenses(SessionHeader& header) {
  const auto is_given = [](const Sensor& sensor) { return sensor.intrinsics.has_value(); };
  const auto first = std::find_if(header.sensors.begin(), header.sensors.end(), is_given);
  if (first == header.sensors.end()) return;
  const auto second = std::find_if(std::next(first), header.sensors.end(), is_given);
  if (second != header.sensors.end()) std::swap(first->intrinsics, second->intrinsics);
  if (second != header.sensors.end()) std::swap(first->intrinsics_sigma, second->intrinsics_sigma);
}

FeatureSession Recorded(const HostileVisit& visit, std::uint64_t seed) {
  FeatureSession session = RecordFeatures(ExperimentOf(visit, seed), kLidarPairCaptures);
  if (visit.found_plates) FindPlates(session);
  for (Sensor& sensor : session.header.sensors)
    if (sensor.intrinsics) sensor.intrinsics->fx_px *= 1 + visit.aspect_ratio;
  if (visit.exchanged_lenses) ExchangeLenses(session.header);
  return session;
}

// Few degrees of freedom: nothing lies outside.
double RegionLimit(double dof) {
  return dof > 0 ? HotellingLimit(static_cast<int>(dof + 1e-6) + 1) : ChiSquareQuantile(0.95, 6);
}

std::vector<sim::Experiment> TruthsOf(const HostileVisit& visit, const sim::Experiment& own) {
  if (visit.next_visits == 0) return {own};
  std::vector<sim::Experiment> truths;
  for (int i = 0; i < visit.next_visits; ++i)
    truths.push_back(ExperimentOf(visit, visit.options.seed + static_cast<std::uint64_t>(visit.visits + i)));
  return truths;
}

Se3 LastT_ref_sensor(const sim::Experiment& truth, const SensorId& sensor) {
  const std::size_t last = truth.captures.size() - 1;
  return truth.T_body_sensor(truth.rig.reference, last).Inverse() * truth.T_body_sensor(sensor, last);
}

PoseFigures FiguresOf(const SensorPose& pose, const std::vector<sim::Experiment>& truths) {
  PoseFigures figures;
  figures.known = pose.known;
  if (!pose.known) return figures;
  const sim::Experiment& own = truths.front();
  if (own.options.bump || own.displaced)
    figures.error_after = (pose.T_ref_sensor.Inverse() * LastT_ref_sensor(own, pose.sensor)).Log();
  for (const sim::Experiment& truth : truths)
    figures.errors.push_back((pose.T_ref_sensor.Inverse() * truth.T_ref_sensor(pose.sensor)).Log());
  figures.covariance = pose.covariance;
  figures.limit = RegionLimit(pose.dof);
  return figures;
}

}  // namespace

sim::Experiment ExperimentOf(const HostileVisit& visit, std::uint64_t seed) {
  sim::Options options = visit.options;
  options.seed = seed;
  sim::Rig rig = OrExit(sim::LoadRig("mars-mapper"));
  if (visit.two_cameras) rig = FrontCamerasOnly(std::move(rig));
  if (!visit.only.empty()) rig = WithOnly(visit.only, std::move(rig));
  if (visit.no_tracker) rig = WithoutTracker(std::move(rig));
  if (visit.second_tracker) rig = WithMast(std::move(rig));
  if (visit.single_tags)
    for (sim::RigBoard& board : rig.boards) board.target = SingleTagOn(board.target);
  sim::Experiment experiment = OrExit(sim::Prepare(std::move(rig), options));
  if (visit.second_tracker) DrawWorldOfMast(*visit.second_tracker, experiment);
  return experiment;
}

JudgedVisit JudgeVisit(const HostileVisit& visit) {
  std::vector<FeatureSession> sessions;
  for (int i = 0; i < visit.visits; ++i)
    sessions.push_back(Recorded(visit, visit.options.seed + static_cast<std::uint64_t>(i)));
  JudgedVisit judged{visit, sessions.front().experiment, {}, {}, 0};
  const auto start = std::chrono::steady_clock::now();
  judged.told = Judge(sessions);
  judged.judge_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<sim::Experiment> truths = TruthsOf(visit, judged.experiment);
  for (const SensorPose& pose : judged.told.poses)
    if (pose.sensor != judged.told.reference) judged.poses[pose.sensor] = FiguresOf(pose, truths);
  if (visit.bound)
    for (const auto& [id, bound] : sim::CramerRaoBound(judged.experiment))
      if (const auto figures = judged.poses.find(id); figures != judged.poses.end()) figures->second.bound = bound;
  return judged;
}

}  // namespace rigcal
