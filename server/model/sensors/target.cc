#include "server/model/sensors/target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <string_view>

#include "server/base/text.h"
#include "server/model/named.h"

namespace rigcal {
namespace {

constexpr int kCornersMin = 3, kCharucoCornersMin = 1, kTagsMin = 1, kCirclesMin = 3, kCountMax = 100;
// Diameter of a circle over the distance of the nearest two centres: below, there is little to measure; above, too
// little white between two circles to tell them apart.
constexpr double kDiameterMin_ratio = 0.1, kDiameterMax_ratio = 0.85;
constexpr double kSquareMin_m = 0.001, kSquareMax_m = 1.0;
constexpr double kPlateMax_m = 10.0;
struct Dictionary {
  std::string_view name;
  int count;  // of its markers
};
constexpr std::array kDictionaries = {
    Dictionary{"DICT_4X4_50", 50},           Dictionary{"DICT_4X4_100", 100},
    Dictionary{"DICT_4X4_250", 250},         Dictionary{"DICT_4X4_1000", 1000},
    Dictionary{"DICT_5X5_50", 50},           Dictionary{"DICT_5X5_100", 100},
    Dictionary{"DICT_5X5_250", 250},         Dictionary{"DICT_5X5_1000", 1000},
    Dictionary{"DICT_6X6_50", 50},           Dictionary{"DICT_6X6_100", 100},
    Dictionary{"DICT_6X6_250", 250},         Dictionary{"DICT_6X6_1000", 1000},
    Dictionary{"DICT_7X7_50", 50},           Dictionary{"DICT_7X7_100", 100},
    Dictionary{"DICT_7X7_250", 250},         Dictionary{"DICT_7X7_1000", 1000},
    Dictionary{"DICT_ARUCO_ORIGINAL", 1024}, Dictionary{"DICT_APRILTAG_16h5", 30},
    Dictionary{"DICT_APRILTAG_25h9", 35},    Dictionary{"DICT_APRILTAG_36h10", 2320},
    Dictionary{"DICT_APRILTAG_36h11", 587},
};

const Dictionary* DictionaryOf(const std::string& name) {
  const auto known = std::find_if(kDictionaries.begin(), kDictionaries.end(),
                                  [&](const Dictionary& dictionary) { return dictionary.name == name; });
  return known == kDictionaries.end() ? nullptr : &*known;
}

// What dictionaries of one family have in common: the smaller one is the beginning of the larger one.
std::string_view FamilyOf(std::string_view dictionary) {
  const std::size_t last = dictionary.find_last_of('_');
  const bool is_counted =
      last != std::string_view::npos && dictionary.find_first_not_of("0123456789", last + 1) == std::string_view::npos;
  return is_counted ? dictionary.substr(0, last) : dictionary;
}

Status Refuse(const Target& target, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, "target " + target.id.str() + ": " + what, cure);
}

bool HasCorners(TargetKind kind) { return kind == TargetKind::kCheckerboard || kind == TargetKind::kCharuco; }

std::string SizeText(const Target& target) {
  return std::to_string(target.cols) + "x" + std::to_string(target.rows) + " " + CountedOf(target.kind);
}

// A pose needs six points, or the four corners of a tag.
Status CheckEnough(const Target& target) {
  constexpr int kPointsMin = 6;
  if (IsTagGrid(target.kind) || target.cols * target.rows >= kPointsMin) return {};
  return Refuse(target, SizeText(target) + " are too few for a pose",
                "Use a board with " + std::to_string(kPointsMin) + " or more.");
}

Status CheckCounts(const Target& target) {
  const int count_min = IsTagGrid(target.kind)                ? kTagsMin
                        : IsCircleGrid(target.kind)           ? kCirclesMin
                        : target.kind == TargetKind::kCharuco ? kCharucoCornersMin
                                                              : kCornersMin;
  for (int count : {target.cols, target.rows})
    if (count < count_min || count > kCountMax)
      return Refuse(target, SizeText(target) + " is out of range",
                    std::string(HasCorners(target.kind) ? "Count the corners where four squares meet, "
                                                        : "Count the " + std::string(CountedOf(target.kind)) + ", ") +
                        std::to_string(count_min) + " to " + std::to_string(kCountMax) + " each way.");
  return CheckEnough(target);
}

// With an even number of rows it looks the same turned by half, which nothing but its shifted rows is there to prevent;
// it is also what [rows, columns] looks like.
Status CheckShiftedRows(const Target& target) {
  if (target.kind != TargetKind::kAsymmetricCircleGrid || target.rows % 2 == 1) return {};
  const std::string counts = "[" + std::to_string(target.rows) + ", " + std::to_string(target.cols) + "]";
  return Refuse(target,
                "an asymmetric circle grid with an even number of rows (" + std::to_string(target.rows) +
                    ") looks the same turned by half",
                "Every other row is shifted: count the circles of one row, then the rows" +
                    (target.cols % 2 == 1 ? "; were circles: " + counts + " meant?"
                                          : std::string(", of which there have to be an odd number."
                                                        " Cover a row, or use another board.")));
}

double NearestCircles_m(const Target& target) {
  return target.square_m * (target.kind == TargetKind::kAsymmetricCircleGrid ? std::sqrt(2.0) : 1.0);
}

Status CheckDiameter(const Target& target) {
  if (!IsCircleGrid(target.kind)) return {};
  const double ratio = target.diameter_m / NearestCircles_m(target);
  if (ratio >= kDiameterMin_ratio && ratio <= kDiameterMax_ratio) return {};
  return Refuse(
      target,
      "diameter_m " + std::to_string(target.diameter_m) + " does not fit spacing_m " + std::to_string(target.square_m) +
          ": " +
          (ratio > 1                    ? "its circles would overlap"
           : ratio > kDiameterMax_ratio ? "there would be too little between two circles to tell them apart"
                                        : "its circles would be too small to be measured"),
      target.kind == TargetKind::kAsymmetricCircleGrid
          ? "Give the diameter of a circle and, as spacing_m, the distance from one row to the next, which is "
            "half of the distance of neighbours in a row; both in metres."
          : "Give the diameter of a circle, and as spacing_m the distance from centre to centre, in metres.");
}

Status CheckSquare(const Target& target) {
  const std::string name = SizeFieldOf(target.kind) + std::string(" ");
  if (!(target.square_m >= kSquareMin_m && target.square_m <= kSquareMax_m))
    return Refuse(target, name + std::to_string(target.square_m) + " is out of range",
                  std::string("Give the measured ") + (IsCircleGrid(target.kind) ? "distance" : "side") +
                      " in metres, 0.001 to 1.");
  if (!(target.square_sigma_m >= 0.0 && target.square_sigma_m < target.square_m / 2))
    return Refuse(target,
                  "the standard deviation of " + name + "is out of range: " + std::to_string(target.square_sigma_m),
                  "Give it in metres, or 0 if the size is exact.");
  return {};
}

Status CheckMarkers(const Target& target) {
  const bool known = DictionaryOf(target.dictionary) != nullptr;
  if (target.kind == TargetKind::kCheckerboard || IsCircleGrid(target.kind)) {
    if (target.dictionary.empty()) return {};
    return IsCircleGrid(target.kind)
               ? Refuse(target, "a grid of circles has no dictionary", "Leave 'dictionary' away.")
               : Refuse(target, "a checkerboard has no dictionary", "Use type charuco, or leave 'dictionary' away.");
  }
  if (!known || target.dictionary.empty())
    return Refuse(target, "dictionary " + Quoted(target.dictionary) + " is not known",
                  "Name the markers' dictionary as OpenCV does, such as DICT_4X4_50 or DICT_APRILTAG_36h11.");
  if (target.kind == TargetKind::kCharuco && !(target.marker_m > 0 && target.marker_m < target.square_m))
    return Refuse(target, "marker_size_m " + std::to_string(target.marker_m) + " is out of range",
                  "Give the side of a marker in metres; it is smaller than a square.");
  if (IsTagGrid(target.kind) && !(target.spacing_ratio > 0 && target.spacing_ratio <= 10))
    return Refuse(target, "spacing_ratio " + std::to_string(target.spacing_ratio) + " is out of range",
                  "Give the gap between two tags divided by the side of a tag, above 0.");
  return {};
}

Status CheckMarkerIds(const Target& target) {
  const std::vector<int>& ids = target.marker_ids;
  if (ids.empty()) return {};
  const int count = MarkerCountOf(target);
  if (count == 0)
    return Refuse(target, "a " + NameOf(target.kind) + " has no markers with ids", "Leave 'ids' and 'first_id' away.");
  if (ids.size() != static_cast<std::size_t>(count))
    return Refuse(target, std::to_string(ids.size()) + " ids are given for " + std::to_string(count) + " markers",
                  "Name the id of every marker, in the order in which they are numbered, or only the first: first_id.");
  const Dictionary* dictionary = DictionaryOf(target.dictionary);  // CheckMarkers has seen that it is one
  std::set<int> known;
  for (const int id : ids) {
    if (id < 0 || id >= dictionary->count)
      return Refuse(target, "marker id " + std::to_string(id) + " is not in " + target.dictionary,
                    "It has the ids 0 to " + std::to_string(dictionary->count - 1) + ".");
    if (!known.insert(id).second)
      return Refuse(target, "marker id " + std::to_string(id) + " is given twice", "No two markers may share an id.");
  }
  return {};
}

// The pattern may reach a little over the plate's edge, by how well people measure.
Status CheckPlateOffset(const Target& target) {
  if (!target.plate_offset_m) return {};
  if (!target.plate_m) return Refuse(target, "plate_offset_m is given without plate_size_m", "Give plate_size_m, too.");
  const Eigen::Vector2d pattern_m = PatternSize_m(target);
  for (int axis : {0, 1}) {
    const double offset_m = (*target.plate_offset_m)[axis], margin_m = ((*target.plate_m)[axis] - pattern_m[axis]) / 2;
    if (!(std::abs(offset_m) <= std::max(margin_m, 0.0) + 0.01 * pattern_m[axis]))
      return Refuse(target,
                    "plate_offset_m " + std::to_string(offset_m) + " would leave its pattern beyond the plate's edge",
                    "Give [x, y] from the middle of the pattern to the middle of the plate in metres, x along the "
                    "columns, y along the rows.");
  }
  return {};
}

Status CheckPlate(const Target& target) {
  RIGCAL_TRY(CheckPlateOffset(target));
  if (!target.plate_m) return {};
  const Eigen::Vector2d pattern_m = PatternSize_m(target);
  for (int axis : {0, 1})
    if (!((*target.plate_m)[axis] >= 0.99 * pattern_m[axis] && (*target.plate_m)[axis] <= kPlateMax_m))
      return Refuse(target,
                    "plate_size_m " + std::to_string((*target.plate_m)[axis]) + " does not fit its pattern, which is " +
                        std::to_string(pattern_m[axis]) + " m there",
                    "Give [width, height] of the plate in metres, width along the columns of the pattern.");
  return {};
}

}  // namespace

