#include "client/change/agent_file.h"

#include <sys/stat.h>

#include <cerrno>

#include "server/base/digests/sha256.h"
#include "server/base/files/durable_file.h"

namespace rigcal::client {

Result<std::optional<AppliedFile>> LookAtApplied(const std::filesystem::path& file) {
  struct stat found {};
  if (stat(file.c_str(), &found) != 0 && errno == ENOENT) return std::nullopt;
  RIGCAL_ASSIGN(const Digest digest, Sha256OfFile(file));
  return AppliedFile{digest, {found.st_mtim.tv_sec * 1'000'000'000LL + found.st_mtim.tv_nsec}};
}

// Quotation marks within texts are escaped, so the first such key is the answer's own; nothing before it has one in an
// object.
std::string_view DocumentIn(std::string_view answer) {
  constexpr std::string_view kKey = "\"document\":";
  const std::size_t key = answer.find(kKey);
  if (key == std::string_view::npos) return {};
  const std::size_t begin = key + kKey.size();
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = begin; i < answer.size(); ++i) {
    const char c = answer[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text) {
      depth += c == '{' ? 1 : c == '}' ? -1 : 0;
      if (depth == 0) return c == '}' ? answer.substr(begin, i + 1 - begin) : std::string_view();
    }
  }
  return {};
}

Status Apply(std::string_view document, const Digest& digest, const std::filesystem::path& file) {
  if (Sha256Of(document) == digest) return WriteDurably(file, document);
  return Fail(
      ErrorCode::kStorage, "the calibration that came is not that of its digest " + digest.str().substr(0, 12),
      "The file stays as it is. Run `rigcal doctor`; if it says nothing, report this with the log of the server.");
}

}  // namespace rigcal::client
