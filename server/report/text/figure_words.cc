#include "server/report/text/figure_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string_view>

#include "server/model/edges/merged_edge.h"
#include "server/model/edges/method.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

// One row: its first figure decides whether it is shown. "{a}" and "{b}" are the edge's sensors.
struct Word {
  const char* name;
  enum Shape { kEach, kWithSigma, kOutOf } shape;
  std::array<const char*, 2> figures;
};

constexpr std::array kWords = {
    Word{"Captures used", Word::kOutOf, {"captures_used", "captures_total"}},
    Word{"Captures", Word::kEach, {"captures_total", ""}},
    Word{"Samples used", Word::kEach, {"samples_used", ""}},
    Word{"Earlier edges in it", Word::kEach, {kMergedEdges, ""}},
    Word{"Earlier sessions in it", Word::kEach, {kMergedSessions, ""}},
    Word{"Captures with the board in both pictures", Word::kEach, {"captures_both", ""}},
    Word{"Files of {a} that show a board", Word::kOutOf, {"files_with_board_a", "files_a"}},
    Word{"Files of {b} that show a board", Word::kOutOf, {"files_with_board_b", "files_b"}},
    Word{"Files of {a} that cannot be read", Word::kEach, {"files_unreadable_a", ""}},
    Word{"Files of {b} that cannot be read", Word::kEach, {"files_unreadable_b", ""}},
    Word{"Positions of {a}, longest step", Word::kEach, {"positions_step_a_m", ""}},
    Word{"Positions of {b}, longest step", Word::kEach, {"positions_step_b_m", ""}},
    Word{"Boards before {a} turned apart by at most", Word::kEach, {"board_tilt_a_rad", ""}},
    Word{"Boards before {b} turned apart by at most", Word::kEach, {"board_tilt_b_rad", ""}},
    Word{"Reprojection error, rms", Word::kEach, {"rms_px", ""}},
    Word{"Reprojection error in {a}, rms", Word::kEach, {"rms_a_px", ""}},
    Word{"Reprojection error in {b}, rms", Word::kEach, {"rms_b_px", ""}},
    Word{"Reprojection error in {a} alone as pinhole_radtan, rms", Word::kEach, {"rms_as_pinhole_radtan_a_px", ""}},
    Word{"Reprojection error in {b} alone as pinhole_radtan, rms", Word::kEach, {"rms_as_pinhole_radtan_b_px", ""}},
    Word{"Reprojection error in {a} alone as pinhole_rational, rms", Word::kEach, {"rms_as_pinhole_rational_a_px", ""}},
    Word{"Reprojection error in {b} alone as pinhole_rational, rms", Word::kEach, {"rms_as_pinhole_rational_b_px", ""}},
    Word{"Reprojection error in {a} alone as fisheye_kb4, rms", Word::kEach, {"rms_as_fisheye_kb4_a_px", ""}},
    Word{"Reprojection error in {b} alone as fisheye_kb4, rms", Word::kEach, {"rms_as_fisheye_kb4_b_px", ""}},
    Word{"Board in the cloud off the board in the picture, rms",
         Word::kEach,
         {"plane_distance_rms_m", "plane_angle_rms_rad"}},
    Word{"Points on boards", Word::kEach, {"points_used", ""}},
    Word{"Noise of one range of {b}", Word::kEach, {"range_sigma_m", ""}},
    Word{"Error that the points of one capture share", Word::kEach, {"capture_sigma_m", ""}},
    Word{"Ranges too short by", Word::kWithSigma, {"range_bias_m", "range_bias_sigma_m"}},
    Word{"Squares of the board as given", Word::kEach, {"board_square_m", ""}},
    Word{"Boards larger than given by", Word::kWithSigma, {"board_scale_ratio", "board_scale_sigma_ratio"}},
    Word{"Motions of {a} and {b} differ by, rms", Word::kEach, {"motion_rms_m", "motion_rms_rad"}},
    Word{"Noise of one pose of {a}", Word::kEach, {"noise_a_m", "noise_a_rad"}},
    Word{"Noise of one pose of {b}", Word::kEach, {"noise_b_m", "noise_b_rad"}},
    Word{"Turned about the main axis, rms", Word::kEach, {"turn_rad", ""}},
    Word{"Tilted away from the main axis, rms", Word::kWithSigma, {"tilt_rad", "tilt_noise_rad"}},
    Word{"Main axis in {a}: x", Word::kEach, {"axis_a_x_ratio", ""}},
    Word{"Main axis in {a}: y", Word::kEach, {"axis_a_y_ratio", ""}},
    Word{"Main axis in {a}: z", Word::kEach, {"axis_a_z_ratio", ""}},
    Word{"Clock of {a} ahead of {b} by", Word::kWithSigma, {"clock_offset_s", "clock_offset_sigma_s"}},
    Word{"Offset of surfaces in captures left out, E_l", Word::kEach, {"held_out_captures_E_l_m", ""}},
    Word{"Points off surfaces in captures left out, rms", Word::kEach, {"held_out_captures_E_l_rms_m", ""}},
    Word{"Normals of surfaces in captures left out, D",
         Word::kEach,
         {"held_out_captures_D_ratio", "held_out_captures_D_angle_rad"}},
    Word{"Cells behind E_l", Word::kEach, {"held_out_captures_pairs", ""}},
    Word{"Cells behind D", Word::kEach, {"held_out_captures_normals", ""}},
    Word{"Offset of surfaces in the half left out, E_l", Word::kEach, {"held_out_halves_E_l_m", ""}},
    Word{"Points off surfaces in the half left out, rms", Word::kEach, {"held_out_halves_E_l_rms_m", ""}},
    Word{"Normals of surfaces in the half left out, D",
         Word::kEach,
         {"held_out_halves_D_ratio", "held_out_halves_D_angle_rad"}},
    Word{"Cells behind E_l", Word::kEach, {"held_out_halves_pairs", ""}},
    Word{"Cells behind D", Word::kEach, {"held_out_halves_normals", ""}},
    Word{"Answers from either half differ by", Word::kEach, {"halves_differ_m", "halves_differ_rad"}},
    Word{"Points that lie on the other's surfaces", Word::kEach, {"match_ratio", ""}},
    Word{"Overlap of the clouds", Word::kEach, {"overlap_ratio", ""}},
    Word{"Starts that end at this pose", Word::kEach, {"starts_agreeing_ratio", ""}},
    Word{"GICP differs from NDT by", Word::kEach, {"polish_moved_m", "polish_moved_rad"}},
    Word{"Answer from", Word::kEach, {"polished_ratio", ""}},
    Word{"Finest cell of NDT", Word::kEach, {"voxel_m", ""}},
    Word{"\xCF\x83 from captures over \xCF\x83 from the model", Word::kEach, {"model_sigma_ratio", ""}},
    Word{"Steps of the solution", Word::kEach, {"iterations", ""}},
};

