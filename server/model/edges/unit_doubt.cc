#include "server/model/edges/unit_doubt.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace rigcal {
namespace {

using Positions = std::map<std::string, Eigen::Vector3d>;

struct Stretch {
  double distance_m = 0.0;
  std::string between;  // "front_left and top"
};

void Widen(double distance_m, const std::string& a, const std::string& b, Stretch& widest) {
  if (distance_m > widest.distance_m) widest = {distance_m, a + " and " + b};
}

std::string SaidOf(const Stretch& widest) {
  char metres[32];
  std::snprintf(metres, sizeof metres, widest.distance_m < 1e6 ? "%.0f" : "%.3g", widest.distance_m);
  return std::string(metres) + " m between " + widest.between + ": ";
}

std::string QuestionOf(const Stretch& widest) { return SaidOf(widest) + "are these millimetres?"; }

// A place by the name that people know it by, and how far from the origin it is.
struct Away {
  std::string name;
  double distance_m = 0.0;
};

std::string Listed(const std::vector<Away>& places, std::size_t begin, std::size_t end) {
  constexpr std::size_t kNamedMax = 6;
  std::string text;
  const std::size_t named = end - begin > kNamedMax ? begin + kNamedMax - 1 : end;
  for (std::size_t i = begin; i < named; ++i)
    text += (i == begin ? "" : i + 1 == end ? " and " : ", ") + places[i].name;
  return named == end ? text : text + " and " + std::to_string(end - named) + " more";
}

// Where some are a thousand times as far away as others: those in metres, then, from `begin` on, those in millimetres.
// Taken for millimetres these are no nearer than a tenth of the nearest of the others, nor ten times the farthest.
struct Mixed {
  std::vector<Away> places;
  std::size_t begin = 0;  // 0: it is no mixture
};
Mixed MixtureOf(std::vector<Away> places) {
  constexpr double kApart = 20.0, kAlike = 10.0, kMillimetres = 1e-3;
  std::erase_if(places, [](const Away& one) { return !(one.distance_m > 0.0); });
  std::stable_sort(places.begin(), places.end(),
                   [](const Away& x, const Away& y) { return x.distance_m < y.distance_m; });
  Mixed mixed{std::move(places), 0};
  double widest = kApart;
  for (std::size_t i = 1; i < mixed.places.size(); ++i)
    if (const double apart = mixed.places[i].distance_m / mixed.places[i - 1].distance_m; apart > widest)
      widest = apart, mixed.begin = i;
  if (mixed.begin == 0) return mixed;
  const double nearest_m = mixed.places.front().distance_m, farthest_m = mixed.places[mixed.begin - 1].distance_m;
  if (kMillimetres * mixed.places[mixed.begin].distance_m < nearest_m / kAlike ||
      kMillimetres * mixed.places.back().distance_m > farthest_m * kAlike)
    mixed.begin = 0;
  return mixed;
}

// "captures 01 and 02", "capture 01", and of no noun the names alone.
std::string Named(const std::string& noun, const std::vector<Away>& places, std::size_t begin, std::size_t end) {
  return (noun.empty() ? "" : noun + (end - begin == 1 ? " " : "s ")) + Listed(places, begin, end);
}

// "225 m between back and top: are back and top in millimetres, and left in metres?", names in the order of `places`;
// of no mixture the plain question.
std::string QuestionOf(const Stretch& widest, std::vector<Away> places, const std::string& noun) {
  const Mixed mixed = MixtureOf(places);
  if (mixed.begin == 0) return QuestionOf(widest);
  const double millimetres_from_m = mixed.places[mixed.begin].distance_m;
  std::erase_if(places, [](const Away& one) { return !(one.distance_m > 0.0); });
  const auto others = std::stable_partition(places.begin(), places.end(),
                                            [&](const Away& one) { return one.distance_m >= millimetres_from_m; });
  const auto count = static_cast<std::size_t>(others - places.begin());
  return SaidOf(widest) + (count == 1 ? "is " : "are ") + Named(noun, places, 0, count) + " in millimetres, and " +
         Named(noun, places, count, places.size()) + " in metres?";
}

std::string QuestionBeyond(double doubted_m, const Stretch& widest, const std::vector<Away>& places,
                           const std::string& noun = "") {
  return widest.distance_m > doubted_m ? QuestionOf(widest, places, noun) : "";
}

std::vector<Away> PlacesOf(const Positions& p_m) {
  std::vector<Away> places;
  for (const auto& [name, p] : p_m) places.push_back({name, p.norm()});
  return places;
}

Stretch WidestOf(const Positions& p_m) {
  Stretch widest;
  for (auto a = p_m.begin(); a != p_m.end(); ++a)
    for (auto b = std::next(a); b != p_m.end(); ++b) Widen((a->second - b->second).norm(), a->first, b->first, widest);
  return widest;
}

// The reference sensor need not be drawn.
Positions DrawnPositions(const SessionHeader& header) {
  Positions p_m = {{header.reference.str(), Eigen::Vector3d::Zero()}};
  for (const Sensor& sensor : header.sensors)
    if (sensor.T_ref_nominal) p_m[sensor.id.str()] = sensor.T_ref_nominal->p_m;
  return p_m;
}

Stretch LongestStep(const PoseTable& tracker) {
  Stretch longest;
  for (std::size_t i = 1; i < tracker.size(); ++i)
    Widen((tracker[i].T_world_body.p_m - tracker[i - 1].T_world_body.p_m).norm(),
          "captures " + tracker[i - 1].capture.str(), tracker[i].capture.str(), longest);
  return longest;
}

}  // namespace

