#include <algorithm>
#include <utility>

#include "server/report/drawings/drawing.h"
#include "server/report/drawings/ring.h"
#include "server/report/edges/edge_fit.h"
#include "server/report/text/edge_axes.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kTagsMax = 40;  // more labels than this hide the drawing
constexpr std::size_t kNameMax = 22;  // characters; the whole name is in the title

std::string Point(const Eigen::Vector2d& p) { return Fixed(p.x(), 1) + " " + Fixed(p.y(), 1); }

std::string TagText(const Edge& edge) {
  if (edge.state == EdgeState::kFailed) return "failed";
  return "\xC2\xB1 " + LargestSigma(edge.uncertainty, tangent::kTranslation, " mm");
}

std::string ResidualText(const ShownEdge& shown) {
  return "residual " + Significant(shown.residual->e.head<3>().norm() * kMmPerMetre, 2) + " mm, " +
         Significant(shown.residual->e.tail<3>().norm() * kDegPerRad, 2) + " deg, " + SigmasText(shown.in_sigmas) +
         " \xCF\x83";
}

std::string TitleOf(const ShownEdge& shown, const UncheckedParts& unchecked) {
  const Edge& edge = *shown.edge;
  const std::string pair = edge.frame_a.str() + " \xE2\x86\x92 " + edge.frame_b.str() + ": ";
  if (edge.state == EdgeState::kFailed)
    return pair + "failed. " + (edge.diagnoses.empty() ? std::string() : edge.diagnoses.front().what);
  const std::string sigma = pair + "\xCF\x83 " + LargestSigma(edge.uncertainty, tangent::kTranslation, " mm") + "; " +
                            LargestSigma(edge.uncertainty, tangent::kRotation, " deg");
  if (!shown.residual) return sigma;
  const std::string part = unchecked.Of(edge.id);
  if (unchecked.whole.contains(edge.id)) return sigma + "; " + part;
  return sigma + "; " + ResidualText(shown) + (part.empty() ? "" : "; " + part);
}

struct Ring {
  Dictionary& svg;
  std::map<SensorId, Eigen::Vector2d> places;
  bool named = false;
  UncheckedParts unchecked;
  InformationScale widths;
  Contradictions contradictions;
  std::vector<std::pair<const ShownEdge*, Curve>> links = {};
  TagPlaces tags = {};
};

std::pair<SensorId, SensorId> PairOf(const Edge& edge) { return std::minmax(edge.frame_a, edge.frame_b); }

void PlaceLinks(Ring& ring, const std::vector<ShownEdge>& edges) {
  std::map<std::pair<SensorId, SensorId>, int> counts, seen;
  for (const ShownEdge& shown : edges) ++counts[PairOf(*shown.edge)];
  for (const ShownEdge& shown : edges) {
    const auto pair = PairOf(*shown.edge);
    const auto a = ring.places.find(pair.first), b = ring.places.find(pair.second);
    if (a == ring.places.end() || b == ring.places.end()) continue;
    ring.links.emplace_back(&shown, CurveBetween(a->second, b->second, seen[pair]++, counts[pair]));
  }
}

void DrawLink(Ring& ring, const ShownEdge& shown, const Curve& curve) {
  const bool failed = shown.edge->state == EdgeState::kFailed;
  Dictionary* link = ring.svg.AddSectionDictionary("LINK");
  link->SetValue("STATE", FitClass(shown, ring.unchecked));
  link->SetValue("STROKE", failed ? kFailedStroke : kGoodStroke);
  link->SetValue("THICK", ring.named ? Fixed(ring.widths.Width_px(*shown.edge), 1) : "1");
  link->SetValue("D", std::string("M").append(Point(curve.a)) + "Q" + Point(curve.control) + " " + Point(curve.b));
  link->SetValue("TITLE", TitleOf(shown, ring.unchecked));
  if (failed) link->ShowSection("DASHED");
  if (!shown.detailed) return;
  ShowValue(*link, "JUMP", "ANCHOR", shown.anchor);
  link->ShowSection("JUMPED");
}

void DrawTag(Ring& ring, const ShownEdge& shown, const Curve& curve) {
  const bool suspect = ring.contradictions.suspects.contains(shown.edge->id);
  const bool one_of_several = ring.contradictions.alternatives.contains(shown.edge->id);
  const std::string text = suspect          ? "\xE2\x9A\xA0 contradicts the rest"
                           : one_of_several ? "\xE2\x9A\xA0 may be wrong"
                                            : TagText(*shown.edge);
  const auto place = ring.tags.Take(curve, {7.0 * static_cast<double>(text.size()), 18.0});
  if (!place) return;
  Dictionary* tag = ring.svg.AddSectionDictionary("TAG");
  tag->SetValue("STATE", suspect || shown.edge->state == EdgeState::kFailed ? "failed" : "good");
  tag->SetValue("X", Fixed(place->x(), 1));
  tag->SetValue("Y", Fixed(place->y(), 1));
  tag->SetValue("TEXT", text);
}

