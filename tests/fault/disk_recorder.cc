// Preloaded (LD_PRELOAD) into a program of ours: takes the place of the calls that change files, does them, and notes
// what was done below the root (disk_log.h). Nothing is really synced: no power is lost, and it would only take time.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <string>

#include "tests/fault/disk_log.h"
#include "tests/fault/planned_failure.h"
#include "tests/fault/real_calls.h"

namespace rigcal::fault {
namespace {

std::uint64_t InodeOf(int descriptor) {
  struct stat info = {};
  return fstat(descriptor, &info) == 0 ? info.st_ino : 0;
}

std::uint64_t InodeOf(const std::string& path) {
  struct stat info = {};
  return lstat(path.c_str(), &info) == 0 ? info.st_ino : 0;
}

bool IsOursOpen(int descriptor) { return IsRecording() && IsOurs(PathOf(descriptor)); }

int OpenReal(int folder, const char* path, int flags, mode_t mode) {
  return Real<int(int, const char*, int, ...)>("openat")(folder, path, flags, mode);
}

void NoteOpened(DiskTurn& turn, const std::string& path, int descriptor, int flags, bool was_there) {
  const bool is_nameless = (flags & O_TMPFILE) == O_TMPFILE;
  if (is_nameless) return turn.Note({DiskAct::kCreate, InodeOf(descriptor), 0, "", "", ""});
  if (!was_there) return turn.Note({DiskAct::kCreate, InodeOf(descriptor), 0, path, "", ""});
  if ((flags & O_TRUNC) != 0) turn.Note({DiskAct::kTruncate, InodeOf(descriptor), 0, "", "", ""});
}

int Open(int folder, const char* name, int flags, mode_t mode) {
  if (!IsRecording()) return OpenReal(folder, name, flags, mode);
  const std::string path = AbsolutePath(folder, name);
  if (!IsOurs(path)) return OpenReal(folder, name, flags, mode);
  DiskTurn turn;
  if (FailsAsPlanned("open")) return -1;
  const bool was_there = access(path.c_str(), F_OK) == 0;
  const int descriptor = OpenReal(folder, name, flags, mode);
  if (descriptor >= 0 && (flags & (O_CREAT | O_TRUNC | O_TMPFILE)) != 0)
    NoteOpened(turn, path, descriptor, flags, was_there);
  return descriptor;
}

// What `write` reports is what was written; `offset` negative: where the file stands.
template <typename Call>
ssize_t Write(int descriptor, const char* bytes, off_t offset, const Call& write) {
  if (!IsOursOpen(descriptor)) return write();
  DiskTurn turn;
  if (FailsAsPlanned("write")) return -1;
  if (offset < 0 && (fcntl(descriptor, F_GETFL) & O_APPEND) != 0) offset = lseek(descriptor, 0, SEEK_END);
  if (offset < 0) offset = lseek(descriptor, 0, SEEK_CUR);
  const ssize_t written = write();
  if (written > 0)
    turn.Note({DiskAct::kWrite, InodeOf(descriptor), offset, "", "", {bytes, static_cast<std::size_t>(written)}});
  return written;
}

int Resize(std::uint64_t inode, const std::string& path, off_t size, const auto& resize) {
  if (!IsRecording() || !IsOurs(path)) return resize();
  DiskTurn turn;
  if (FailsAsPlanned("change")) return -1;
  const int result = resize();
  if (result == 0) turn.Note({DiskAct::kTruncate, inode, size, "", "", ""});
  return result;
}

int Sync(int descriptor, DiskAct act, const auto& sync) {
  const std::string path = PathOf(descriptor);
  if (!IsRecording() || !IsRootOrOurs(path)) return sync();
  DiskTurn turn;
  if (FailsAsPlanned("sync")) return -1;
  struct stat info = {};
  fstat(descriptor, &info);
  turn.Note({act, info.st_ino, S_ISDIR(info.st_mode) ? 1 : 0, path, ProgramName(), Callers()});
  return 0;
}

// `note` is called in turn, when it was done.
int Change(const std::string& path, const char* kind, const auto& change, const auto& note) {
  if (!IsRecording() || !IsOurs(path)) return change();
  DiskTurn turn;
  if (FailsAsPlanned(kind)) return -1;
  const int result = change();
  if (result == 0) note(turn);
  return result;
}

int Rename(int from_folder, const char* from, int to_folder, const char* to) {
  const auto rename = [&] {
    return Real<int(int, const char*, int, const char*)>("renameat")(from_folder, from, to_folder, to);
  };
  const std::string source = AbsolutePath(from_folder, from), target = AbsolutePath(to_folder, to);
  return Change(target, "rename", rename, [&](DiskTurn& turn) {
    turn.Note({DiskAct::kRename, 0, 0, source, target, ""});
  });
}

int Link(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  const auto link = [&] {
    return Real<int(int, const char*, int, const char*, int)>("linkat")(from_folder, from, to_folder, to, flags);
  };
  const std::string target = AbsolutePath(to_folder, to);
  return Change(target, "change", link, [&](DiskTurn& turn) {
    turn.Note({DiskAct::kLink, InodeOf(target), 0, target, "", ""});
  });
}

int Remove(int folder, const char* name, int flags) {
  const auto remove = [&] { return Real<int(int, const char*, int)>("unlinkat")(folder, name, flags); };
  const std::string path = AbsolutePath(folder, name);
  return Change(path, "change", remove, [&](DiskTurn& turn) { turn.Note({DiskAct::kRemove, 0, 0, path, "", ""}); });
}

int MakeFolder(int folder, const char* name, mode_t mode) {
  const auto make = [&] { return Real<int(int, const char*, mode_t)>("mkdirat")(folder, name, mode); };
  const std::string path = AbsolutePath(folder, name);
  return Change(path, "change", make, [&](DiskTurn& turn) {
    turn.Note({DiskAct::kMakeFolder, InodeOf(path), 0, path, "", ""});
  });
}

ssize_t Copy(int out, int in, off_t* from, std::size_t count) {
  static thread_local char piece[1 << 16];
  count = std::min(count, sizeof piece);
  const ssize_t got = from == nullptr ? read(in, piece, count) : pread(in, piece, count, *from);
  if (got <= 0) return got;
  const ssize_t written = ::write(out, piece, static_cast<std::size_t>(got));
  if (written > 0 && from != nullptr) *from += written;
  if (written >= 0 && written < got && from == nullptr) lseek(in, written - got, SEEK_CUR);
  return written;
}

int FlagsOf(const char* mode) {
  const bool both = std::strchr(mode, '+') != nullptr;
  const int access = both ? O_RDWR : mode[0] == 'r' ? O_RDONLY : O_WRONLY;
  return access |
         (mode[0] == 'w'   ? O_CREAT | O_TRUNC
          : mode[0] == 'a' ? O_CREAT | O_APPEND
                           : 0) |
         (std::strchr(mode, 'x') != nullptr ? O_EXCL : 0) | (std::strchr(mode, 'e') != nullptr ? O_CLOEXEC : 0);
}

mode_t ModeIn(std::va_list more, int flags) { return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0; }

}  // namespace
}  // namespace rigcal::fault

