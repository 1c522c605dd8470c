#include "storage/files/fetched_file.h"

#include <fcntl.h>
#include <unistd.h>

#include "server/base/digests/secret.h"
#include "server/base/files/move_durably.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kNameDigits = 16;

}  // namespace

FetchedFile::FetchedFile(std::filesystem::path target)
    : target_(std::move(target)), temporary_(target_.string() + ".tmp-" + NewSecret().substr(0, kNameDigits)) {}

FetchedFile::~FetchedFile() {
  if (!is_kept_ && file_.get() >= 0) ::unlink(temporary_.c_str());
}

Status FetchedFile::Begin() {
  hash_ = Sha256();
  file_ = FileDescriptor(::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  return file_.get() >= 0 ? Status() : Status(FileFailure(temporary_, "create", errno));
}

Status FetchedFile::Take(std::int64_t at, std::string_view bytes) {
  if (at == 0) RIGCAL_TRY(Begin());
  hash_.Add(bytes);
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return FileFailure(temporary_, "write", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return {};
}

Digest FetchedFile::Hash() { return hash_.Finish(); }

Status FetchedFile::Keep() {
  if (file_.get() < 0) RIGCAL_TRY(Begin());  // an empty one comes in no piece
  is_kept_ = true;
  const Status moved = MoveDurably(std::move(file_), temporary_, target_);
  if (!moved) ::unlink(temporary_.c_str());
  return moved;
}

}  // namespace rigcal::storage
