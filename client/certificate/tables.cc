#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "client/certificate/lines.h"
#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/math/statistics.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kCertifiedMax = 14, kFoundMax = 8;
constexpr double kBothSidesOf95 = 0.975, kOfFound = 2.0;

// Three axes: shifts, in m, or turns, in rad.
struct Half {
  const char *sigma, *tolerance;
  std::size_t first;
  double scale;
};
constexpr std::array<Half, 2> kHalves = {Half{"sigma_m", "tolerance_m", 0, kMmPerM},
                                         Half{"sigma_rad", "tolerance_rad", 3, kDegPerRad}};

std::optional<double> LargestOf(const Document& three) {
  std::optional<double> largest;
  for (const Document& one : three.Items())
    if (const auto value = one.Number()) largest = std::max(largest.value_or(0.0), *value);
  return largest;
}

std::string WordOf(std::optional<Decision> decision) {
  if (!decision) return "-";
  return *decision == Decision::kWithin ? "yes" : *decision == Decision::kBeyond ? "no" : "not decided";
}

// The worse of both; nothing where one is not known.
std::optional<Decision> Worse(std::optional<Decision> a, std::optional<Decision> b) {
  if (a == Decision::kBeyond || b == Decision::kBeyond) return Decision::kBeyond;
  if (!a || !b) return std::nullopt;
  return std::max(*a, *b);
}

std::optional<double> CoverageOf(const Document& sensor) {
  const auto dof = sensor["dof"].Number();
  if (!dof || !(*dof > 0)) return std::nullopt;
  return StudentQuantile(kBothSidesOf95, *dof);
}

std::optional<Decision> DecisionOf(const Document& sensor, const Half& half, std::optional<double> k) {
  const auto sigma = LargestOf(sensor[half.sigma]), tolerance = sensor[half.tolerance].Number();
  if (!sigma || !tolerance) return std::nullopt;
  if (*sigma > *tolerance) return Decision::kBeyond;
  return k ? std::optional(Decide(0.0, *k * *sigma, *tolerance)) : std::nullopt;
}

// How much of its tolerance a sensor's sigma takes; the unknown come first.
double DoubtOf(const Document& sensor) {
  if (!sensor["known"].Flag()) return HUGE_VAL;
  double doubt = 0.0;
  for (const Half& half : kHalves)
    doubt =
        std::max(doubt, LargestOf(sensor[half.sigma]).value_or(0.0) / sensor[half.tolerance].Number().value_or(1.0));
  return doubt;
}

void AddPose(const Document& sensor, const std::string& reference, Table& table) {
  const std::string name = sensor["id"].Text("?");
  const Document pose = sensor["T_ref_sensor"];
  if (!sensor["known"].Flag()) return table.Add({name, "not known"});
  if (name == reference) return table.Add({name, "reference"});
  const auto k = CoverageOf(sensor);
  std::vector<std::string> cells = {name, Triple(pose["p_m"], kMmPerM, 2), RpyText(pose, 3)};
  std::optional<Decision> decision = Decision::kWithin;
  for (const Half& half : kHalves) {
    const auto sigma = LargestOf(sensor[half.sigma]);
    cells.push_back(Scaled(sigma, half.scale, 3) + " (" + Scaled(sensor[half.tolerance].Number(), half.scale, 2) + ")");
    decision = Worse(decision, DecisionOf(sensor, half, k));
  }
  cells.push_back(Fixed(k, 2));
  for (const Half& half : kHalves) {
    const auto sigma = LargestOf(sensor[half.sigma]);
    cells.push_back(k && sigma ? Scaled(*k * *sigma, half.scale, 3) : "-");
  }
  cells.push_back(WordOf(decision));
  table.Add(std::move(cells));
}

void AddTable(const Table& table, std::vector<CertificateLine>& lines) {
  std::ostringstream text;
  table.Print(text);
  std::istringstream rows(text.str());
  for (std::string row; std::getline(rows, row);) lines.push_back({row, LineStyle::kTable});
}

// Of what a session found along three axes, the worst of each.
struct FoundHalf {
  std::optional<double> off, left;  // nothing: not measured along any of them
  double U = 0.0;
  std::optional<Decision> decision;
};
FoundHalf FoundOf(const Document& found, const Document& sensor, const Half& half) {
  FoundHalf worst;
  for (std::size_t axis = half.first; axis < half.first + 3; ++axis) {
    const auto change = found["change"][axis].Number(), sigma = found["sigma"][axis].Number();
    if (!change || !sigma) continue;
    const double off = std::abs(*change), U = kOfFound * *sigma;
    if (off >= worst.off.value_or(0.0)) worst.off = off, worst.U = U;
    if (const auto left = found["left"][axis].Number())
      worst.left = std::max(worst.left.value_or(0.0), std::abs(*left));
    if (const auto tolerance = sensor[half.tolerance].Number())
      worst.decision = std::max(worst.decision.value_or(Decision::kWithin), Decide(off, U, *tolerance));
  }
  return worst;
}