namespace fault = rigcal::fault;
using fault::DiskAct;
using fault::DiskTurn;
using fault::Real;

extern "C" {

#define RIGCAL_OPEN(name, extra)                                 \
  int name(const char* path, int flags, ...) {                   \
    std::va_list more;                                           \
    va_start(more, flags);                                       \
    const mode_t mode = fault::ModeIn(more, flags);              \
    va_end(more);                                                \
    return fault::Open(AT_FDCWD, path, (flags) | (extra), mode); \
  }
RIGCAL_OPEN(open, 0)
RIGCAL_OPEN(open64, O_LARGEFILE)

#define RIGCAL_OPENAT(name)                                \
  int name(int folder, const char* path, int flags, ...) { \
    std::va_list more;                                     \
    va_start(more, flags);                                 \
    const mode_t mode = fault::ModeIn(more, flags);        \
    va_end(more);                                          \
    return fault::Open(folder, path, flags, mode);         \
  }
RIGCAL_OPENAT(openat)
RIGCAL_OPENAT(openat64)

FILE* fopen(const char* path, const char* mode) {
  const int flags = fault::FlagsOf(mode);
  const int descriptor = fault::Open(AT_FDCWD, path, flags, 0666);
  return descriptor < 0 ? nullptr : fdopen(descriptor, mode);
}
FILE* fopen64(const char* path, const char* mode) { return fopen(path, mode); }

ssize_t write(int file, const void* bytes, std::size_t count) {
  return fault::Write(file, static_cast<const char*>(bytes), -1,
                      [&] { return Real<ssize_t(int, const void*, std::size_t)>("write")(file, bytes, count); });
}

ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t offset) {
  return fault::Write(file, static_cast<const char*>(bytes), offset, [&] {
    return Real<ssize_t(int, const void*, std::size_t, off_t)>("pwrite")(file, bytes, count, offset);
  });
}
ssize_t pwrite64(int file, const void* bytes, std::size_t count, off_t offset) {
  return pwrite(file, bytes, count, offset);
}