void DrawName(Dictionary& node, const std::string& id, const Eigen::Vector2d& place, const Eigen::Vector2d& spoke,
              const char* state) {
  constexpr double kGap_px = 23;
  const Eigen::Vector2d out = spoke.norm() > 0 ? Eigen::Vector2d(spoke.normalized()) : Eigen::Vector2d(0, -1);
  Dictionary* name = node.AddSectionDictionary("NAMED");
  name->SetValue("STATE", state);
  name->SetValue("SIDE", out.x() > 0.25 ? "start" : out.x() < -0.25 ? "end" : "middle");
  name->SetValue("X", Fixed(place.x() + out.x() * kGap_px, 1));
  name->SetValue("Y", Fixed(place.y() + out.y() * kGap_px, 1));
  name->SetValue("TEXT", id.size() > kNameMax ? id.substr(0, kNameMax - 1) + "\xE2\x80\xA6" : id);
}

// A triangle does not reach as far down as a ring: no empty space below it.
double HeightOf(const std::map<SensorId, Eigen::Vector2d>& places, const RingSize& size) {
  double lowest_px = size.height_px / 2;
  for (const auto& [sensor, place] : places) lowest_px = std::max(lowest_px, place.y());
  return lowest_px + size.height_px / 2 - size.radius_y_px;
}

void DrawNode(Ring& ring, const SensorPose& pose, bool is_reference, const Eigen::Vector2d& centre) {
  const Eigen::Vector2d place = ring.places.at(pose.sensor);
  const char* state = is_reference ? "reference" : pose.known ? "known" : "unknown";
  Dictionary* node = ring.svg.AddSectionDictionary("NODE");
  node->SetValue("STATE", state);
  node->SetValue("X", Fixed(place.x(), 1));
  node->SetValue("Y", Fixed(place.y(), 1));
  node->SetValue("R", ring.named ? "9" : "4");
  node->SetValue("RIM", ring.named ? "2" : "1");
  node->SetValue("FILL", pose.known ? kKnownFill : kUnknownFill);
  node->SetValue("TITLE", pose.sensor.str() + (pose.known ? "" : pose.measured_part ? ": known in part" : ": unknown"));
  if (is_reference) ShowValue(*node, "HALO", "R", ring.named ? "13" : "7");
  if (ring.named) DrawName(*node, pose.sensor.str(), place, place - centre, state);
}

}  // namespace

std::string FillRing(Dictionary& svg, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges) {
  const auto& poses = revision.solution.poses;
  std::size_t longest = 0;
  for (const SensorPose& pose : poses) longest = std::max(longest, std::min(pose.sensor.str().size(), kNameMax));
  const RingSize size = RingSizeOf(poses.size(), longest);
  const auto places = RingPlaces(poses, revision.reference, size);
  svg.SetValue("WIDTH", Fixed(size.width_px, 0));
  svg.SetValue("HEIGHT", Fixed(HeightOf(places, size), 0));
  Ring ring{svg,
            places,
            poses.size() <= kNamedMax,
            UncheckedPartsOf(revision),
            InformationScale(edges),
            ContradictionsOf(revision.solution.suspects)};
  for (const auto& [sensor, place] : ring.places) ring.tags.Block(place, {26, 26});
  PlaceLinks(ring, edges);
  for (const auto& [shown, curve] : ring.links) DrawLink(ring, *shown, curve);
  const bool tagged = ring.named && ring.links.size() <= kTagsMax;
  for (const auto& [shown, curve] : ring.links)
    if (tagged || ring.contradictions.suspects.contains(shown->edge->id)) DrawTag(ring, *shown, curve);
  const Eigen::Vector2d centre(size.width_px / 2, size.height_px / 2);
  for (const SensorPose& pose : poses) DrawNode(ring, pose, pose.sensor == revision.reference, centre);
  if (!ring.named) return "Too many sensors for names: touch or point at a dot or a line to read what it is.";
  return tagged ? "Numbers are the largest \xCF\x83 of an edge's position. Select an edge to read about it."
                : "Touch or point at an edge to read its \xCF\x83; select it to read about it.";
}

}  // namespace rigcal::report
