// Answers compressed with gzip when they are first asked for, and kept.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>

namespace rigcal::http {

// Text of a size that is worth it: pictures are compressed already, and large files are sent as they are.
[[nodiscard]] bool IsWorthCompressing(std::string_view content_type, std::size_t size_bytes);
// The gzip of `body`; empty if zlib fails.
[[nodiscard]] std::string Gzip(std::string_view body);

// At most `bytes_max` of compressed bytes; those that were asked for longest ago go. Any thread.
class CompressedBodies {
 public:
  explicit CompressedBodies(std::size_t bytes_max) : bytes_max_(bytes_max) {}
  // The gzip of the body that `tag` names (no other body ever has this tag), which `read` gives where it is not kept.
  // Null where `read` gives nothing.
  [[nodiscard]] std::shared_ptr<const std::string> Of(const std::string& tag, const std::function<std::string()>& read);

 private:
  struct Kept {
    std::string tag;
    std::shared_ptr<const std::string> gzip;
  };
  [[nodiscard]] std::shared_ptr<const std::string> Find(const std::string& tag);
  void Keep(const std::string& tag, const std::shared_ptr<const std::string>& gzip);

  const std::size_t bytes_max_;
  std::mutex mutex_;
  std::size_t bytes_ = 0;
  std::list<Kept> kept_;  // the newest first
  std::unordered_map<std::string, std::list<Kept>::iterator> by_tag_;
};

}  // namespace rigcal::http
