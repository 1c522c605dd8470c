// Two sensors that sit where the drawing has the other. They are exchanged, or the drawing is wrong in a way that gives
// the same numbers: the inverse of T_ref_nominal, or a wrong sign in it, puts two sensors at each other's places.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "server/fleet/causes/placed_sensors.h"

namespace rigcal::fleet {
namespace {

// A sensor is rather at one place than at another where it is so many times nearer.
constexpr double kNearerTimes = 3.0;

bool IsRatherAt(const Placed& placed, const Se3& place) {
  return kNearerTimes * TimesTooFar(placed, place) < TimesTooFar(placed, placed.drawn);
}

bool IsAt(const Placed& placed, const Se3& place) {
  return TimesTooFar(placed, place) <= 1 || IsRatherAt(placed, place);
}

// That two of them are, one of which may be the reference, as seen from which all are.
struct Exchange {
  const Placed &x, &y, &reference;
  [[nodiscard]] bool Has(const Placed& one) const { return one.sensor == x.sensor || one.sensor == y.sensor; }
  [[nodiscard]] const Se3& DrawnAs(const Placed& one) const {
    if (one.sensor == x.sensor) return y.drawn;
    return one.sensor == y.sensor ? x.drawn : one.drawn;
  }
  // Where the drawing would have it then.
  [[nodiscard]] Se3 PlaceOf(const Placed& one) const { return DrawnAs(reference).Inverse() * DrawnAs(one); }
};

// Of the reference, all others look elsewhere, and have to be where they are seen from the other.
bool MayBe(const Exchange& exchange, const std::vector<Placed>& placed) {
  const auto is_reference = [&](const Placed& one) { return one.sensor == exchange.reference.sensor; };
  if (exchange.x.kind != exchange.y.kind) return false;
  for (const Placed* one : {&exchange.x, &exchange.y})
    if (!is_reference(*one) && (!IsFar(*one) || !IsRatherAt(*one, exchange.PlaceOf(*one)))) return false;
  return !exchange.Has(exchange.reference) || std::all_of(placed.begin(), placed.end(), [&](const Placed& one) {
    return is_reference(one) || IsAt(one, exchange.PlaceOf(one));
  });
}

// How every T_ref_nominal may be written wrong.
struct Slip {
  bool inverse = false;
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  bool mirrors_turns = false;
  [[nodiscard]] Se3 Of(const Se3& drawn) const {
    Se3 T = inverse ? drawn.Inverse() : drawn;
    T.p_m = signs.cwiseProduct(T.p_m);
    const Eigen::Matrix3d S = signs.asDiagonal();
    if (mirrors_turns) T.q = Eigen::Quaterniond(Eigen::Matrix3d(S * T.R() * S));
    return T;
  }
  // As from the sensor to the reference.
  [[nodiscard]] bool IsOfDirection() const { return inverse || signs.maxCoeff() < 0; }
};

std::vector<Slip> Slips() {
  std::vector<Slip> slips = {{true}};
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double z : {1.0, -1.0})
        for (const bool mirrors_turns : {false, true})
          if (x + y + z < 3) slips.push_back({false, {x, y, z}, mirrors_turns});
  return slips;
}

// Those that put both where they are.
std::vector<Slip> SlipsBehind(const Exchange& exchange) {
  std::vector<Slip> slips = Slips();
  std::erase_if(slips, [&](const Slip& slip) {
    return !IsAt(exchange.x, slip.Of(exchange.x.drawn)) || !IsAt(exchange.y, slip.Of(exchange.y.drawn));
  });
  return slips;
}

// What is open of either is.
Placed SeenFrom(const Placed& from, const Placed& one) {
  const Se3 T_from_one = from.measured.Inverse() * one.measured;
  Placed seen{one.sensor, one.kind, T_from_one, from.drawn.Inverse() * one.drawn, std::hypot(from.sigma_m, one.sigma_m),
              one.open};
  const Matrix6d by_from = Adjoint(T_from_one.Inverse());
  for (const Vector6d& direction : from.open) seen.open.emplace_back(by_from * direction);
  return seen;
}

// As the drawing stands, a third is far from one of the two; the exchange puts it where it is, and none of these slips
// does.
bool IsBorneOutBy(const Placed& third, const Exchange& exchange, const std::vector<Slip>& slips) {
  if (exchange.Has(third)) return false;
  if (!IsFar(SeenFrom(exchange.x, third)) && !IsFar(SeenFrom(exchange.y, third))) return false;
  const Se3 place = exchange.PlaceOf(third);
  if (!IsAt(third, place)) return false;
  return std::all_of(slips.begin(), slips.end(), [&](const Slip& slip) {
    const double slipped = TimesTooFar(third, slip.Of(third.drawn));
    return slipped > 1 && kNearerTimes * TimesTooFar(third, place) < slipped;
  });
}

bool IsBorneOut(const Exchange& exchange, const std::vector<Placed>& placed, const std::vector<Slip>& slips) {
  return std::any_of(placed.begin(), placed.end(),
                     [&](const Placed& third) { return IsBorneOutBy(third, exchange, slips); });
}

struct Claim {
  CauseKind kind = CauseKind::kExchanged;
  Finding said;
  std::string command;
  bool in_doubt = false;
};

// Where others moved along with the two, the whole drawing would have to be mirrored for it to be anything else: that
// may be, but folders are mistaken for each other more often. Of the two alone nothing is more likely than the other.
Claim ClaimOf(const Exchange& exchange, const std::vector<Placed>& placed) {
  const std::string x = exchange.x.sensor.str(), y = exchange.y.sensor.str(), both = x + " and " + y,
                    check = "Open one file of " + x + "/: is it from " + x +
                            "? No: exchange the names of the two folders. Yes: correct T_ref_nominal in session.yaml";
  const Placed& moved = exchange.x.sensor == exchange.reference.sensor ? exchange.y : exchange.x;
  const std::string off = "(" + OffNominalText(moved) + " from nominal" + ByMeasuredText(moved) + ")";
  std::vector<Slip> slips = SlipsBehind(exchange);
  if (IsBorneOut(exchange, placed, slips))
    return {CauseKind::kExchanged,
            {both + " look exchanged: each sits where the other should be " + off,
             "Exchange their folders, or their names in session.yaml"},
            kPushAgain};
  std::erase_if(slips, [](const Slip& slip) { return !slip.IsOfDirection(); });
  if (exchange.Has(exchange.reference) && IsBorneOut(exchange, placed, slips))
    return {
        CauseKind::kExchanged,
        {both + " look exchanged, or the nominal (CAD) poses are mirrored: each sits where the other should be " + off,
         check},
        kPushAgain};
  return {CauseKind::kFarFromNominal,
          {both + " sit at each other's nominal (CAD) places " + off +
               ": they are exchanged, or the sign or direction of T_ref_nominal is wrong",
           check},
          kPushAgain,
          true};
}

void AddExchanged(CauseSearch& search, const Exchange& exchange, const std::vector<Placed>& placed) {
  const SensorId &x = exchange.x.sensor, &y = exchange.y.sensor;
  Claim claim = ClaimOf(exchange, placed);
  RootCause cause{claim.kind, {x, y}, {}, {}, {}, std::move(claim.said), std::move(claim.command)};
  if (claim.in_doubt) cause.doubted = {x, y};
  cause.edges = TakeMatchedFromDrawing(search, {x, y});
  const Placed& moved = x == exchange.reference.sensor ? exchange.y : exchange.x;
  cause.said.figure = {moved.sensor.str() + " from its nominal (CAD) pose", OffNominalText(moved),
                       "where " + (moved.sensor == x ? y : x).str() + " should be"};
  search.causes.push_back(std::move(cause));
}

void AddExchangesOf(CauseSearch& search, const std::vector<Placed>& placed, const Placed& reference,
                    bool of_reference) {
  std::set<SensorId> exchanged;
  for (auto x = placed.begin(); x != placed.end(); ++x)
    for (auto y = x + 1; y != placed.end(); ++y) {
      const Exchange exchange{*x, *y, reference};
      if (exchange.Has(reference) != of_reference || exchanged.contains(x->sensor) || exchanged.contains(y->sensor))
        continue;
      if (!MayBe(exchange, placed)) continue;
      exchanged.insert({x->sensor, y->sensor});
      AddExchanged(search, exchange, placed);
    }
}

}  // namespace

void FindExchanged(CauseSearch& search) {
  const SensorPose* reference = ReferenceOf(search.solution);
  if (reference == nullptr) return;
  const std::vector<Placed> placed = PlacedSensors(search.solution, search.headers, reference->sensor);
  const auto own =
      std::find_if(placed.begin(), placed.end(), [&](const Placed& one) { return one.sensor == reference->sensor; });
  if (own == placed.end()) return;
  AddExchangesOf(search, placed, *own, false);
  if (MisplacedBy(search.causes).empty()) AddExchangesOf(search, placed, *own, true);
}

}  // namespace rigcal::fleet
