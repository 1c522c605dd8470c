// Measures the search of checkerboards in pictures of 5 megapixels, decoded grey picture to corners, in processor time
// of one thread: board_speed_measure DATA [PICTURES] prints one JSON object. DATA: the folder of real data; without
// road scenes there the pictures without a board are drawn ones only. PICTURES: how many smaller ones are drawn to look
// for wrong boards.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>
#include <string>

#include "server/detect/checkerboard/corners.h"
#include "server/detect/checkerboard/orientation.h"
#include "server/detect/markers/charuco.h"
#include "server/detect/markers/tag_grid.h"
#include "tests/bench/sensors/board_pictures.h"

namespace rigcal::detect {
namespace {

using Corners = std::vector<Eigen::Vector2d>;
constexpr int kWidth_px = 2448, kHeight_px = 2048;

template <typename Body>
double ProcessorMilliseconds(const Body& body) {
  const auto now_ms = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
  };
  const double start_ms = now_ms();
  body();
  return now_ms() - start_ms;
}

double Median(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double Largest(const std::vector<double>& values) {
  return values.empty() ? NAN : *std::max_element(values.begin(), values.end());
}

struct Board {
  int cols = 9, rows = 6;
};

// How far corners are from where they should be.
struct Off {
  double squares = 0;
  long corners = 0;

  void Add(double squared_px, std::size_t count) { squares += squared_px, corners += static_cast<long>(count); }
  [[nodiscard]] double Rms_px() const { return corners == 0 ? 0 : std::sqrt(squares / static_cast<double>(corners)); }
};

struct Tally {
  std::vector<double> found_ms, none_ms, charuco_none_ms, tags_none_ms, decode_png_ms, decode_jpeg_ms;
  int boards = 0, found = 0, wrong = 0;
  Off truth, hard_truth, reference, other_reference, real_reference;
};

std::optional<Corners> Ordered(const GreyImage& image, const Board& board, const std::optional<Corners>& corners) {
  if (!corners) return std::nullopt;
  const auto ordered = Oriented(image, board.cols, board.rows, *corners);
  return ordered ? std::optional(*ordered) : std::nullopt;
}

// Squared distances summed, of the better of both orders where two look alike.
double SquaredOff(const Corners& found, const Corners& truth) {
  double forward = 0, backward = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    forward += (found[i] - truth[i]).squaredNorm();
    backward += (found[i] - truth[truth.size() - 1 - i]).squaredNorm();
  }
  return std::min(forward, backward);
}

// The board and its outer squares.
cv::Rect Around(const Corners& corners, const cv::Mat& picture) {
  std::vector<cv::Point> points;
  for (const Eigen::Vector2d& corner : corners)
    points.emplace_back(static_cast<int>(corner.x()), static_cast<int>(corner.y()));
  const cv::Rect tight = cv::boundingRect(points);
  const int margin_px = std::max(tight.width, tight.height) / 5;
  return cv::Rect(tight.tl() - cv::Point(margin_px, margin_px), tight.size() + cv::Size(2 * margin_px, 2 * margin_px)) &
         cv::Rect(0, 0, picture.cols, picture.rows);
}

// A full-resolution search by OpenCV. It looks around the board only: among clutter it would take minutes.
std::optional<Corners> Reference(const cv::Mat& picture, const Board& board, const cv::Rect& around) {
  std::vector<cv::Point2f> points;
  cv::Mat calm;  // noise would give it thousands of outlines; the refinement sees the picture itself
  cv::GaussianBlur(picture(around), calm, {}, 1.5);
  if (!cv::findChessboardCorners(calm, {board.cols, board.rows}, points,
                                 cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE))
    return std::nullopt;
  Corners corners;
  for (const cv::Point2f& point : points) corners.emplace_back(point.x + around.x, point.y + around.y);
  return corners;
}

// OpenCV's own refinement with the window of its calibration sample, whatever the size of the squares.
Corners RefinedByOpenCv(const cv::Mat& picture, const Corners& corners) {
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& corner : corners)
    points.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  cv::cornerSubPix(picture, points, {11, 11}, {-1, -1}, {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 100, 1e-4});
  Corners refined;
  for (const cv::Point2f& point : points) refined.emplace_back(point.x, point.y);
  return refined;
}

