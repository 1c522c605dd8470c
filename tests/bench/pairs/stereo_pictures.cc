#include "tests/bench/pairs/stereo_pictures.h"

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "server/detect/board.h"

namespace rigcal {
namespace {

Target Board() { return {TargetId("board"), 9, 6, 0.025, 0.0, ""}; }

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::optional<BoardView> ViewIn(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const std::string bytes = ReadFile(path);
  return detect::Detect(std::as_bytes(std::span(bytes)), Board()).view;
}

std::set<std::string> CaptureNames(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".jpg") continue;
    for (const std::string side : {"left", "right"})
      if (stem.starts_with(side) && stem.size() > side.size()) names.insert(stem.substr(side.size()));
  }
  return names;
}

}  // namespace

calib::StereoProblem StereoProblemOf(const std::filesystem::path& folder) {
  calib::StereoProblem problem;
  problem.camera_a.id = SensorId("left");
  problem.camera_b.id = SensorId("right");
  problem.board = Board();
  for (const std::string& name : CaptureNames(folder))
    problem.captures.push_back(
        {CaptureId(name), ViewIn(folder / ("left" + name + ".jpg")), ViewIn(folder / ("right" + name + ".jpg"))});
  return problem;
}

}  // namespace rigcal
