// Sensors that are not where the drawing has them: two that are exchanged, and those that are elsewhere alone.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/fleet/root_causes.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

constexpr double kPlaceMax_m = 0.05, kPlaceMaxSigmas = 5.0, kTurnMax_rad = 5 / kDegreesPerRadian;
// Two are exchanged where each is so many times nearer to the other's place than to its own.
constexpr double kNearerTimes = 3.0;
// Sensors that are all elsewhere tell of the one that they are measured from.
constexpr std::size_t kReferenceSuspected = 3;

// A known sensor that the drawing has, in the reference.
struct Placed {
  SensorId sensor;
  std::optional<SensorKind> kind;
  Se3 measured, drawn;
  double sigma_m = 0.0;
};

Vector6d Away(const Se3& drawn, const Se3& measured) {
  Vector6d away;
  away << measured.p_m - drawn.p_m, (drawn.Inverse() * measured).Log().tail<3>();
  return away;
}

// Over 1: not there.
double TimesTooFar(const Placed& placed, const Se3& place) {
  const Vector6d away = Away(place, placed.measured);
  return std::max(away.head<3>().norm() / std::max(kPlaceMax_m, kPlaceMaxSigmas * placed.sigma_m),
                  away.tail<3>().norm() / kTurnMax_rad);
}

bool IsFar(const Placed& placed) { return TimesTooFar(placed, placed.drawn) > 1; }

bool IsRatherAt(const Placed& placed, const Se3& place) {
  return kNearerTimes * TimesTooFar(placed, place) < TimesTooFar(placed, placed.drawn);
}

std::vector<const SessionHeader*> NewestFirst(const SessionHeaders& headers) {
  std::vector<const SessionHeader*> newest;
  for (const auto& [session, header] : headers) newest.push_back(&header);
  std::stable_sort(newest.begin(), newest.end(),
                   [](const SessionHeader* x, const SessionHeader* y) { return x->captured_at > y->captured_at; });
  return newest;
}

std::optional<Placed> PlacedOf(const SensorPose& pose, const SensorId& reference,
                               const std::vector<const SessionHeader*>& newest) {
  for (const SessionHeader* header : newest) {
    const Sensor *from = SensorOf(*header, reference), *sensor = SensorOf(*header, pose.sensor);
    const auto drawn = from && sensor ? NominalPose(*header, *from, *sensor) : std::nullopt;
    if (!drawn) continue;
    const double variance_m2 = pose.covariance.diagonal().head<3>().maxCoeff();
    return Placed{pose.sensor, sensor->kind, pose.T_ref_sensor, *drawn, std::sqrt(std::max(variance_m2, 0.0))};
  }
  return std::nullopt;
}

// The reference is there too, where it is.
std::vector<Placed> PlacedSensors(const CauseSearch& search, const SensorId& reference) {
  const std::vector<const SessionHeader*> newest = NewestFirst(search.headers);
  std::vector<Placed> placed;
  for (const SensorPose& pose : search.solution.poses)
    if (pose.known)
      if (const auto one = PlacedOf(pose, reference, newest)) placed.push_back(*one);
  return placed;
}

bool AreExchanged(const Placed& x, const Placed& y) {
  return x.kind == y.kind && IsFar(x) && IsFar(y) && IsRatherAt(x, y.drawn) && IsRatherAt(y, x.drawn);
}

// Seen from a reference that is in truth at the place of `other`, nobody is where the drawing has him: each is where it
// has him from there.
bool IsExchangedWithReference(const Placed& other, const std::vector<Placed>& placed, const Placed& reference) {
  if (other.kind != reference.kind || !IsFar(other)) return false;
  const Se3 T_other_ref = other.drawn.Inverse();
  return std::all_of(placed.begin(), placed.end(), [&](const Placed& one) {
    if (one.sensor == reference.sensor) return true;
    const Se3 place = one.sensor == other.sensor ? T_other_ref : T_other_ref * one.drawn;
    return TimesTooFar(one, place) <= 1 || IsRatherAt(one, place);
  });
}

// A pair of lidars is matched from where the drawing has them.
bool FollowsFromDrawing(const Edge& edge, const std::set<SensorId>& misplaced) {
  return FailedFor(edge, {"low_overlap", "poor_fit", "starts_disagree", "ambiguous_pose", "not_converged"}) &&
         edge.method == "lidar_lidar" && (misplaced.contains(edge.frame_a) || misplaced.contains(edge.frame_b));
}

