#include "client/wire/reply_parts.h"

namespace rigcal::client {
namespace {
constexpr std::uint32_t kPartsMax = 65'536;
}  // namespace

std::optional<std::string> ReplyParts::Add(std::uint32_t part_idx, std::uint32_t part_count, const char* json) {
  if (part_idx >= part_count || part_count > kPartsMax || json == nullptr) return std::nullopt;
  if (parts_.empty()) parts_.resize(part_count);
  if (parts_.size() != part_count || parts_[part_idx]) return std::nullopt;
  parts_[part_idx] = json;
  if (++received_ < parts_.size()) return std::nullopt;
  std::string whole;
  for (const auto& part : parts_) whole += *part;
  return whole;
}

}  // namespace rigcal::client