bool IsPercent(std::string_view figure) {
  constexpr std::array<std::string_view, 5> kPercent = {"match_ratio", "overlap_ratio", "starts_agreeing_ratio",
                                                        "board_scale_ratio", "board_scale_sigma_ratio"};
  return std::find(kPercent.begin(), kPercent.end(), figure) != kPercent.end();
}

std::string ValueText(const std::string& figure, double value) {
  if (figure == "polished_ratio") return value > 0 ? "GICP" : "NDT";
  if (IsPercent(figure)) return Significant(100 * value, 3) + " %";
  return FigureValue(figure, value);
}

std::string NameOf(const Word& word, const Edge& edge) {
  std::string name = word.name;
  for (const auto& [mark, sensor] : {std::pair{"{a}", edge.frame_a.str()}, std::pair{"{b}", edge.frame_b.str()}})
    if (const auto at = name.find(mark); at != std::string::npos) name.replace(at, 3, sensor);
  return name;
}

// As many decimals as sigma has with two digits, so that both read as one number.
std::string WithSigma(const std::string& figure, double value, double sigma) {
  const FigureUnit unit = IsPercent(figure) ? FigureUnit{" %", 100.0} : UnitOfFigure(figure);
  return AsCertainAs(value * unit.scale, sigma * unit.scale) + " \xC2\xB1 " + Significant(sigma * unit.scale, 2) +
         unit.shown;
}