void AddExchanged(CauseSearch& search, const Placed& x, const Placed& y, const Vector6d& away) {
  RootCause cause{CauseKind::kExchanged, {x.sensor, y.sensor}, {}, {}, {}, {}, kPushAgain};
  const std::set<SensorId> both = {x.sensor, y.sensor};
  cause.edges = IdsOf(search.Take([&](const Edge& edge) { return FollowsFromDrawing(edge, both); }));
  cause.said = {x.sensor.str() + " and " + y.sensor.str() + " look exchanged: each sits where the other should be (" +
                    OffText(away) + " from nominal)",
                "Exchange their folders, or their names in session.yaml"};
  search.causes.push_back(std::move(cause));
}

std::set<SensorId> ExchangedIn(const CauseSearch& search) {
  std::set<SensorId> exchanged;
  for (const RootCause& cause : search.causes)
    if (cause.kind == CauseKind::kExchanged) exchanged.insert(cause.sensors.begin(), cause.sensors.end());
  return exchanged;
}

Finding Elsewhere(const std::vector<Placed>& far, const SensorId& reference, bool all) {
  std::vector<SensorId> sensors;
  for (const Placed& one : far) sensors.push_back(one.sensor);
  const std::string names = List(sensors), worst = far.front().sensor.str(),
                    off = OffText(Away(far.front().drawn, far.front().measured));
  if (far.size() == 1)
    return {names + " sits " + off + " from where the drawing has it",
            "Check the name and the mount of " + names + ", or correct its T_ref_nominal in session.yaml"};
  const std::string why = names + " sit elsewhere than the drawing has them, " + worst + " by " + off;
  if (!all) return {why, "Check their names and their mounts, or correct their T_ref_nominal in session.yaml"};
  return {why, "Check the name and the mount of " + reference.str() + ", from which all are measured"};
}

}  // namespace

void FindExchanged(CauseSearch& search) {
  const SensorPose* reference = ReferenceOf(search.solution);
  if (reference == nullptr) return;
  const std::vector<Placed> placed = PlacedSensors(search, reference->sensor);
  std::set<SensorId> exchanged;
  for (auto x = placed.begin(); x != placed.end(); ++x)
    for (auto y = x + 1; y != placed.end(); ++y) {
      if (exchanged.contains(x->sensor) || exchanged.contains(y->sensor) || !AreExchanged(*x, *y)) continue;
      exchanged.insert({x->sensor, y->sensor});
      AddExchanged(search, *x, *y, Away(x->drawn, x->measured));
    }
  const auto own =
      std::find_if(placed.begin(), placed.end(), [&](const Placed& one) { return one.sensor == reference->sensor; });
  if (own == placed.end() || !exchanged.empty()) return;
  for (const Placed& other : placed)
    if (other.sensor != own->sensor && IsExchangedWithReference(other, placed, *own))
      return AddExchanged(search, *own, other, Away(other.drawn, other.measured));
}

void FindFarFromNominal(CauseSearch& search) {
  const SensorPose* reference = ReferenceOf(search.solution);
  if (reference == nullptr) return;
  const std::set<SensorId> exchanged = ExchangedIn(search);
  if (exchanged.contains(reference->sensor)) return;
  std::vector<Placed> far = PlacedSensors(search, reference->sensor);
  std::erase_if(far, [&](const Placed& one) { return one.sensor == reference->sensor; });
  const std::size_t others = far.size();
  std::erase_if(far, [&](const Placed& one) { return exchanged.contains(one.sensor) || !IsFar(one); });
  if (far.empty()) return;
  std::stable_sort(far.begin(), far.end(),
                   [](const Placed& x, const Placed& y) { return TimesTooFar(x, x.drawn) > TimesTooFar(y, y.drawn); });
  RootCause cause;
  cause.kind = CauseKind::kFarFromNominal;
  std::set<SensorId> misplaced;
  for (const Placed& one : far) {
    cause.sensors.push_back(one.sensor);
    misplaced.insert(one.sensor);
  }
  cause.edges = IdsOf(search.Take([&](const Edge& edge) { return FollowsFromDrawing(edge, misplaced); }));
  cause.said = Elsewhere(far, reference->sensor, far.size() == others && others >= kReferenceSuspected);
  search.causes.push_back(std::move(cause));
}

}  // namespace rigcal::fleet