void AddOff(const GreyImage& image, const Board& board, const Corners& found, const Corners& reference, Off& off) {
  if (const auto ordered = Ordered(image, board, reference)) off.Add(SquaredOff(found, *ordered), found.size());
}

// With the same refinement: whether the search is right.
void CompareSearch(const cv::Mat& picture, const Board& board, const Corners& found, Tally& tally) {
  const GreyImage image = AsImage(picture);
  if (const auto reference = Reference(picture, board, Around(found, picture)))
    AddOff(image, board, found, RefinedCorners(image, board.cols, board.rows, *reference), tally.reference);
}

// With another refinement: whether ours is right. Where noise is strong, or a small picture was enlarged, the size of
// the window decides what either of them finds.
void CompareRefinement(const cv::Mat& picture, const Board& board, const Corners& found, Off& off) {
  if (const auto reference = Reference(picture, board, Around(found, picture)))
    AddOff(AsImage(picture), board, found, RefinedByOpenCv(picture, *reference), off);
}

// Corners found where there is a board: right ones, wrong ones, none.
std::optional<Corners> SearchFor(const cv::Mat& picture, const Board& board, std::vector<double>& times_ms) {
  const GreyImage image = AsImage(picture);
  std::optional<Corners> corners;
  times_ms.push_back(
      ProcessorMilliseconds([&] { corners = Ordered(image, board, FindCorners(image, board.cols, board.rows)); }));
  return corners;
}

void Judge(const std::optional<Corners>& found, const Corners& truth, double square_px, Off& off, Tally& tally) {
  ++tally.boards;
  if (!found) return;
  const double squared = SquaredOff(*found, truth);
  if (std::sqrt(squared / static_cast<double>(truth.size())) > 0.25 * square_px) {
    ++tally.wrong;
    return;
  }
  ++tally.found;
  off.Add(squared, truth.size());
}

// 25 pixels a square up to filling the picture, twice: gentle and hard conditions.
void MeasureDrawn(Tally& tally) {
  const Board boards[] = {{9, 6}, {7, 5}, {11, 8}, {8, 6}};
  for (int i = 0; i < 32; ++i) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    const Board& board = boards[i % 4];
    const bool hard = i % 2 == 1;
    PictureWish wish{board.cols, board.rows};
    const double largest_px = kHeight_px / (1.18 * std::hypot(board.cols + 1, board.rows + 1));
    wish.square_px = 25 * std::pow(largest_px / 25, i / 2 / 15.0);
    if (hard) wish.dark = 70, wish.light = 130, wish.shade = 0.3;
    wish = Placed(random, wish, hard ? 0.9 : 0.4, kWidth_px, kHeight_px);
    cv::Mat picture(kHeight_px, kWidth_px, CV_8U, cv::Scalar(120));
    DrawClutter(random, picture);
    const Corners truth = DrawBoard(wish, picture);
    Expose(random, hard ? 1.8 : 0.7, hard ? 6 : 2, picture);
    const auto found = SearchFor(picture, board, tally.found_ms);
    Judge(found, truth, wish.square_px, hard ? tally.hard_truth : tally.truth, tally);
    if (found && i % 4 < 2) CompareSearch(picture, board, *found, tally);
    if (found && !hard) CompareRefinement(picture, board, *found, tally.other_reference);
  }
}

std::vector<std::filesystem::path> PicturesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".png" || entry.path().extension() == ".jpg") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

