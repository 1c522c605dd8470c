#include "server/formats/sessions/target_yaml.h"

#include <optional>
#include <string>
#include <utility>

#include "server/formats/yaml/yaml_values.h"

namespace rigcal::formats {
namespace {

constexpr double kQuietZone_ratio = 0.3;  // of a single tag's side

void ReadCounts(const YamlField& target, const char* key, int less, Target& board) {
  const YamlField field = target.At(key);
  const std::vector<YamlField> counts = field.Items();
  if (counts.size() != 2) return field.Refuse("must be two numbers, [columns, rows]");
  board.cols = static_cast<int>(counts[0].Integer(1, 1000)) - less;
  board.rows = static_cast<int>(counts[1].Integer(1, 1000)) - less;
}

void ReadSize(const YamlField& target, const char* key, const char* sigma_key, Target& board) {
  board.square_m = target.At(key).Number();
  if (const auto sigma = target.Find(sigma_key)) board.square_sigma_m = sigma->Number();
}

void ReadCheckerboard(const YamlField& field, Target& board) {
  ReadCounts(field, "inner_corners", 0, board);
  ReadSize(field, "square_size_m", "square_size_sigma_m", board);
}

// Of all markers, or of the first where the others follow. 0, 1, 2, ... is what boards have that name none.
void ReadMarkerIds(const YamlField& field, Target& board) {
  const auto first = field.Find("first_id"), all = field.Find("ids");
  if (first && all) return first->Refuse("is given beside ids", "Give one of them.");
  if (all)
    for (const YamlField& id : all->Items()) board.marker_ids.push_back(static_cast<int>(id.Integer(0, 9999)));
  if (const int id = first ? static_cast<int>(first->Integer(0, 9999)) : 0; id > 0)
    for (int i = 0; i < MarkerCountOf(board); ++i) board.marker_ids.push_back(id + i);
  if (std::vector<int> ids = std::exchange(board.marker_ids, {}); ids != MarkerIdsOf(board)) board.marker_ids = ids;
}

// People count the squares of a ChArUco board; its points are the inner corners.
void ReadCharuco(const YamlField& field, Target& board) {
  ReadCounts(field, "squares", 1, board);
  ReadSize(field, "square_size_m", "square_size_sigma_m", board);
  board.marker_m = field.At("marker_size_m").Number();
  board.dictionary = field.At("dictionary").Text();
  ReadMarkerIds(field, board);
  if (const auto legacy = field.Find("legacy_layout")) {
    board.legacy_layout = legacy->Text() == "true";
    if (!board.legacy_layout && legacy->Text() != "false") legacy->Refuse("must be true or false");
  }
}

void ReadTagGrid(const YamlField& field, Target& board) {
  ReadCounts(field, "tags", 0, board);
  ReadSize(field, "tag_size_m", "tag_size_sigma_m", board);
  const bool is_single = MarkerCountOf(board) == 1;  // has no gaps, and some white about it
  if (const auto ratio = is_single ? field.Find("spacing_ratio") : field.At("spacing_ratio"))
    board.spacing_ratio = ratio->Number();
  else
    board.spacing_ratio = kQuietZone_ratio;
  board.dictionary = "DICT_APRILTAG_36h11";
  const bool is_april = board.kind == TargetKind::kAprilGrid;
  if (const auto given = is_april ? field.Find("dictionary") : field.At("dictionary")) board.dictionary = given->Text();
  ReadMarkerIds(field, board);
}

void ReadCircleGrid(const YamlField& field, Target& board) {
  ReadCounts(field, "circles", 0, board);
  ReadSize(field, "spacing_m", "spacing_sigma_m", board);
  board.diameter_m = field.At("diameter_m").Number();
}

TargetKind ReadKind(const YamlField& field, const std::optional<TargetKind>& otherwise) {
  const auto given = otherwise ? field.Find("type") : field.At("type");
  if (!given) return *otherwise;
  if (const Result<TargetKind> kind = TargetKindOf(given->Text())) return *kind;
  given->Refuse("is not known here",
                "This version knows checkerboard, charuco, aruco_grid, april_grid, circle_grid and "
                "asymmetric_circle_grid.");
  return TargetKind::kCheckerboard;
}

std::vector<std::string_view> KeysOf(TargetKind kind) {
  if (kind == TargetKind::kCheckerboard) return {"inner_corners", "square_size_m", "square_size_sigma_m"};
  if (kind == TargetKind::kCharuco)
    return {"squares",  "square_size_m", "square_size_sigma_m", "marker_size_m", "dictionary",
            "first_id", "ids",           "legacy_layout"};
  if (IsTagGrid(kind))
    return {"tags", "tag_size_m", "tag_size_sigma_m", "spacing_ratio", "dictionary", "first_id", "ids"};
  return {"circles", "spacing_m", "spacing_sigma_m", "diameter_m"};
}

void AllowKeys(const YamlField& field, TargetKind kind, const std::vector<std::string_view>& beside) {
  std::vector<std::string_view> keys = {"type", "serial", "plate_size_m", "plate_offset_m", "mounted_on"};
  for (const auto& more : {KeysOf(kind), beside}) keys.insert(keys.end(), more.begin(), more.end());
  field.AllowOnly(keys);
}

}  // namespace

Target ReadTarget(const YamlField& field, const TargetRules& rules) {
  Target board;
  board.id = TargetId(field.Key());
  board.kind = ReadKind(field, rules.otherwise);
  AllowKeys(field, board.kind, rules.beside);
  if (board.kind == TargetKind::kCheckerboard) ReadCheckerboard(field, board);
  if (board.kind == TargetKind::kCharuco) ReadCharuco(field, board);
  if (IsTagGrid(board.kind)) ReadTagGrid(field, board);
  if (IsCircleGrid(board.kind)) ReadCircleGrid(field, board);
  if (const auto serial = field.Find("serial")) board.serial = serial->Text();
  if (const auto plate = field.Find("plate_size_m")) plate->Numbers(board.plate_m.emplace().data(), 2);
  if (const auto offset = field.Find("plate_offset_m")) offset->Numbers(board.plate_offset_m.emplace().data(), 2);
  if (const auto carrier = field.Find("mounted_on")) board.mounted_on = ReadId<SensorId>(*carrier);
  if (const Status valid = Validate(board); !valid) field.Refuse(valid.error());
  return board;
}

}  // namespace rigcal::formats