std::string NameOf(TargetKind kind) {
  switch (kind) {
    case TargetKind::kCheckerboard:
      return "checkerboard";
    case TargetKind::kCharuco:
      return "charuco";
    case TargetKind::kArucoGrid:
      return "aruco_grid";
    case TargetKind::kAprilGrid:
      return "april_grid";
    case TargetKind::kCircleGrid:
      return "circle_grid";
    case TargetKind::kAsymmetricCircleGrid:
      return "asymmetric_circle_grid";
  }
  return "checkerboard";
}

const char* CountedOf(TargetKind kind) {
  return IsTagGrid(kind) ? "tags" : IsCircleGrid(kind) ? "circles" : "inner corners";
}

const char* SizeFieldOf(TargetKind kind) {
  return IsTagGrid(kind) ? "tag_size_m" : IsCircleGrid(kind) ? "spacing_m" : "square_size_m";
}

Result<TargetKind> TargetKindOf(const std::string& name) {
  return ValueNamed(name,
                    {TargetKind::kCheckerboard, TargetKind::kCharuco, TargetKind::kArucoGrid, TargetKind::kAprilGrid,
                     TargetKind::kCircleGrid, TargetKind::kAsymmetricCircleGrid},
                    "target type",
                    "Use checkerboard, charuco, aruco_grid, april_grid, circle_grid or asymmetric_circle_grid.");
}