cv::Mat Grey(const std::filesystem::path& path) {
  return cv::imread(path.string(), cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
}

std::vector<cv::Mat> Roads(const std::filesystem::path& data) {
  std::vector<cv::Mat> roads;
  for (const char* name : {"auto_calib/data/calib.png", "manual_calib/data/0.png"}) {
    const cv::Mat road = Grey(data / "lidarcam_opencalib_road" / name);
    if (!road.empty()) roads.push_back(Tiled(road, kWidth_px, kHeight_px));
  }
  return roads;
}

// Real pictures, enlarged as far as they fit, on a road scene or clutter.
void MeasureReal(const std::filesystem::path& data, const cv::Mat& canvas, Tally& tally) {
  const std::pair<const char*, Board> sets[] = {{"stereo_opencv", {9, 6}},
                                                {"handeye_visp_franka/data-eye-in-hand", {9, 6}},
                                                {"lidarcam_acfr_vlp16/images", {7, 5}}};
  int count = 0;
  for (const auto& [name, board] : sets) {
    for (const auto& path : PicturesIn(data / name)) {
      cv::Mat real = Grey(path), picture = canvas.clone();
      const double fit = std::min(1.0 * kWidth_px / real.cols, 1.0 * kHeight_px / real.rows);
      const double scale = std::max(1.0, fit * (1 + count++ % 3) / 3);  // a third, two thirds or all of the picture
      cv::resize(real, real, {}, scale, scale, cv::INTER_CUBIC);
      const cv::Rect place((kWidth_px - real.cols) / 2, (kHeight_px - real.rows) / 3, real.cols, real.rows);
      real.copyTo(picture(place & cv::Rect(0, 0, kWidth_px, kHeight_px)));
      const auto found = SearchFor(picture, board, tally.found_ms);
      ++tally.boards;
      if (!found) continue;
      ++tally.found;
      if (count % 4 != 0) continue;
      CompareSearch(picture, board, *found, tally);
      CompareRefinement(picture, board, *found, tally.real_reference);
    }
  }
}

void LookForMarkers(const cv::Mat& picture, Tally& tally) {
  const GreyImage image = AsImage(picture);
  Target target{TargetId("board"), 8, 5, 0.04, 0, ""};
  BoardView charuco, tags;
  target.kind = TargetKind::kCharuco;
  target.dictionary = "DICT_4X4_50", target.marker_m = 0.03;
  tally.charuco_none_ms.push_back(ProcessorMilliseconds([&] { FindCharuco(image, target, charuco); }));
  target.kind = TargetKind::kAprilGrid, target.cols = target.rows = 6;
  target.dictionary = "DICT_APRILTAG_36h11", target.spacing_ratio = 0.3;
  tally.tags_none_ms.push_back(ProcessorMilliseconds([&] { FindTagGrid(image, target, tags); }));
  if (charuco.found || tags.found) ++tally.wrong;
}

// Nothing that could be found: scenes, clutter, boards of other counts, boards that are cut off.
void MeasureNone(const std::vector<cv::Mat>& roads, Tally& tally) {
  const auto look = [&](const cv::Mat& picture) {
    if (SearchFor(picture, {9, 6}, tally.none_ms)) ++tally.wrong;
  };
  for (const cv::Mat& road : roads) look(road);
  for (int i = 0; i < 18; ++i) {
    Random random(static_cast<std::uint64_t>(1000 + i));
    cv::Mat picture(kHeight_px, kWidth_px, CV_8U, cv::Scalar(Whole(random, 60, 200)));
    DrawClutter(random, picture);
    PictureWish wish{i % 3 == 0 ? 10 : 8, i % 3 == 0 ? 7 : 6, Uniform(random, 25, 120)};
    wish = Placed(random, wish, 0.5, kWidth_px, kHeight_px);
    if (i % 3 == 2) {  // cut off by the border
      wish.cols = 9, wish.rows = 6, wish.roll_rad = 0;
      wish.middle_px.x() = wish.square_px * Uniform(random, 0, 3);
    }
    if (i >= 6) DrawBoard(wish, picture);
    Expose(random, 1, 3, picture);
    look(picture);
    if (i % 2 == 0) LookForMarkers(picture, tally);
  }
}

// Many smaller pictures of boards with the counts asked for, or others; only right corners are no mistake.
void LookForMistakes(int count, Tally& tally) {
  std::vector<double> times_ms;
  for (int i = 0; i < count; ++i) {
    Random random(static_cast<std::uint64_t>(50000 + i));
    const int rows = Whole(random, 3, 8);
    const Board asked{rows + Whole(random, 1, 4), rows};
    PictureWish wish{asked.cols, asked.rows};
    const bool other = i % 2 == 1;
    if (other) wish.cols += Whole(random, 0, 2), wish.rows += Whole(random, 1, 2);
    wish.square_px = Uniform(random, 9, 480 / std::hypot(wish.cols + 2, wish.rows + 2));
    wish.dark = Uniform(random, 10, 120), wish.light = wish.dark + Uniform(random, 30, 130);
    wish.margin_squares = Uniform(random, 0.1, 1.2);
    wish = Placed(random, wish, 1.0, 720, 540);
    cv::Mat picture(540, 720, CV_8U, cv::Scalar(Whole(random, 20, 230)));
    DrawClutter(random, picture);
    const Corners truth = DrawBoard(wish, picture);
    Expose(random, Uniform(random, 0.5, 2), Uniform(random, 0, 8), picture);
    const auto found = SearchFor(picture, asked, times_ms);
    if (other)
      tally.wrong += found ? 1 : 0;
    else
      Judge(found, truth, wish.square_px, tally.truth, tally);
  }
}

void MeasureDecoding(const cv::Mat& picture, Tally& tally) {
  for (const char* suffix : {".png", ".jpg"}) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(suffix, picture, bytes);
    auto& times_ms = suffix == std::string(".png") ? tally.decode_png_ms : tally.decode_jpeg_ms;
    for (int i = 0; i < 3; ++i)
      times_ms.push_back(ProcessorMilliseconds([&] {
        if (!DecodeGrey(std::as_bytes(std::span(bytes)))) ++tally.wrong;
      }));
  }
}

