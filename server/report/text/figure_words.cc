#include "server/report/text/figure_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <string_view>
#include <vector>

#include "server/model/edges/merged_edge.h"
#include "server/model/edges/method.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

enum class Shape { kEach, kWithSigma, kOutOf };

// One row: its first figure decides whether it is shown. "{a}" and "{b}" are the edge's sensors. With "{x}" it is two
// rows, one of either sensor; their figures have its letter in that place.
struct Word {
  std::string_view name;
  std::array<std::string_view, 2> figures;
  Shape shape = Shape::kEach;
};

// In the order in which they are shown.
constexpr Word kWords[] = {
    {"Captures used", {"captures_used", "captures_total"}, Shape::kOutOf},
    {"Captures", {"captures_total"}},
    {"Samples used", {"samples_used"}},
    {"Earlier edges in it", {kMergedEdges}},
    {"Earlier sessions in it", {kMergedSessions}},
    {"Captures with the board in both pictures", {"captures_both"}},
    {"Files of {x} that show a board", {"files_with_board_{x}", "files_{x}"}, Shape::kOutOf},
    {"Files of {x} that cannot be read", {"files_unreadable_{x}"}},
    {"Positions of {x}, longest step", {"positions_step_{x}_m"}},
    {"Boards before {x} turned apart by at most", {"board_tilt_{x}_rad"}},
    {"Reprojection error, rms", {"rms_px"}},
    {"Reprojection error in {x}, rms", {"rms_{x}_px"}},
    {"Reprojection error in {x} alone as session.yaml lists it, rms", {"rms_as_listed_{x}_px"}},
    {"Reprojection error in {x} alone as pinhole_radtan, rms", {"rms_as_pinhole_radtan_{x}_px"}},
    {"Reprojection error in {x} alone as pinhole_rational, rms", {"rms_as_pinhole_rational_{x}_px"}},
    {"Reprojection error in {x} alone as fisheye_kb4, rms", {"rms_as_fisheye_kb4_{x}_px"}},
    {"Board in the cloud off the board in the picture, rms", {"plane_distance_rms_m", "plane_angle_rms_rad"}},
    {"Points on boards", {"points_used"}},
    {"Noise of one range of {b}", {"range_sigma_m"}},
    {"Error that the points of one capture share", {"capture_sigma_m"}},
    {"Ranges too short by", {"range_bias_m", "range_bias_sigma_m"}, Shape::kWithSigma},
    {"Squares of the board as given", {"board_square_m"}},
    {"Boards larger than given by", {"board_scale_ratio", "board_scale_sigma_ratio"}, Shape::kWithSigma},
    {"Motions of {a} and {b} differ by, rms", {"motion_rms_m", "motion_rms_rad"}},
    {"Noise of one pose of {x}", {"noise_{x}_m", "noise_{x}_rad"}},
    {"Turned about the main axis, rms", {"turn_rad"}},
    {"Tilted away from the main axis, rms", {"tilt_rad", "tilt_noise_rad"}, Shape::kWithSigma},
    {"Main axis in {a}: x", {"axis_a_x_ratio"}},
    {"Main axis in {a}: y", {"axis_a_y_ratio"}},
    {"Main axis in {a}: z", {"axis_a_z_ratio"}},
    {"Clock of {a} ahead of {b} by", {"clock_offset_s", "clock_offset_sigma_s"}, Shape::kWithSigma},
    {"Offset of surfaces in captures left out, E_l", {"held_out_captures_E_l_m"}},
    {"Points off surfaces in captures left out, rms", {"held_out_captures_E_l_rms_m"}},
    {"Normals of surfaces in captures left out, D", {"held_out_captures_D_ratio", "held_out_captures_D_angle_rad"}},
    {"Cells behind E_l", {"held_out_captures_pairs"}},
    {"Cells behind D", {"held_out_captures_normals"}},
    {"Offset of surfaces in the half left out, E_l", {"held_out_halves_E_l_m"}},
    {"Points off surfaces in the half left out, rms", {"held_out_halves_E_l_rms_m"}},
    {"Normals of surfaces in the half left out, D", {"held_out_halves_D_ratio", "held_out_halves_D_angle_rad"}},
    {"Cells behind E_l", {"held_out_halves_pairs"}},
    {"Cells behind D", {"held_out_halves_normals"}},
    {"Answers from either half differ by", {"halves_differ_m", "halves_differ_rad"}},
    {"Points that lie on the other's surfaces", {"match_ratio"}},
    {"Overlap of the clouds", {"overlap_ratio"}},
    {"Starts that end at this pose", {"starts_agreeing_ratio"}},
    {"GICP differs from NDT by", {"polish_moved_m", "polish_moved_rad"}},
    {"Answer from", {"polished_ratio"}},
    {"Finest cell of NDT", {"voxel_m"}},
    {"\xCF\x83 from captures over \xCF\x83 from the model", {"model_sigma_ratio"}},
    {"Steps of the solution", {"iterations"}},
};