std::vector<Eigen::Vector3d> TargetPoints(const Target& target) {
  std::vector<Eigen::Vector3d> points;
  const double side_m = target.square_m;
  if (!IsTagGrid(target.kind)) {
    const bool shifted = target.kind == TargetKind::kAsymmetricCircleGrid;
    for (int r = 0; r < target.rows; ++r)
      for (int c = 0; c < target.cols; ++c)
        points.emplace_back((shifted ? 2 * c + r % 2 : c) * side_m, r * side_m, 0.0);
    return points;
  }
  const double pitch_m = side_m * (1 + target.spacing_ratio);
  for (int t = 0; t < target.cols * target.rows; ++t) {
    const int row = target.kind == TargetKind::kAprilGrid ? target.rows - 1 - t / target.cols : t / target.cols;
    const Eigen::Vector3d corner(t % target.cols * pitch_m, row * pitch_m, 0.0);
    points.push_back(corner);
    points.push_back(corner + Eigen::Vector3d(side_m, 0, 0));
    points.push_back(corner + Eigen::Vector3d(side_m, side_m, 0));
    points.push_back(corner + Eigen::Vector3d(0, side_m, 0));
  }
  return points;
}

Eigen::Vector2d PatternSize_m(const Target& target) {
  const Eigen::Vector2d counts(target.cols, target.rows);
  if (IsCircleGrid(target.kind)) {
    const double across = target.kind == TargetKind::kAsymmetricCircleGrid ? 2 * target.cols - 1 : target.cols - 1;
    return Eigen::Vector2d(across, target.rows - 1) * target.square_m + Eigen::Vector2d::Constant(target.diameter_m);
  }
  if (!IsTagGrid(target.kind)) return (counts.array() + 1) * target.square_m;
  return (counts.array() * (1 + target.spacing_ratio) - target.spacing_ratio) * target.square_m;
}