std::string RowText(const Word& word, const std::map<std::string, double>& figures) {
  const auto first = figures.find(word.figures[0]), second = figures.find(word.figures[1]);
  std::string text = ValueText(first->first, first->second);
  if (second == figures.end()) return text;
  if (word.shape == Word::kOutOf) return text + " of " + Fixed(second->second, 0);
  if (word.shape == Word::kWithSigma) return WithSigma(first->first, first->second, second->second);
  return text + ", " + ValueText(second->first, second->second);
}

constexpr std::string_view kLensFirst = "fckps";  // first letters, in the order in which they are shown

// fx_px, k1_a_ratio: a parameter of a lens, perhaps of one of the two.
bool IsLens(const std::string& figure) {
  return figure.size() > 3 && kLensFirst.find(figure[0]) != std::string_view::npos &&
         (figure[1] == 'x' || figure[1] == 'y' || std::isdigit(static_cast<unsigned char>(figure[1])) != 0) &&
         figure[2] == '_';
}

std::string LensName(const std::string& figure, const Edge& edge) {
  const std::string name = figure.substr(0, 2);
  if (figure.compare(2, 3, "_a_") == 0) return name + " of " + edge.frame_a.str();
  return figure.compare(2, 3, "_b_") == 0 ? name + " of " + edge.frame_b.str() : name;
}

// Both 0: the captures could not tell them apart, and they mean nothing.
bool MeansNothing(const Word& word, const std::map<std::string, double>& figures) {
  if (word.shape != Word::kWithSigma) return false;
  const auto sigma = figures.find(word.figures[1]);
  return sigma != figures.end() && sigma->second == 0.0 && figures.at(word.figures[0]) == 0.0;
}

}  // namespace

FigureRows RowsOf(const Edge& edge) {
  FigureRows rows;
  std::set<std::string> told;
  for (const Word& word : kWords) {
    if (!edge.figures.contains(word.figures[0]) || told.contains(word.figures[0])) continue;
    for (const char* figure : word.figures) told.insert(figure);
    if (!MeansNothing(word, edge.figures)) rows.checks.push_back({NameOf(word, edge), RowText(word, edge.figures)});
  }
  for (const auto& [figure, value] : edge.figures) {
    if (told.contains(figure) || figure.ends_with("_idx")) continue;  // a place in a list is for programs
    if (IsLens(figure))
      rows.lens.push_back({LensName(figure, edge), AsCertainAs(value, 0.0) + UnitOfFigure(figure).shown});
    else
      rows.checks.push_back({FigureName(figure), FigureValue(figure, value)});
  }
  const auto place = [](const FigureRow& row) { return kLensFirst.find(row.name[0]); };
  std::stable_sort(rows.lens.begin(), rows.lens.end(),
                   [&](const FigureRow& a, const FigureRow& b) { return place(a) < place(b); });
  return rows;
}

std::string MethodText(const std::string& method) {
  const std::optional<Method> ours = MethodNamed(method);
  return ours ? std::string(RowOf(*ours).label) : method;
}

bool IsPolished(const Edge& edge) {
  const auto polished = edge.figures.find("polished_ratio");
  return polished != edge.figures.end() && polished->second > 0;
}

std::string MethodText(const Edge& edge) {
  for (const char* kind : {kMergedEdges, kMergedSessions})
    if (const auto merged = edge.figures.find(kind); merged != edge.figures.end())
      return MethodText(edge.method) + ", " + std::to_string(static_cast<int>(merged->second)) + " earlier ones as one";
  return MethodText(edge.method) + (IsPolished(edge) ? ", polished by GICP" : "");
}

}  // namespace rigcal::report