ssize_t writev(int file, const iovec* parts, int count) {
  if (!fault::IsOursOpen(file)) return Real<ssize_t(int, const iovec*, int)>("writev")(file, parts, count);
  std::string whole;
  for (int i = 0; i < count; ++i) whole.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
  return write(file, whole.data(), whole.size());
}

ssize_t sendfile(int out, int in, off_t* from, std::size_t count) {
  if (!fault::IsOursOpen(out)) return Real<ssize_t(int, int, off_t*, std::size_t)>("sendfile")(out, in, from, count);
  return fault::Copy(out, in, from, count);
}
ssize_t sendfile64(int out, int in, off_t* from, std::size_t count) { return sendfile(out, in, from, count); }
ssize_t copy_file_range(int in, off_t* from, int out, off_t* to, std::size_t count, unsigned flags) {
  if (fault::IsOursOpen(out)) return errno = EXDEV, -1;  // callers copy in another way
  return Real<ssize_t(int, off_t*, int, off_t*, std::size_t, unsigned)>("copy_file_range")(in, from, out, to, count,
                                                                                           flags);
}

int ftruncate(int file, off_t size) noexcept {
  return fault::Resize(fault::InodeOf(file), fault::PathOf(file), size,
                       [&] { return Real<int(int, off_t)>("ftruncate")(file, size); });
}
int ftruncate64(int file, off_t size) noexcept { return ftruncate(file, size); }
int truncate(const char* path, off_t size) noexcept {
  const std::string whole = fault::AbsolutePath(AT_FDCWD, path);
  return fault::Resize(fault::InodeOf(whole), whole, size,
                       [&] { return Real<int(const char*, off_t)>("truncate")(path, size); });
}
int truncate64(const char* path, off_t size) noexcept { return truncate(path, size); }

// Room alone, which a power loss may take back: zeros at the end, if any.
int fallocate(int file, int mode, off_t offset, off_t size) {
  struct stat info = {};
  const auto allocate = [&] { return Real<int(int, int, off_t, off_t)>("fallocate")(file, mode, offset, size); };
  if (mode != 0 || fstat(file, &info) != 0 || info.st_size >= offset + size) return allocate();
  return fault::Resize(info.st_ino, fault::PathOf(file), offset + size, allocate);
}

int fsync(int file) {
  return fault::Sync(file, DiskAct::kSync, [&] { return Real<int(int)>("fsync")(file); });
}
int fdatasync(int file) {
  return fault::Sync(file, DiskAct::kSync, [&] { return Real<int(int)>("fdatasync")(file); });
}
int syncfs(int file) noexcept {
  return fault::Sync(file, DiskAct::kSyncDisk, [&] { return Real<int(int)>("syncfs")(file); });
}

int rename(const char* from, const char* to) noexcept { return fault::Rename(AT_FDCWD, from, AT_FDCWD, to); }
int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  return fault::Rename(from_folder, from, to_folder, to);
}
int link(const char* from, const char* to) noexcept { return fault::Link(AT_FDCWD, from, AT_FDCWD, to, 0); }
int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) noexcept {
  return fault::Link(from_folder, from, to_folder, to, flags);
}
int unlink(const char* path) noexcept { return fault::Remove(AT_FDCWD, path, 0); }
int unlinkat(int folder, const char* path, int flags) noexcept { return fault::Remove(folder, path, flags); }
int rmdir(const char* path) noexcept { return fault::Remove(AT_FDCWD, path, AT_REMOVEDIR); }
int remove(const char* path) noexcept {
  struct stat info = {};
  const bool is_folder = lstat(path, &info) == 0 && S_ISDIR(info.st_mode);
  return fault::Remove(AT_FDCWD, path, is_folder ? AT_REMOVEDIR : 0);
}
int mkdir(const char* path, mode_t mode) noexcept { return fault::MakeFolder(AT_FDCWD, path, mode); }
int mkdirat(int folder, const char* path, mode_t mode) noexcept { return fault::MakeFolder(folder, path, mode); }
int mknod(const char* path, mode_t mode, dev_t device) noexcept {
  const std::string whole = fault::AbsolutePath(AT_FDCWD, path);
  return fault::Change(
      whole, "change", [&] { return Real<int(const char*, mode_t, dev_t)>("mknod")(path, mode, device); },
      [&](DiskTurn& turn) {
        turn.Note({DiskAct::kCreate, fault::InodeOf(whole), 0, whole, "", ""});
      });
}

// For programs of tests, which find it by its name: what they promise from here on.
void RigcalFaultMark(const char* text) { DiskTurn().Note({DiskAct::kMark, 0, 0, text, "", ""}); }

}  // extern "C"