Eigen::Vector3d CentreOf(const Target& target) {
  const Eigen::Vector2d pattern_m = PatternSize_m(target);
  const double margin_m = IsTagGrid(target.kind)      ? 0.0
                          : IsCircleGrid(target.kind) ? target.diameter_m / 2
                                                      : target.square_m;
  return {pattern_m.x() / 2 - margin_m, pattern_m.y() / 2 - margin_m, 0.0};
}

Eigen::Vector3d PlateCentreOf(const Target& target) {
  Eigen::Vector3d centre_m = CentreOf(target);
  if (target.plate_offset_m) centre_m.head<2>() += *target.plate_offset_m;
  return centre_m;
}

int MarkerCountOf(const Target& target) {
  if (IsTagGrid(target.kind)) return target.cols * target.rows;
  return target.kind == TargetKind::kCharuco ? (target.cols + 1) * (target.rows + 1) / 2 : 0;
}

std::vector<int> MarkerIdsOf(const Target& target) {
  if (!target.marker_ids.empty()) return target.marker_ids;
  std::vector<int> ids(static_cast<std::size_t>(MarkerCountOf(target)));
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

int SymmetryOf(const Target& target) {
  if (target.kind == TargetKind::kCircleGrid) return target.cols == target.rows ? 4 : 2;
  if (target.kind != TargetKind::kCheckerboard || target.cols % 2 != target.rows % 2) return 1;
  return target.cols == target.rows && target.cols % 2 == 0 ? 4 : 2;
}

int TurnedIndex(const Target& target, int idx, int turn) {
  const int symmetry = SymmetryOf(target);
  int col = idx % target.cols, row = idx / target.cols;
  for (int step = 0; step < turn && symmetry > 1; ++step) {
    const int before = col;
    col = symmetry == 4 ? row : target.cols - 1 - col;
    row = symmetry == 4 ? target.cols - 1 - before : target.rows - 1 - row;
  }
  return row * target.cols + col;
}

bool LookAlike(const Target& a, const Target& b) {
  if (MarkerCountOf(a) > 0 && MarkerCountOf(b) > 0) {
    const std::vector<int> ids = MarkerIdsOf(a);
    const std::set<int> of_a(ids.begin(), ids.end());
    const std::vector<int> of_b = MarkerIdsOf(b);
    return FamilyOf(a.dictionary) == FamilyOf(b.dictionary) &&
           std::any_of(of_b.begin(), of_b.end(), [&](int id) { return of_a.contains(id); });
  }
  if (a.kind != b.kind || MarkerCountOf(a) != MarkerCountOf(b)) return false;
  const bool turns = a.kind != TargetKind::kAsymmetricCircleGrid;  // taken either way round
  return std::pair(a.cols, a.rows) == std::pair(b.cols, b.rows) ||
         (turns && std::pair(a.cols, a.rows) == std::pair(b.rows, b.cols));
}

Status Validate(const Target& target) {
  RIGCAL_TRY(CheckName(TargetTag::kKind, target.id.str()));
  RIGCAL_TRY(CheckCounts(target));
  RIGCAL_TRY(CheckShiftedRows(target));
  RIGCAL_TRY(CheckSquare(target));
  RIGCAL_TRY(CheckDiameter(target));
  RIGCAL_TRY(CheckMarkers(target));
  RIGCAL_TRY(CheckMarkerIds(target));
  RIGCAL_TRY(CheckPlate(target));
  if (target.serial.size() > 256 || !IsPrintableUtf8(target.serial))
    return Refuse(target, "serial " + Quoted(target.serial) + " is not one line of readable text",
                  "Use at most 256 bytes of UTF-8 without control characters.");
  return {};
}

}  // namespace rigcal
