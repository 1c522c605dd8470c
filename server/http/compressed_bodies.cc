#include "server/http/compressed_bodies.h"

#include <zlib.h>

#include <iterator>

namespace rigcal::http {
namespace {

constexpr std::size_t kWorthBytesMin = 1 << 10, kWorthBytesMax = 8 << 20;
constexpr int kLevel = 6;
constexpr int kGzipWindowBits = 15 + 16;  // of zlib: the largest window, and gzip's frame

}  // namespace

bool IsWorthCompressing(std::string_view content_type, std::size_t size_bytes) {
  if (size_bytes < kWorthBytesMin || size_bytes > kWorthBytesMax) return false;
  for (const std::string_view kind : {"text/", "json", "javascript", "xml", "yaml"})
    if (content_type.find(kind) != std::string_view::npos) return true;
  return false;
}

std::string Gzip(std::string_view body) {
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kGzipWindowBits, 8, Z_DEFAULT_STRATEGY) != Z_OK) return "";
  std::string packed(deflateBound(&stream, static_cast<uLong>(body.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(body.data()));
  stream.avail_in = static_cast<uInt>(body.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const bool is_whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  packed.resize(is_whole ? stream.total_out : 0);
  deflateEnd(&stream);
  return packed;
}

std::shared_ptr<const std::string> CompressedBodies::Find(const std::string& tag) {
  const std::lock_guard lock(mutex_);
  const auto found = by_tag_.find(tag);
  if (found == by_tag_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, found->second);
  return found->second->gzip;
}

void CompressedBodies::Keep(const std::string& tag, const std::shared_ptr<const std::string>& gzip) {
  const std::lock_guard lock(mutex_);
  if (by_tag_.count(tag) > 0) return;  // another thread was faster
  kept_.push_front({tag, gzip});
  by_tag_[tag] = kept_.begin();
  bytes_ += gzip->size();
  while (bytes_ > bytes_max_) {
    bytes_ -= kept_.back().gzip->size();
    by_tag_.erase(kept_.back().tag);
    kept_.pop_back();
  }
}

std::shared_ptr<const std::string> CompressedBodies::Of(const std::string& tag,
                                                        const std::function<std::string()>& read) {
  if (auto kept = Find(tag)) return kept;
  const std::string body = read();
  auto gzip = std::make_shared<const std::string>(body.empty() ? "" : Gzip(body));
  if (gzip->empty()) return nullptr;
  Keep(tag, gzip);
  return gzip;
}

}  // namespace rigcal::http
