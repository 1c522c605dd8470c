#include "storage/database/write_ahead_log.h"

#include <array>
#include <optional>

namespace rigcal::storage {
namespace {

constexpr std::int64_t kHeaderBytes = kLogHeaderBytes;
constexpr int kPageBytesMin = 512, kPageBytesMax = 65536;
constexpr int kUsualPageBytes = 4096;
constexpr std::uint32_t kMagic = 0x377f0682;  // its last bit: checksums are of big-endian words

using Salts = std::array<unsigned char, 8>;

struct Sums {
  std::uint32_t first = 0, second = 0;
  bool operator==(const Sums&) const = default;
};

std::uint32_t WordAt(const unsigned char* at, bool is_big) {
  const auto byte = [at, is_big](int i) { return static_cast<std::uint32_t>(at[is_big ? i : 3 - i]); };
  return byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
}

Sums GoneOn(Sums sums, std::span<const unsigned char> bytes, bool is_big) {
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
    sums.first += WordAt(&bytes[at], is_big) + sums.second;
    sums.second += WordAt(&bytes[at + 4], is_big) + sums.first;
  }
  return sums;
}

Sums StoredAt(const unsigned char* at) { return {WordAt(at, true), WordAt(at + 4, true)}; }

struct Header {
  bool is_good = false, sums_are_big = false;
  int page_bytes = kUsualPageBytes;
  Salts salts{};
  Sums sums;
};

Salts SaltsAt(const unsigned char* at) {
  Salts salts;
  std::copy(at, at + salts.size(), salts.begin());
  return salts;
}

// Of a log without a whole header: those of its second frame, as the first lies in the header's sector.
Header HeaderByFrames(const LogReader& read) {
  Header header;
  Salts salts;
  if (read(kHeaderBytes + kLogFrameHeaderBytes + kUsualPageBytes + 8, salts)) header.salts = salts;
  return header;
}

Header LoadHeader(const LogReader& read) {
  std::array<unsigned char, kHeaderBytes> bytes{};
  if (!read(0, bytes)) return HeaderByFrames(read);
  Header header;
  header.sums_are_big = (WordAt(bytes.data(), true) & 1) != 0;
  const std::uint32_t page_bytes = WordAt(&bytes[8], true);
  header.salts = SaltsAt(&bytes[16]);
  header.sums = GoneOn({}, std::span(bytes).first(24), header.sums_are_big);
  header.is_good = (WordAt(bytes.data(), true) & ~1U) == kMagic && header.sums == StoredAt(&bytes[24]) &&
                   page_bytes >= kPageBytesMin && page_bytes <= kPageBytesMax && (page_bytes & (page_bytes - 1)) == 0;
  if (!header.is_good) return HeaderByFrames(read);
  header.page_bytes = static_cast<int>(page_bytes);
  return header;
}

class Walk {
 public:
  explicit Walk(const Header& header)
      : header_(header), bytes_(static_cast<std::size_t>(kLogFrameHeaderBytes + header.page_bytes)) {
    look_.has_header = is_read_ = header.is_good;
    look_.page_bytes = header.page_bytes;
    if (is_read_) before_ = header.sums;
  }

  [[nodiscard]] std::span<unsigned char> bytes() { return bytes_; }
  // Of the frame that `bytes` holds; `is_there` false: it cannot be read.
  void Take(std::int64_t offset, bool is_there);
  // `end`: where the last frame ends.
  [[nodiscard]] LogLook Finish(std::int64_t end);

 private:
  void TakeUnread(const LogFrame& frame, bool is_whole);

  const Header& header_;
  std::vector<unsigned char> bytes_;
  LogLook look_;
  std::optional<Sums> before_;  // stored in the frame before; nothing: that is of no use
  bool is_read_ = false;        // every frame until now is as it was written
  bool is_behind_commit_ = false;
};

void Walk::Take(std::int64_t offset, bool is_there) {
  const LogFrame frame{offset, WordAt(bytes_.data(), true), WordAt(&bytes_[4], true) != 0};
  const bool is_of_lap = is_there && frame.page != 0 && SaltsAt(&bytes_[8]) == header_.salts;
  const Sums stored = StoredAt(&bytes_[16]);
  const auto sums = [&] {
    const Sums of_header = GoneOn(*before_, std::span(bytes_).first(8), header_.sums_are_big);
    return GoneOn(of_header, std::span(bytes_).subspan(kLogFrameHeaderBytes), header_.sums_are_big);
  };
  const bool is_whole = is_of_lap && before_ && sums() == stored;
  before_ = is_of_lap ? std::optional(stored) : std::nullopt;
  if (!is_read_) return TakeUnread(frame, is_whole);
  is_read_ = is_whole;
  if (is_whole) return look_.read.push_back(frame);
  look_.stops_at = offset;
  look_.lacks_commit = is_of_lap && frame.ends_commit;
}

void Walk::TakeUnread(const LogFrame& frame, bool is_whole) {
  if (is_whole) {
    look_.is_damaged = look_.is_damaged || is_behind_commit_;
    look_.unread.push_back(frame);
    look_.unread_commits += frame.ends_commit ? 1 : 0;
    look_.lacks_commit = look_.lacks_commit || frame.ends_commit;
  }
  is_behind_commit_ = is_whole && frame.ends_commit;
}

void LeaveCommits(std::vector<LogFrame>& frames) {
  while (!frames.empty() && !frames.back().ends_commit) frames.pop_back();
}

LogLook Walk::Finish(std::int64_t end) {
  if (is_read_) look_.stops_at = end;
  LeaveCommits(look_.read);
  LeaveCommits(look_.unread);
  if (header_.is_good) look_.read_bytes = kHeaderBytes;
  if (!look_.read.empty()) look_.read_bytes = look_.read.back().offset + static_cast<std::int64_t>(bytes_.size());
  return std::move(look_);
}

}  // namespace

LogLook LookAtLog(const LogReader& read, std::int64_t bytes) {
  const Header header = LoadHeader(read);
  Walk walk(header);
  const auto frame_bytes = static_cast<std::int64_t>(walk.bytes().size());
  std::int64_t offset = kHeaderBytes;
  for (; offset + frame_bytes <= bytes; offset += frame_bytes) walk.Take(offset, read(offset, walk.bytes()));
  return walk.Finish(offset);
}

bool IsFrameGood(const LogReader& read, std::int64_t offset, std::span<const unsigned char> page) {
  const Header header = LoadHeader(read);
  if (!header.is_good) return false;
  if (header.page_bytes != static_cast<int>(page.size())) return true;
  std::array<unsigned char, kLogFrameHeaderBytes> own{}, before{};
  if (!read(offset, own) || SaltsAt(&own[8]) != header.salts) return false;
  Sums sums = header.sums;
  if (offset > kHeaderBytes) {
    if (!read(offset - kLogFrameHeaderBytes - header.page_bytes, before)) return false;
    sums = StoredAt(&before[16]);
  }
  sums = GoneOn(sums, std::span(own).first(8), header.sums_are_big);
  return GoneOn(sums, page, header.sums_are_big) == StoredAt(&own[16]);
}

}  // namespace rigcal::storage