std::string UnitDoubt(const std::map<std::string, Eigen::Vector3d>& p_m) {
  return QuestionBeyond(kSensorsApartDoubted_m, WidestOf(p_m), PlacesOf(p_m));
}

std::string UnitDoubt(const SessionHeader& header) { return UnitDoubt(DrawnPositions(header)); }

std::string UnitDoubt(const std::vector<Edge>& edges) {
  Stretch widest;
  std::vector<Away> places;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    Widen(edge.T_a_b.p_m.norm(), edge.frame_a.str(), edge.frame_b.str(), widest);
    places.push_back({edge.frame_a.str() + " - " + edge.frame_b.str(), edge.T_a_b.p_m.norm()});
  }
  return QuestionBeyond(kSensorsApartDoubted_m, widest, places);
}

double LongestStep_m(const PoseTable& tracker) { return LongestStep(tracker).distance_m; }

std::string UnitDoubt(const PoseTable& tracker) {
  std::vector<Away> places;
  for (const TimedPose& row : tracker) places.push_back({row.capture.str(), row.T_world_body.p_m.norm()});
  return QuestionBeyond(kTrackerStepDoubted_m, LongestStep(tracker), places, "capture");
}

std::map<std::string, std::string> UnitDoubts(const SessionHeader& header, const std::map<SensorId, PoseTable>& poses) {
  std::map<std::string, std::string> doubts;
  const auto add = [&](const std::string& file, std::string doubt) {
    if (!doubt.empty()) doubts.emplace(file, std::move(doubt));
  };
  add("session.yaml", UnitDoubt(header));
  for (const auto& [id, table] : poses) {
    const Sensor* sensor = SensorOf(header, id);
    if (sensor == nullptr || sensor->kind != SensorKind::kTracker) continue;
    add(id.str() + "/" + std::string(kPoseTableStem) + ".csv", UnitDoubt(table));
  }
  return doubts;
}

Status CheckSensorsApart(const SessionHeader& header) {
  const Positions drawn = DrawnPositions(header);
  const Stretch widest = WidestOf(drawn);
  if (widest.distance_m <= kSensorsApartMax_m) return {};
  return Fail(ErrorCode::kInvalidInput, "T_ref_nominal: " + QuestionOf(widest, PlacesOf(drawn), ""),
              "Give p_m in metres.");
}

}  // namespace rigcal