void PrintOff(const char* name, const Off& off) {
  std::printf("\"%s_rms_px\": %.5f, \"%s_corners\": %ld, ", name, off.Rms_px(), name, off.corners);
}

int Measure(const std::filesystem::path& data, int pictures) {
  cv::setNumThreads(1);
  Tally large, small;
  std::vector<cv::Mat> roads = Roads(data);
  Random random(7);
  cv::Mat canvas(kHeight_px, kWidth_px, CV_8U, cv::Scalar(110));
  DrawClutter(random, canvas);
  if (!roads.empty()) canvas = roads.front();
  MeasureDrawn(large);
  const int drawn = large.boards, drawn_found = large.found;
  MeasureReal(data, canvas, large);
  MeasureNone(roads, large);
  MeasureDecoding(canvas, large);
  LookForMistakes(pictures, small);
  std::printf("{\"found_median_ms\": %.2f, \"found_max_ms\": %.2f, ", Median(large.found_ms), Largest(large.found_ms));
  std::printf("\"none_median_ms\": %.2f, \"none_max_ms\": %.2f, ", Median(large.none_ms), Largest(large.none_ms));
  std::printf("\"charuco_none_median_ms\": %.2f, \"charuco_none_max_ms\": %.2f, ", Median(large.charuco_none_ms),
              Largest(large.charuco_none_ms));
  std::printf("\"tags_none_median_ms\": %.2f, \"tags_none_max_ms\": %.2f, ", Median(large.tags_none_ms),
              Largest(large.tags_none_ms));
  std::printf("\"decode_png_ms\": %.2f, \"decode_jpeg_ms\": %.2f, ", Median(large.decode_png_ms),
              Median(large.decode_jpeg_ms));
  std::printf("\"drawn\": %d, \"drawn_found\": %d, \"real\": %d, \"real_found\": %d, \"wrong\": %d, ", drawn,
              drawn_found, large.boards - drawn, large.found - drawn_found, large.wrong + small.wrong);
  PrintOff("reference", large.reference);
  PrintOff("other_reference", large.other_reference);
  PrintOff("real_reference", large.real_reference);
  PrintOff("truth", large.truth);
  PrintOff("hard_truth", large.hard_truth);
  std::printf("\"small\": %d, \"small_found\": %d, \"small_pictures\": %d}\n", small.boards, small.found, pictures);
  return 0;
}

}  // namespace
}  // namespace rigcal::detect

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: board_speed_measure DATA [PICTURES]\n");
    return 2;
  }
  return rigcal::detect::Measure(argv[1], argc == 3 ? std::atoi(argv[2]) : 200);
}
