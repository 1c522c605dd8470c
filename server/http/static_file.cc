#include "server/http/static_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <vector>

#include "server/http/conditions.h"
#include "server/http/open_below.h"
#include "server/http/pages/open_notice.h"
#include "server/http/reply.h"
#include "server/http/site.h"

// civetweb's own file sending is not used: it sends one byte too many for a range that ends beyond the file, a negative
// length for one that begins beyond it, and knows neither "bytes=-100" nor lists of tags.
namespace rigcal::http {
namespace {

class OpenFile {
 public:
  explicit OpenFile(FileDescriptor file) : file_(std::move(file)) {
    is_file_ = file_.get() >= 0 && ::fstat(file_.get(), &status_) == 0 && S_ISREG(status_.st_mode);
  }
  [[nodiscard]] bool is_file() const { return is_file_; }
  [[nodiscard]] std::int64_t size_bytes() const { return status_.st_size; }
  [[nodiscard]] std::string Tag() const { return "\"" + Name() + "\""; }
  // Of its contents: another one once it is written anew.
  [[nodiscard]] std::string Name() const {
    return std::to_string(status_.st_ino) + "-" + std::to_string(status_.st_size) + "-" +
           std::to_string(status_.st_mtim.tv_sec) + "." + std::to_string(status_.st_mtim.tv_nsec);
  }
  // Bytes read at `offset`; 0 at the end or where the disk failed.
  [[nodiscard]] std::size_t Read(std::vector<char>& buffer, std::int64_t offset, std::int64_t wanted) const {
    const auto count = std::min(static_cast<std::int64_t>(buffer.size()), wanted);
    const ssize_t got = ::pread(file_.get(), buffer.data(), static_cast<std::size_t>(count), offset);
    return got > 0 ? static_cast<std::size_t>(got) : 0;
  }

 private:
  FileDescriptor file_;
  struct stat status_ = {};
  bool is_file_ = false;
};

std::string ContentType(const std::string& file) {
  const std::string type = mg_get_builtin_mime_type(file.c_str());
  const bool is_text = type.rfind("text/", 0) == 0 || type == "application/javascript" || type == "application/json";
  return is_text ? type + "; charset=utf-8" : type;
}

// Pictures and scripts are named by their digest: they never change. The rest may be rendered anew by a newer version.
std::string CacheControl(const std::string& file) {
  return CacheControlOf(file.find("/evidence/") != std::string::npos || file.find("/assets/") != std::string::npos);
}

void SendRange(mg_connection* connection, const OpenFile& open, ByteRange range) {
  std::vector<char> buffer(64 << 10);
  for (std::int64_t offset = range.first; offset <= range.last;) {
    const std::size_t got = open.Read(buffer, offset, range.last - offset + 1);
    if (got == 0 || !SendBytes(connection, {buffer.data(), got})) return mg_disable_keep_alive(connection);
    offset += static_cast<std::int64_t>(got);
  }
}

// Empty where the disk fails.
std::string Whole(const OpenFile& open) {
  std::string all;
  std::vector<char> buffer(64 << 10);
  for (std::int64_t left = open.size_bytes(); left > 0;) {
    const std::size_t got = open.Read(buffer, open.size_bytes() - left, left);
    if (got == 0) return "";
    all.append(buffer.data(), got);
    left -= static_cast<std::int64_t>(got);
  }
  return all;
}

RangeAnswer WantedRange(const mg_connection* connection, const OpenFile& open) {
  const std::string_view if_range = HeaderOf(connection, "If-Range");
  if (IsHead(connection) || (!if_range.empty() && if_range != open.Tag())) return {};
  return ParseRange(HeaderOf(connection, "Range"), open.size_bytes());
}

int SendOpen(mg_connection* connection, const OpenFile& open, Headers headers) {
  const RangeAnswer wanted = WantedRange(connection, open);
  const std::string size = std::to_string(open.size_bytes());
  if (wanted.kind == RangeKind::kUnsatisfiable) {
    headers.emplace_back("Content-Range", "bytes */" + size);
    SendHead(connection, 416, 0, headers);
    return 416;
  }
  const bool part = wanted.kind == RangeKind::kPart;
  const ByteRange range = part ? wanted.range : ByteRange{0, open.size_bytes() - 1};
  if (part)
    headers.emplace_back("Content-Range",
                         "bytes " + std::to_string(range.first) + "-" + std::to_string(range.last) + "/" + size);
  SendHead(connection, part ? 206 : 200, range.last - range.first + 1, headers);
  if (!IsHead(connection)) SendRange(connection, open, range);
  return part ? 206 : 200;
}

}  // namespace

int SendFile(mg_connection* connection, const std::filesystem::path& folder, const std::string& file) {
  const OpenFile open(OpenBelow(folder, file));
  if (!open.is_file()) return 404;
  const std::string type = ContentType(file);
  if (IsPage(type) && (IsOpenTo(connection) || !SiteOf(connection).note.empty()))
    if (const std::string page = Whole(open); !page.empty()) return SendBody(connection, page, type);
  Headers headers = {{"Cache-Control", CacheControl(file)}, {"Accept-Ranges", "bytes"}, {"Content-Type", type}};
  const auto size_bytes = static_cast<std::size_t>(open.size_bytes());
  const bool is_whole = HeaderOf(connection, "Range").empty();
  if (const auto status =
          is_whole ? SendCompressed(connection, open.Name(), size_bytes, headers, [&open] { return Whole(open); })
                   : std::nullopt)
    return *status;
  headers.emplace_back("ETag", open.Tag());
  if (!MatchesTag(HeaderOf(connection, "If-None-Match"), open.Tag())) return SendOpen(connection, open, headers);
  SendHead(connection, 304, 0, headers);
  return 304;
}

}  // namespace rigcal::http