// A word in the edge's names.
struct EdgeWord {
  std::string name;
  std::array<std::string, 2> figures;
  Shape shape = Shape::kEach;
};

std::string Filled(std::string_view text, std::string_view mark, const std::string& with) {
  std::string filled(text);
  if (const auto at = filled.find(mark); at != std::string::npos) filled.replace(at, mark.size(), with);
  return filled;
}

std::vector<EdgeWord> WordsFor(const Edge& edge, const Word& word) {
  const std::string a = edge.frame_a.str(), b = edge.frame_b.str();
  const auto of = [&](const std::string& letter, const std::string& sensor) -> EdgeWord {
    return {Filled(Filled(Filled(word.name, "{x}", sensor), "{a}", a), "{b}", b),
            {Filled(word.figures[0], "{x}", letter), Filled(word.figures[1], "{x}", letter)},
            word.shape};
  };
  if (word.name.find("{x}") == std::string_view::npos) return {of("", "")};
  return {of("a", a), of("b", b)};
}

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

// As many decimals as sigma has with two digits, so that both read as one number.
std::string WithSigma(const std::string& figure, double value, double sigma) {
  const FigureUnit unit = IsPercent(figure) ? FigureUnit{" %", 100.0} : UnitOfFigure(figure);
  return AsCertainAs(value * unit.scale, sigma * unit.scale) + " \xC2\xB1 " + Significant(sigma * unit.scale, 2) +
         unit.shown;
}

std::string RowText(const EdgeWord& word, const std::map<std::string, double>& figures) {
  const auto first = figures.find(word.figures[0]), second = figures.find(word.figures[1]);
  std::string text = ValueText(first->first, first->second);
  if (second == figures.end()) return text;
  if (word.shape == Shape::kOutOf) return text + " of " + Fixed(second->second, 0);
  if (word.shape == Shape::kWithSigma) return WithSigma(first->first, first->second, second->second);
  return text + ", " + ValueText(second->first, second->second);
}

constexpr std::string_view kLensFirst = "fckpsxab";  // first letters, in the order in which they are shown

// fx_px, k1_a_ratio, alpha_ratio: a parameter of a lens, perhaps of one of the two.
bool IsLens(const std::string& figure) {
  const std::string name = figure.substr(0, figure.find('_'));
  if (name == "xi" || name == "alpha" || name == "beta") return true;
  return figure.size() > 3 && name.size() == 2 && kLensFirst.find(name[0]) != std::string_view::npos &&
         (name[1] == 'x' || name[1] == 'y' || std::isdigit(static_cast<unsigned char>(name[1])) != 0);
}

std::string LensName(const std::string& figure, const Edge& edge) {
  const std::size_t end = figure.find('_');
  const std::string name = figure.substr(0, end);
  if (end == figure.npos) return name;
  if (figure.compare(end, 3, "_a_") == 0) return name + " of " + edge.frame_a.str();
  return figure.compare(end, 3, "_b_") == 0 ? name + " of " + edge.frame_b.str() : name;
}

// Both 0: the captures could not tell them apart, and they mean nothing.
bool MeansNothing(const EdgeWord& word, const std::map<std::string, double>& figures) {
  if (word.shape != Shape::kWithSigma) return false;
  const auto sigma = figures.find(word.figures[1]);
  return sigma != figures.end() && sigma->second == 0.0 && figures.at(word.figures[0]) == 0.0;
}

}  // namespace

FigureRows RowsOf(const Edge& edge) {
  FigureRows rows;
  std::set<std::string> told;
  for (const Word& words : kWords) {
    for (const EdgeWord& word : WordsFor(edge, words)) {
      if (!edge.figures.contains(word.figures[0]) || told.contains(word.figures[0])) continue;
      told.insert(word.figures.begin(), word.figures.end());
      if (!MeansNothing(word, edge.figures)) rows.checks.push_back({word.name, RowText(word, edge.figures)});
    }
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
