// Puts the parts of one reply together, whatever their order and however often each comes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rigcal::client {

class ReplyParts {
 public:
  // The whole text once the last missing part is there. Parts that contradict each other are ignored.
  [[nodiscard]] std::optional<std::string> Add(std::uint32_t part_idx, std::uint32_t part_count, const char* json);

 private:
  std::vector<std::optional<std::string>> parts_;
  std::size_t received_ = 0;
};

}  // namespace rigcal::client
