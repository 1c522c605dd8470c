// Counts one topic of a bag while it goes by, in bounded memory.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/bags/bag.h"
#include "client/bags/messages/definition.h"
#include "client/bags/messages/image.h"
#include "client/import/survey.h"

namespace rigcal::importing {

// Values as they come; of many, every second, fourth, ... is kept. The same values give the same samples.
class Samples {
 public:
  // One more.
  void Add(std::int64_t value);
  // Nothing: there were none.
  [[nodiscard]] std::optional<OffsetSpread> Spread() const;

 private:
  std::vector<std::int64_t> kept_;
  std::int64_t min_ = 0, max_ = 0, count_ = 0, stride_ = 1;
};

// Of a driver's camera info as it comes. One that changes in between is of another lens, focus, zoom or picture size.
class CameraInfoWatch {
 public:
  // One more, that was recorded then.
  void Add(const bags::CameraInfo& info, std::int64_t log_ns);
  // "changes at 2026-11-27T12:00:01Z (stamp 1795780801.000000000): fx 500 to 600, and 3 times more"; empty: it does
  // not.
  [[nodiscard]] std::string Change() const;

 private:
  std::optional<bags::CameraInfo> last_;
  std::string first_change_;
  std::size_t changes_ = 0;
};

class TopicTally {
 public:
  // Of the topic's first message.
  explicit TopicTally(const bags::Topic& topic);
  // One more message of it; its definition may differ from the first one's.
  void Add(const bags::Message& message);
  // What was found.
  [[nodiscard]] TopicSurvey Found() const;

 private:
  void LookInto(const bags::Message& message);
  void AddStamp(std::int64_t stamp_ns, std::int64_t log_ns);

  TopicSurvey found_;
  const bags::Topic* decoded_ = nullptr;  // whose definition this is
  std::shared_ptr<const bags::Definition> definition_;
  Samples offsets_;
  CameraInfoWatch infos_;
  std::int64_t last_stamp_ns_ = INT64_MIN;
};

}  // namespace rigcal::importing
