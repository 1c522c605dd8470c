#include "client/boards/options.h"

#include <CLI/CLI.hpp>

#include "client/named.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

void AddPatternOptions(CLI::App& verb, BoardOptions& options) {
  verb.add_option("--type", options.type,
                  "checkerboard, charuco, aprilgrid, aruco_grid, circle_grid or asymmetric_circle_grid")
      ->type_name("TYPE");
  verb.add_option(
          "--cols", options.cols,
          "Columns as session.yaml has them: inner corners of a checkerboard, squares of a charuco, tags or circles of "
          "a grid")
      ->type_name("N");
  verb.add_option("--rows", options.rows, "Rows, likewise")->type_name("N");
  verb.add_option("--square-mm", options.square_mm,
                  "Side of a square, of a grid of a tag, of circles the spacing (spacing_m), as it is to be printed")
      ->type_name("MM");
}

void AddPrintOptions(CLI::App& verb, BoardOptions& options) {
  verb.add_option("--serial", options.serial_to_print, "Of print: the serial, which may also stand after the action");
  verb.add_option("--marker-mm", options.marker_mm, "Of print: side of a charuco's markers (default: 0.75 of a square)")
      ->type_name("MM");
  verb.add_option("--spacing-ratio", options.spacing_ratio,
                  "Of print: gap between tags over a tag's side (default 0.3)")
      ->type_name("R");
  verb.add_option("--first-id", options.first_id,
                  "Of print: id of a board's first marker; the others follow (default: 0). Boards that a camera sees "
                  "beside each other must not share ids")
      ->check(CLI::Range(0, 9999));
  verb.add_option("--diameter-mm", options.diameter_mm,
                  "Of print: diameter of a grid's circles (default: 0.5 of the spacing, 0.7 if asymmetric)")
      ->type_name("MM");
  verb.add_option("--dictionary", options.dictionary,
                  "Of print: OpenCV's name of the markers (default: the smallest DICT_5X5 that has enough; of an "
                  "aprilgrid DICT_APRILTAG_36h11)")
      ->type_name("NAME");
  verb.add_option("--paper", options.paper,
                  "Of print: A4, A3, A2, A1, A0, letter, or auto: the smallest that takes it (default auto)")
      ->type_name("SIZE");
  verb.add_option("--out", options.out, "Of print: the file to write, .pdf or .svg")->type_name("FILE");
}

void AddMeasureOptions(CLI::App& verb, BoardOptions& options) {
  verb.add_option("--ruler-x-mm", options.ruler_x_mm,
                  "Of measure: what a good rule says of the printed ruler along the columns, first line to last")
      ->type_name("MM");
  verb.add_option("--ruler-y-mm", options.ruler_y_mm, "Of measure: likewise of the one along the rows")
      ->type_name("MM");
  verb.add_option("--nominal-mm", options.nominal_mm,
                  "Of measure: what those lengths were to be, one number or two (default: the nearest 100 mm)")
      ->expected(1, 2)
      ->type_name("MM");
  verb.add_option("--sigma-mm", options.sigma_mm,
                  "Of measure: standard deviation of one reading (default 0.2, marked assumed)")
      ->type_name("MM");
  verb.add_option("--flatness-mm", options.flatness_mm, "Of measure: largest gap under a straight edge")
      ->type_name("MM");
  verb.add_option("--by", options.who, "Of measure: who measured it (default: the login name)")
      ->check(Named())
      ->type_name("NAME");
  verb.add_option("--next-check", options.next_check, "Of measure: the day until which it holds, as 2027-05-31")
      ->type_name("DATE");
  verb.add_option("--reason", options.reason, "Of measure: a remark for those who come after")->type_name("TEXT");
  verb.add_flag("--redefine", options.redefine, "Of measure: the registry is wrong about what board that serial is");
}

}  // namespace

CLI::App* AddBoardVerb(CLI::App& app, BoardOptions& options) {
  CLI::App* verb = app.add_subcommand(
      "board", "Print calibration boards, keep what was measured of them, trace what depends on them");
  verb->add_option("ACTION", options.action, "print, measure, list, show or trace")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(kBoardActions.begin(), kBoardActions.end())));
  verb->add_option("SERIAL", options.serial, "What is written on the board; of all but list");
  AddPatternOptions(*verb, options);
  AddPrintOptions(*verb, options);
  AddMeasureOptions(*verb, options);
  verb->add_option("--after", options.after, "Of list: only boards after this serial")->type_name("SERIAL");
  verb->footer(
      "`print` needs no server. It draws the board at true size with a ruler along each side; print it at 100 %, glue "
      "it\n"
      "flat, then `measure` both rulers: a printer is often off by half a percent, and every distance with it. A "
      "bought\n"
      "board has no rulers: measure across many squares, and say with --nominal-mm what that was to be.\n"
      "Write the serial into the board's target in session.yaml. A session is marked where its board has no serial, "
      "is\n"
      "not in the registry, or was due for a check; and warned of where its square size is not the measured one.\n"
      "Examples:\n"
      "  rigcal board print --type charuco --cols 11 --rows 8 --square-mm 25 --serial B-1 --out B-1.pdf\n"
      "  rigcal board measure B-1 --type charuco --cols 11 --rows 8 --square-mm 25 --ruler-x-mm 299.2 --ruler-y-mm "
      "199.6 --by Ada --next-check 2027-05-31\n"
      "  rigcal board measure B-1 --ruler-x-mm 299.1 --ruler-y-mm 199.6\n"
      "  rigcal board list\n"
      "  rigcal board show B-1\n"
      "  rigcal board trace B-1 --json > depends.json\n");
  return verb;
}

Result<TargetKind> BoardTypeOf(const std::string& typed) {
  if (typed == "aprilgrid") return TargetKind::kAprilGrid;
  if (typed == "arucogrid") return TargetKind::kArucoGrid;
  auto kind = TargetKindOf(typed);
  if (kind) return kind;
  return Fail(ErrorCode::kInvalidInput, kind.error().what,
              "Use --type checkerboard, charuco, aprilgrid, aruco_grid, circle_grid or asymmetric_circle_grid.");
}

}  // namespace rigcal::client
