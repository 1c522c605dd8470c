#include "server/detect/checkerboard/saddle_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/core/hal/intrin.hpp>

namespace rigcal::detect {
namespace {

constexpr int kRing = 16;
// Clockwise from the top; all within kPad.
constexpr std::array<std::array<int, 2>, kRing> kOffsets = {{{0, -5},
                                                             {2, -5},
                                                             {4, -4},
                                                             {5, -2},
                                                             {5, 0},
                                                             {5, 2},
                                                             {4, 4},
                                                             {2, 5},
                                                             {0, 5},
                                                             {-2, 5},
                                                             {-4, 4},
                                                             {-5, 2},
                                                             {-5, 0},
                                                             {-5, -2},
                                                             {-4, -4},
                                                             {-2, -5}}};
constexpr std::array<std::int16_t, 8> kZeros = {};
constexpr std::int16_t kResponseMin = 24;
constexpr int kSuppression_px = 3;
constexpr float kContrastMin = 6;
// Of the response to the contrast: a sharp corner has about 6, the axis of a broad line up to 1.5.
constexpr float kResponseRatio = 1.6f;

// What the response asks of numbers: one of them, or as many side by side as the processor takes.
struct One {
  using Value = std::int16_t;
  static Value Load(const std::int16_t* from) { return *from; }
  static Value Sum(Value a, Value b) { return static_cast<Value>(a + b); }
  static Value Less(Value a, Value b) { return static_cast<Value>(a - b); }
  static Value Apart(Value a, Value b) { return static_cast<Value>(a < b ? b - a : a - b); }
  static Value Half(Value a) { return static_cast<Value>(a >> 1); }
};
struct Eight {
  using Value = cv::v_int16x8;
  static Value Load(const std::int16_t* from) { return cv::v_load(from); }
  static Value Sum(const Value& a, const Value& b) { return a + b; }
  static Value Less(const Value& a, const Value& b) { return a - b; }
  static Value Apart(const Value& a, const Value& b) { return cv::v_max(a, b) - cv::v_min(a, b); }
  static Value Half(const Value& a) { return a >> 1; }
};

using Rows = std::array<const std::int16_t*, 11>;

// Opposite places of the ring alike and places a quarter apart unlike, less what an edge or a line would give. What a
// line would give counts half: prints and sharpening leave bridges or gaps where squares meet.
template <typename Numbers>
typename Numbers::Value ResponseOf(const Rows& rows, std::ptrdiff_t x) {
  using N = Numbers;
  const auto at = [&](int dx, int dy) { return N::Load(rows[static_cast<std::size_t>(dy + 5)] + x + dx); };
  const auto pair = [&](std::size_t i, typename N::Value& sum, typename N::Value& edges) {
    const auto a = at(kOffsets[i][0], kOffsets[i][1]), b = at(-kOffsets[i][0], -kOffsets[i][1]);
    sum = N::Sum(a, b);
    edges = N::Sum(edges, N::Apart(a, b));
  };
  typename N::Value response = N::Load(kZeros.data()), edges = response, ring = response;
  for (std::size_t i = 0; i < 4; ++i) {
    typename N::Value here, across;
    pair(i, here, edges);
    pair(i + 4, across, edges);
    response = N::Sum(response, N::Apart(here, across));
    ring = N::Sum(ring, N::Sum(here, across));
  }
  auto middle = N::Sum(N::Sum(at(-1, 0), at(1, 0)), N::Sum(at(0, -1), at(0, 1)));
  middle = N::Sum(middle, middle);
  return N::Less(N::Less(response, edges), N::Half(N::Apart(ring, N::Sum(middle, middle))));
}

Rows RowsAround(const GreyLevel& level, int y) {
  Rows rows{};
  for (int dy = -5; dy <= 5; ++dy) rows[static_cast<std::size_t>(dy + 5)] = level.Row(y + dy);
  return rows;
}

int ResponseAt(const GreyLevel& level, int x, int y) { return ResponseOf<One>(RowsAround(level, y), x); }

// Responses with a border of none around.
struct Responses {
  std::ptrdiff_t stride = 0;
  std::vector<std::int16_t> values;
  [[nodiscard]] const std::int16_t* Row(int y) const {
    return values.data() + (y + kSuppression_px) * stride + kSuppression_px;
  }
  [[nodiscard]] std::int16_t* Row(int y) { return values.data() + (y + kSuppression_px) * stride + kSuppression_px; }
};

Responses ResponsesOf(const GreyLevel& level) {
  Responses responses{level.width_px + 2 * kSuppression_px, {}};
  responses.values.assign(static_cast<std::size_t>(responses.stride * (level.height_px + 2 * kSuppression_px)), 0);
  for (int y = 0; y < level.height_px; ++y) {
    const auto rows = RowsAround(level, y);
    std::int16_t* row = responses.Row(y);
    int x = 0;
    for (; x + 8 <= level.width_px; x += 8) cv::v_store(row + x, ResponseOf<Eight>(rows, x));
    for (; x < level.width_px; ++x) row[x] = ResponseOf<One>(rows, x);
  }
  return responses;
}

bool IsPeak(const Responses& responses, int x, int y) {
  const std::int16_t value = responses.Row(y)[x];
  for (int dy = -kSuppression_px; dy <= kSuppression_px; ++dy) {
    const std::int16_t* row = responses.Row(y + dy) + x;
    for (int dx = -kSuppression_px; dx <= kSuppression_px; ++dx)
      if (row[dx] > value || (row[dx] == value && (dy < 0 || (dy == 0 && dx < 0)))) return false;
  }
  return true;
}

float Vertex(int before, int here, int after) {
  const int bend = before - 2 * here + after;
  return bend < 0 ? std::clamp(static_cast<float>(before - after) / static_cast<float>(2 * bend), -0.5f, 0.5f) : 0.0f;
}

// Where the ring passes between dark and light, in steps of the ring.
struct Crossing {
  float at = 0;
  bool rising = false;
};

struct Quarters {
  std::array<Crossing, 4> crossings;
  float contrast = 0;
};

// Nothing unless the ring has two dark and two light parts.
std::optional<Quarters> QuartersAt(const GreyLevel& level, int x, int y) {
  int ring[kRing], smooth[kRing], sum = 0;
  for (std::size_t i = 0; i < kRing; ++i) ring[i] = level.Row(y + kOffsets[i][1])[x + kOffsets[i][0]];
  for (int i = 0; i < kRing; ++i) {
    smooth[i] = kRing * (ring[(i + kRing - 1) % kRing] + 2 * ring[i] + ring[(i + 1) % kRing]);
    sum += ring[i];
  }
  const int mean = 4 * sum;  // in the units of `smooth`
  Quarters quarters;
  std::size_t count = 0;
  int spread = 0;
  for (int i = 0; i < kRing; ++i) {
    const int here = smooth[i] - mean, next = smooth[(i + 1) % kRing] - mean;
    spread += std::abs(here);
    if ((here < 0) == (next < 0)) continue;
    if (count == 4) return std::nullopt;
    quarters.crossings[count++] = {static_cast<float>(i) + static_cast<float>(here) / static_cast<float>(here - next),
                                   here < 0};
  }
  if (count != 4) return std::nullopt;
  quarters.contrast = 2 * static_cast<float>(spread) / (kRing * kRing * 4);
  return quarters;
}

Eigen::Vector2f OnRing(float at) {
  const float angle = at * static_cast<float>(2 * M_PI / kRing);
  return {std::sin(angle), -std::cos(angle)};
}

std::optional<Saddle> SaddleAt(const GreyLevel& level, int x, int y) {
  constexpr float kStraight = -0.85f;  // cosine between the two halves of an edge
  const auto quarters = QuartersAt(level, x, y);
  if (!quarters || quarters->contrast < kContrastMin) return std::nullopt;
  std::array<Eigen::Vector2f, 4> ends;
  const std::size_t first = quarters->crossings[0].rising ? 0 : 1;
  for (std::size_t i = 0; i < 4; ++i) ends[i] = OnRing(quarters->crossings[(i + first) % 4].at);
  if (ends[0].dot(ends[2]) > kStraight || ends[1].dot(ends[3]) > kStraight) return std::nullopt;
  Saddle saddle;
  saddle.contrast = quarters->contrast;
  for (std::size_t i = 0; i < 2; ++i) {
    saddle.ways[i] = (ends[i] - ends[i + 2]).normalized();
    saddle.ways[i + 2] = -saddle.ways[i];
  }
  const int here = ResponseAt(level, x, y);
  saddle.at_px = {static_cast<float>(x) + Vertex(ResponseAt(level, x - 1, y), here, ResponseAt(level, x + 1, y)),
                  static_cast<float>(y) + Vertex(ResponseAt(level, x, y - 1), here, ResponseAt(level, x, y + 1))};
  return saddle;
}

}  // namespace

std::vector<Saddle> SaddlePoints(const GreyLevel& level) {
  const Responses responses = ResponsesOf(level);
  std::vector<Saddle> saddles;
  constexpr int kBlock = 16;
  for (int y = 0; y < level.height_px; ++y) {
    const std::int16_t* row = responses.Row(y);
    for (int from = 0; from < level.width_px; from += kBlock) {
      const int to = std::min(from + kBlock, level.width_px);
      std::int16_t largest = 0;
      for (int x = from; x < to; ++x) largest = std::max(largest, row[x]);
      if (largest < kResponseMin) continue;
      for (int x = from; x < to; ++x) {
        if (row[x] < kResponseMin || !IsPeak(responses, x, y)) continue;
        const auto saddle = SaddleAt(level, x, y);
        if (saddle && static_cast<float>(row[x]) > kResponseRatio * saddle->contrast) saddles.push_back(*saddle);
      }
    }
  }
  return saddles;
}

std::optional<Saddle> SaddleNear(const GreyLevel& level, const Eigen::Vector2f& at_px, float radius_px) {
  const int radius = static_cast<int>(std::ceil(radius_px));
  const int x = static_cast<int>(std::lround(at_px.x())), y = static_cast<int>(std::lround(at_px.y()));
  int best = 0, best_x = 0, best_y = 0;
  for (int row = std::max(1, y - radius); row <= std::min(level.height_px - 2, y + radius); ++row)
    for (int col = std::max(1, x - radius); col <= std::min(level.width_px - 2, x + radius); ++col) {
      const int response = ResponseAt(level, col, row);
      if (response <= best) continue;
      best = response, best_x = col, best_y = row;
    }
  return best > 0 ? SaddleAt(level, best_x, best_y) : std::nullopt;
}

}  // namespace rigcal::detect