Document SensorNamed(const Document& show, const std::string& id) {
  for (const Document& sensor : show["document"]["sensors"].Items())
    if (sensor["id"].Text() == id) return sensor;
  return {};
}

// How much of its tolerance a sensor was off by; the drifted come before all others.
std::pair<bool, double> MovedBy(const Document& show, const Document& found) {
  const Document sensor = SensorNamed(show, found["id"].Text());
  double share = 0.0;
  for (const Half& half : kHalves)
    share =
        std::max(share, FoundOf(found, sensor, half).off.value_or(0.0) / sensor[half.tolerance].Number().value_or(1.0));
  return {found["state"].Text() == "drifted", share};
}

std::string WithU(const FoundHalf& half, double scale) {
  return half.off ? Scaled(*half.off, scale, 3) + " +- " + Scaled(half.U, scale, 3) : "-";
}

void AddFound(const Document& show, const Document& found, Table& table) {
  const std::string state = found["state"].Text();
  if (state != "unchanged" && state != "drifted") return table.Add({found["id"].Text("?"), state});
  const Document sensor = SensorNamed(show, found["id"].Text());
  const FoundHalf shift = FoundOf(found, sensor, kHalves[0]), turn = FoundOf(found, sensor, kHalves[1]);
  table.Add({found["id"].Text("?"), state, WithU(shift, kMmPerM), WithU(turn, kDegPerRad),
             WordOf(Worse(shift.decision, turn.decision)), Scaled(shift.left, kMmPerM, 3),
             Scaled(turn.left, kDegPerRad, 3)});
}

}  // namespace

Decision Decide(double off, double U, double tolerance) {
  if (off + U <= tolerance) return Decision::kWithin;
  return off - U > tolerance ? Decision::kBeyond : Decision::kOpen;
}

void AddPoses(const Document& show, std::vector<CertificateLine>& lines) {
  const std::string reference = show["document"]["reference"].Text("?");
  lines.push_back({"Sensors in the frame of " + reference, LineStyle::kHeading});
  std::vector<Document> sensors = show["document"]["sensors"].Items();
  const std::size_t more = sensors.size() > kCertifiedMax ? sensors.size() - kCertifiedMax : 0;
  if (more > 0)
    std::stable_sort(sensors.begin(), sensors.end(),
                     [](const Document& x, const Document& y) { return DoubtOf(x) > DoubtOf(y); });
  Table table({{"SENSOR"},
               {"x y z mm", Align::kRight},
               {"rpy deg", Align::kRight},
               {"sigma mm (tol.)", Align::kRight},
               {"deg (tol.)", Align::kRight},
               {"k", Align::kRight},
               {"U mm", Align::kRight},
               {"U deg", Align::kRight},
               {"WITHIN"}});
  for (std::size_t i = 0; i + more < sensors.size(); ++i) AddPose(sensors[i], reference, table);
  AddTable(table, lines);
  if (more > 0) AddText(std::to_string(more) + " more, all more certain than these, are in the report.", 1, lines);
  AddText(
      "sigma: one standard deviation of the axis that is known worst. U = k sigma holds the value with 95 %; k is "
      "Student's t. Decision rule, guard band U: WITHIN is `yes` where U is at most the tolerance, `no` where sigma "
      "alone is beyond it, else not decided.",
      3, lines);
}

void AddAsFound(const Document& show, std::vector<CertificateLine>& lines) {
  const Document found = show["as_found"];
  lines.push_back({"As found, as left", LineStyle::kHeading});
  if (found.IsNull()) return AddText("Nothing was in use before, or the revision has no session.", 1, lines);
  AddText(found["text"].Text(found["why_not"].Text("-")), 3, lines);
  std::vector<Document> sensors = found["sensors"].Items();
  if (!found["why_not"].IsNull() || sensors.empty()) return;
  std::stable_sort(sensors.begin(), sensors.end(),
                   [&](const Document& x, const Document& y) { return MovedBy(show, x) > MovedBy(show, y); });
  Table table({{"SENSOR"},
               {"FOUND"},
               {"off by mm", Align::kRight},
               {"deg", Align::kRight},
               {"WITHIN"},
               {"left mm", Align::kRight},
               {"deg", Align::kRight}});
  for (std::size_t i = 0; i < std::min(sensors.size(), kFoundMax); ++i) AddFound(show, sensors[i], table);
  AddTable(table, lines);
  if (sensors.size() > kFoundMax)
    AddText(std::to_string(sensors.size() - kFoundMax) + " more are in the report.", 1, lines);
  AddText(
      "Seen from " + found["relative_to"].Text("?") +
          ", on the worst axis; U = 2 sigma of the change, scatter between visits included. Decision rule, guard band "
          "U: `yes` where off + U is at most the tolerance, `no` where off - U is beyond it, else not decided. Left: "
          "off after the update.",
      3, lines);
}

}  // namespace rigcal::client
