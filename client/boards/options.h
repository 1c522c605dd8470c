// The words of `rigcal board`: of the program `rigcal`, which asks the server, and of `rigcal-board`, which prints.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/model/boards/measure.h"

namespace CLI {
class App;
}

namespace rigcal::client {

// As they were typed: lengths in millimetres.
struct BoardOptions {
  std::string action, serial;
  // What the board is: of print, and of the first measure.
  std::string type;
  std::optional<int> cols, rows, first_id;
  std::optional<double> square_mm;
  // print
  std::optional<double> marker_mm, spacing_ratio, diameter_mm;
  std::string dictionary, serial_to_print, paper = "auto", out;
  // measure
  std::optional<double> ruler_x_mm, ruler_y_mm, flatness_mm, sigma_mm;
  std::vector<double> nominal_mm;
  std::string who, next_check, reason;
  bool redefine = false;
  // list
  std::string after;
};

// Declares the verb with all its options and its help; what runs is the caller's.
CLI::App* AddBoardVerb(CLI::App& app, BoardOptions& options);
// "checkerboard", "charuco", "aprilgrid", "aruco_grid", "circle_grid" or "asymmetric_circle_grid", as people type them.
[[nodiscard]] Result<TargetKind> BoardTypeOf(const std::string& typed);

}  // namespace rigcal::client
