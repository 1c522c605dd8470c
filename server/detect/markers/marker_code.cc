#include "server/detect/markers/marker_code.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "server/detect/pictures/plane_map.h"

namespace rigcal::detect {
namespace {

// In the order of OpenCV's PREDEFINED_DICTIONARY_NAME. `distance`: Hamming distance of the AprilTag families, for which
// OpenCV 4.6 corrects no bits; 0: as OpenCV has it.
struct KnownDictionary {
  const char* name;
  int distance;
};
constexpr std::array<KnownDictionary, 21> kDictionaries = {
    {{"DICT_4X4_50", 0},         {"DICT_4X4_100", 0},       {"DICT_4X4_250", 0},       {"DICT_4X4_1000", 0},
     {"DICT_5X5_50", 0},         {"DICT_5X5_100", 0},       {"DICT_5X5_250", 0},       {"DICT_5X5_1000", 0},
     {"DICT_6X6_50", 0},         {"DICT_6X6_100", 0},       {"DICT_6X6_250", 0},       {"DICT_6X6_1000", 0},
     {"DICT_7X7_50", 0},         {"DICT_7X7_100", 0},       {"DICT_7X7_250", 0},       {"DICT_7X7_1000", 0},
     {"DICT_ARUCO_ORIGINAL", 0}, {"DICT_APRILTAG_16h5", 5}, {"DICT_APRILTAG_25h9", 9}, {"DICT_APRILTAG_36h10", 10},
     {"DICT_APRILTAG_36h11", 11}}};

constexpr double kContrastMin = 12;         // grey levels between dark and light cells
constexpr double kBorderBrokenRatio = 0.1;  // cells of the border that may have the other colour
constexpr double kCorrectionRate = 0.6;     // of what the dictionary can correct

double GreyAt(const cv::Mat& grey, const Eigen::Vector2d& at_px) {
  const double x = std::clamp(at_px.x(), 0.0, grey.cols - 1.0), y = std::clamp(at_px.y(), 0.0, grey.rows - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, grey.cols - 1), y1 = std::min(y0 + 1, grey.rows - 1);
  const double fx = x - x0, fy = y - y0;
  return (1 - fy) * ((1 - fx) * grey.at<std::uint8_t>(y0, x0) + fx * grey.at<std::uint8_t>(y0, x1)) +
         fy * ((1 - fx) * grey.at<std::uint8_t>(y1, x0) + fx * grey.at<std::uint8_t>(y1, x1));
}

// Mean grey of the middle of every cell, of `across` x `across` places (odd), row by row. Empty if the corners are no
// square seen from anywhere.
std::vector<double> CellGreys(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px, int cells,
                              int across) {
  const double side = cells;
  const auto map = PlaneMap::Fit({{0, 0}, {side, 0}, {side, side}, {0, side}}, {corners_px.begin(), corners_px.end()});
  std::vector<double> greys;
  for (int i = 0; map && i < cells * cells; ++i) {
    double sum = 0;
    for (int k = 0; k < across * across; ++k) {
      const Eigen::Vector2d within(0.5 + 0.2 * (k % across - across / 2), 0.5 + 0.2 * (k / across - across / 2));
      const auto pixel = map->Pixel(Eigen::Vector2d(i % cells, i / cells) + within);
      if (!pixel) return {};
      sum += GreyAt(grey, *pixel);
    }
    greys.push_back(sum / (across * across));
  }
  return greys;
}

// The level that parts the greys into two groups with the largest variance between them (Otsu). Negative: all alike.
double Level(std::vector<double> greys) {
  std::sort(greys.begin(), greys.end());
  double total = 0, below = 0, best = 0, level = -1;
  for (const double grey : greys) total += grey;
  for (std::size_t i = 1; i < greys.size(); ++i) {
    below += greys[i - 1];
    const double low = static_cast<double>(i), high = static_cast<double>(greys.size() - i);
    const double apart = (total - below) / high - below / low;
    if (apart < kContrastMin || low * high * apart * apart <= best) continue;
    best = low * high * apart * apart;
    level = (greys[i - 1] + greys[i]) / 2;
  }
  return level;
}

// Of the code within a border; 1 is the colour that the border has not. Nothing if the border is broken.
std::optional<cv::Mat> BitsOf(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px, int bits_across,
                              int border_bits) {
  const int cells = bits_across + 2 * border_bits;
  const std::vector<double> greys = CellGreys(grey, corners_px, cells, 3);
  const double level = greys.empty() ? -1 : Level(greys);
  if (level < 0) return std::nullopt;
  cv::Mat bits(bits_across, bits_across, CV_8U);
  int border = 0, light = 0;
  for (int i = 0; i < cells * cells; ++i) {
    const int row = i / cells - border_bits, col = i % cells - border_bits;
    const bool is_light = greys[static_cast<std::size_t>(i)] > level;
    if (row >= 0 && col >= 0 && row < bits.rows && col < bits.cols) {
      bits.at<std::uint8_t>(row, col) = is_light ? 1 : 0;
    } else {
      ++border;
      light += is_light ? 1 : 0;
    }
  }
  const double broken = kBorderBrokenRatio * border;
  if (light > broken && border - light > broken) return std::nullopt;
  if (light > broken) bits = 1 - bits;
  return bits;
}

// A first look at a square, at a single place of each cell: most have one grey, or no border.
bool MayBeCode(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px, int bits_across,
               int border_bits) {
  constexpr double kLooseRatio = 0.3;  // of the border's cells
  const int cells = bits_across + 2 * border_bits;
  const std::vector<double> greys = CellGreys(grey, corners_px, cells, 1);
  if (greys.empty()) return false;
  const auto [darkest, lightest] = std::minmax_element(greys.begin(), greys.end());
  if (*lightest - *darkest < kContrastMin) return false;
  int border = 0, light = 0;
  for (int i = 0; i < cells * cells; ++i) {
    const int inset = std::min({i / cells, i % cells, cells - 1 - i / cells, cells - 1 - i % cells});
    if (inset >= border_bits) continue;
    ++border;
    light += 2 * greys[static_cast<std::size_t>(i)] > *darkest + *lightest ? 1 : 0;
  }
  return std::min(light, border - light) <= kLooseRatio * border;
}

}  // namespace

cv::Ptr<cv::aruco::Dictionary> DictionaryOf(const std::string& name) {
  const auto known = std::find_if(kDictionaries.begin(), kDictionaries.end(),
                                  [&](const KnownDictionary& dictionary) { return name == dictionary.name; });
  if (known == kDictionaries.end()) return {};
  const auto dictionary = cv::aruco::getPredefinedDictionary(static_cast<int>(known - kDictionaries.begin()));
  const int corrected = known->distance > 0 ? (known->distance - 1) / 2 : dictionary->maxCorrectionBits;
  return cv::makePtr<cv::aruco::Dictionary>(dictionary->bytesList, dictionary->markerSize, corrected);
}

std::optional<ReadMarker> ReadCode(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px,
                                   const cv::aruco::Dictionary& dictionary, int border_bits) {
  const auto bits = BitsOf(grey, corners_px, dictionary.markerSize, border_bits);
  int id = -1, rotation = 0;
  if (!bits || !dictionary.identify(*bits, id, rotation, kCorrectionRate)) return std::nullopt;
  ReadMarker marker{id, {}};
  for (std::size_t i = 0; i < 4; ++i)
    marker.corners_px[i] = corners_px[(i + 4 - static_cast<std::size_t>(rotation)) % 4];
  return marker;
}

CodeBits PackedBits(const cv::Mat& bits) {
  CodeBits packed = 0;
  for (int i = 0; i < bits.rows * bits.cols; ++i)
    packed = packed << 1 | (bits.at<std::uint8_t>(i / bits.cols, i % bits.cols) != 0 ? 1 : 0);
  return packed;
}

CodeTable TableOf(const cv::aruco::Dictionary& dictionary) {
  std::vector<std::array<CodeBits, 4>> codes;
  for (int id = 0; id < dictionary.bytesList.rows; ++id) {
    cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.row(id), dictionary.markerSize);
    std::array<CodeBits, 4>& turned = codes.emplace_back();
    for (CodeBits& code : turned) {
      code = PackedBits(bits);
      cv::Mat next;
      cv::rotate(bits, next, cv::ROTATE_90_CLOCKWISE);
      bits = next;
    }
  }
  return {std::move(codes), static_cast<int>(dictionary.maxCorrectionBits * kCorrectionRate)};
}

std::vector<int> IdsOf(const cv::Mat& grey, const std::array<Eigen::Vector2d, 4>& corners_px, int bits_across,
                       const CodeTable& table, std::span<const int> border_bits) {
  std::vector<int> ids;
  for (const int bits_wide : border_bits) {
    // Broader borders hold the narrowest one.
    if (!MayBeCode(grey, corners_px, bits_across, bits_wide)) return ids;
    const auto bits = BitsOf(grey, corners_px, bits_across, bits_wide);
    if (!bits) continue;
    cv::Mat mirrored;
    cv::flip(*bits, mirrored, 1);
    for (const cv::Mat& read : {*bits, mirrored})
      if (const auto id = table.IdOf(PackedBits(read))) ids.push_back(*id);
  }
  return ids;
}

}  // namespace rigcal::detect
