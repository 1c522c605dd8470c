// What a bag holds, found by going through it once: topics, rates, gaps, clocks, and what each topic may be to Rigcal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal::importing {

// A spread of differences of times, in nanoseconds. The median is that of evenly taken samples where there are many.
struct OffsetSpread {
  std::int64_t min_ns = 0, median_ns = 0, max_ns = 0;
};

struct TopicSurvey {
  std::string name, type, encoding;
  std::int64_t count = 0, bytes = 0;               // messages and their bytes
  std::int64_t first_ns = 0, last_ns = 0;          // by the recorder's clock
  std::optional<double> rate_hz;                   // of two messages or more
  std::int64_t longest_gap_ns = 0, gap_at_ns = 0;  // the longest time without a message, and when it began
  std::optional<OffsetSpread>
      stamp_offset;                  // the driver's stamp minus the recorder's time; nothing of a type without a header
  std::int64_t unset_stamps = 0;     // headers whose stamp is 0
  std::int64_t backward_stamps = 0;  // stamps that are not later than the one before
  std::string frame;                 // of the first header
  std::string detail;                // of the first message: "640 x 480 bgr8", "x y z intensity ring"
  std::string lens_model;            // of a camera info: session.yaml's name of its model, if it has one
  std::string camera_change;         // of a camera info: CameraInfoWatch::Change
  std::string sensor_kind;           // as session.yaml has it: what it may be; empty: none
  std::string trouble;               // why its messages cannot be decoded; empty: they can
};

struct BagSurvey {
  std::vector<TopicSurvey> topics;  // by name
  std::int64_t messages = 0, first_ns = 0, last_ns = 0;
  std::vector<Error> damage;  // what could not be read
};
// `progress` (bytes done, in all) may be empty. An error where nothing can be read.
[[nodiscard]] Result<BagSurvey> SurveyBag(const std::filesystem::path& bag,
                                          const std::function<void(std::int64_t, std::int64_t)>& progress);

}  // namespace rigcal::importing
