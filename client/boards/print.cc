#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "client/boards/options.h"
#include "client/print/pdf.h"
#include "client/print/sheet_words.h"
#include "client/print/svg.h"
#include "client/verbs.h"
#include "server/base/files/durable_file.h"

namespace rigcal::client {
namespace {

constexpr double kMarkerOfSquare_ratio = 0.75, kSpacing_ratio = 0.3;
constexpr double kDiameterOfSpacing_ratio = 0.5, kAsymmetricDiameter_ratio = 0.7;

void RequirePrintOptions(const BoardOptions& options) {
  for (const auto& [is_there, name] :
       {std::pair(!options.type.empty(), "--type"), std::pair(options.cols.has_value(), "--cols"),
        std::pair(options.rows.has_value(), "--rows"), std::pair(options.square_mm.has_value(), "--square-mm"),
        std::pair(!options.serial.empty() || !options.serial_to_print.empty(), "--serial"),
        std::pair(!options.out.empty(), "--out")})
    if (!is_there) throw CLI::RequiredError(name);
}

// The smallest with enough markers: fewer codes are less easily mistaken for each other.
std::string CharucoDictionary(const BoardPattern& pattern, int first_id) {
  const TypedCounts counts = TypedCountsOf(pattern);
  const int markers = (counts.cols * counts.rows + 1) / 2;
  for (const auto& [size, name] :
       {std::pair(50, "DICT_5X5_50"), std::pair(100, "DICT_5X5_100"), std::pair(250, "DICT_5X5_250")})
    if (first_id + markers <= size) return name;
  return "DICT_5X5_1000";
}

std::string DefaultDictionary(const BoardPattern& pattern, int first_id) {
  if (pattern.kind == TargetKind::kCheckerboard || IsCircleGrid(pattern.kind)) return "";
  if (pattern.kind == TargetKind::kAprilGrid) return "DICT_APRILTAG_36h11";
  return pattern.kind == TargetKind::kCharuco ? CharucoDictionary(pattern, first_id) : "DICT_6X6_250";
}

// Boards that count from 0 need not say so.
Status NumberFrom(const std::optional<int>& first_id, Target& target) {
  if (!first_id) return {};
  if (MarkerCountOf(target) == 0)
    return Fail(ErrorCode::kInvalidInput, "a " + NameOf(target.kind) + " has no markers with ids",
                "Leave --first-id away.");
  for (int i = 0; *first_id > 0 && i < MarkerCountOf(target); ++i) target.marker_ids.push_back(*first_id + i);
  return {};
}

Result<Target> TargetToPrint(const BoardOptions& options) {
  RIGCAL_ASSIGN(const TargetKind kind, BoardTypeOf(options.type));
  const BoardPattern pattern = PatternTyped(kind, *options.cols, *options.rows, *options.square_mm / 1000);
  Target target;
  target.id = TargetId("board");
  target.kind = kind;
  target.cols = pattern.cols, target.rows = pattern.rows, target.square_m = pattern.square_m;
  target.serial = options.serial.empty() ? options.serial_to_print : options.serial;
  target.dictionary =
      options.dictionary.empty() ? DefaultDictionary(pattern, options.first_id.value_or(0)) : options.dictionary;
  if (kind == TargetKind::kCharuco)
    target.marker_m = options.marker_mm ? *options.marker_mm / 1000 : kMarkerOfSquare_ratio * target.square_m;
  if (IsTagGrid(kind)) target.spacing_ratio = options.spacing_ratio.value_or(kSpacing_ratio);
  RIGCAL_TRY(NumberFrom(options.first_id, target));
  if (IsCircleGrid(kind))
    target.diameter_m = options.diameter_mm
                            ? *options.diameter_mm / 1000
                            : target.square_m * (kind == TargetKind::kCircleGrid ? kDiameterOfSpacing_ratio
                                                                                 : kAsymmetricDiameter_ratio);
  RIGCAL_TRY(Validate(target));
  return target;
}

Result<std::string> FileText(const print::Sheet& sheet, const Target& target, const std::string& file) {
  const std::string suffix = std::filesystem::path(file).extension(), title = "Calibration board " + target.serial;
  if (suffix == ".pdf") return print::WritePdf(sheet, title);
  if (suffix == ".svg") return print::WriteSvg(sheet, title);
  return Fail(ErrorCode::kInvalidInput, "'" + file + "' is neither a .pdf nor a .svg",
              "Give --out a name that ends so.");
}

std::string WholeMm(double length_m) { return BoardMm(length_m).substr(0, BoardMm(length_m).find(' ')); }

void TellPrinted(const Context& context, const BoardOptions& options, const Target& target, const print::Sheet& sheet) {
  const BoardPattern pattern = PatternOf(target);
  const std::string command = MeasureCommand(target.serial, &pattern), yaml = print::YamlOf(target);
  if (context.json) {
    context.out << JsonObject({{"file", options.out},
                               Field::Raw("height_m", WholeMm(sheet.height_m) + "e-3"),
                               {"measure", command},
                               {"paper", sheet.paper},
                               Field::Raw("ruler_x_m", WholeMm(sheet.ruler_x_m) + "e-3"),
                               Field::Raw("ruler_y_m", WholeMm(sheet.ruler_y_m) + "e-3"),
                               {"serial", target.serial},
                               {"session_yaml", yaml},
                               Field::Raw("width_m", WholeMm(sheet.width_m) + "e-3")})
                << std::endl;
    return;
  }
  context.out << options.out << ": " << TextOf(pattern) << ", on " << sheet.paper << " paper, "
              << WholeMm(sheet.width_m) << " x " << BoardMm(sheet.height_m) << "; its rulers are "
              << WholeMm(sheet.ruler_x_m) << " and " << BoardMm(sheet.ruler_y_m)
              << " long.\nPrint it at 100 %, glue it flat, measure both rulers, and enter them:\n  " << command
              << "\nIn session.yaml its target is:\n  " << yaml << '\n';
}

Status PrintBoardFile(const Context& context, const BoardOptions& options) {
  RIGCAL_ASSIGN(const Target target, TargetToPrint(options));
  RIGCAL_ASSIGN(const print::Sheet sheet, print::LayOut(target, options.paper));
  RIGCAL_ASSIGN(const std::string text, FileText(sheet, target, options.out));
  RIGCAL_TRY(WriteDurably(options.out, text));
  TellPrinted(context, options, target, sheet);
  return {};
}

}  // namespace

void AddBoardPrint(CLI::App& app, Context& context) {
  auto options = std::make_shared<BoardOptions>();
  AddBoardVerb(app, *options)->callback([&context, options] {
    if (options->action != "print")
      throw CLI::ValidationError("ACTION", "this program prints only: run `rigcal board`");
    RequirePrintOptions(*options);
    if (const Status done = PrintBoardFile(context, *options); !done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
