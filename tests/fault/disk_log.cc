#include "tests/fault/disk_log.h"

#include <elf.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <sys/auxv.h>
#include <sys/file.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <mutex>

#include "tests/fault/real_calls.h"

namespace rigcal::fault {
namespace {

struct Head {
  std::uint32_t act, path_bytes, other_bytes, bytes;
  std::uint64_t inode;
  std::int64_t offset;
};

const std::string& Root() {
  static const std::string root = std::getenv("RIGCAL_FAULT_ROOT") == nullptr ? "" : std::getenv("RIGCAL_FAULT_ROOT");
  return root;
}

std::recursive_mutex& Turns() {
  static std::recursive_mutex turns;
  return turns;
}

// A child that was forked has its own description of the log: its lock would be its parent's else.
int LogOfThisProcess() {
  static int log = -1;
  static pid_t owner = 0;
  if (owner == getpid()) return log;
  owner = getpid();
  const char* name = std::getenv("RIGCAL_FAULT_LOG");
  log = name == nullptr
            ? -1
            : Real<int(const char*, int, ...)>("open")(name, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
  return log;
}

// Where the program itself lies in memory: none of the libraries.
struct Image {
  std::uint64_t base = 0, begin = 0, end = 0;
};

int TakeFirst(dl_phdr_info* info, std::size_t, void* out) {
  auto& image = *static_cast<Image*>(out);
  image.base = image.begin = info->dlpi_addr;
  for (int i = 0; i < info->dlpi_phnum; ++i)
    if (info->dlpi_phdr[i].p_type == PT_LOAD)
      image.end = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr + info->dlpi_phdr[i].p_memsz;
  return 1;
}

const Image& Program() {
  static const Image image = [] {
    Image found;
    dl_iterate_phdr(TakeFirst, &found);
    return found;
  }();
  return image;
}

}  // namespace

bool IsRecording() { return !Root().empty() && std::getenv("RIGCAL_FAULT_LOG") != nullptr; }

DiskTurn::DiskTurn() : log_(-1) {
  Turns().lock();
  log_ = LogOfThisProcess();
  if (log_ >= 0) flock(log_, LOCK_EX);
}

DiskTurn::~DiskTurn() {
  if (log_ >= 0) flock(log_, LOCK_UN);
  Turns().unlock();
}

void DiskTurn::Note(const DiskRecord& record) {
  Head head{static_cast<std::uint32_t>(record.act),
            static_cast<std::uint32_t>(record.path.size()),
            static_cast<std::uint32_t>(record.other.size()),
            static_cast<std::uint32_t>(record.bytes.size()),
            record.inode,
            record.offset};
  std::array<iovec, 4> parts{{{&head, sizeof head},
                              {const_cast<char*>(record.path.data()), record.path.size()},
                              {const_cast<char*>(record.other.data()), record.other.size()},
                              {const_cast<char*>(record.bytes.data()), record.bytes.size()}}};
  std::size_t size = 0;
  for (const iovec& part : parts) size += part.iov_len;
  if (log_ < 0 ||
      Real<ssize_t(int, const iovec*, int)>("writev")(log_, parts.data(), 4) != static_cast<ssize_t>(size)) {
    std::fputs("the disk's record cannot be written\n", stderr);
    std::_Exit(99);
  }
}

std::string PathOf(int descriptor) {
  std::array<char, 4096> path;
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = readlink(link.c_str(), path.data(), path.size());
  return size > 0 && path[0] == '/' ? std::string(path.data(), static_cast<std::size_t>(size)) : "";
}

std::string AbsolutePath(int folder, const char* path) {
  if (path[0] == '/') return std::filesystem::path(path).lexically_normal().string();
  std::array<char, 4096> here;
  const std::string above =
      folder == AT_FDCWD ? (getcwd(here.data(), here.size()) == nullptr ? "" : here.data()) : PathOf(folder);
  std::string whole = (std::filesystem::path(above) / path).lexically_normal().string();
  if (whole.size() > 1 && whole.back() == '/') whole.pop_back();
  return whole;
}

bool IsOurs(std::string_view path) {
  const std::string& root = Root();
  return !root.empty() && path.size() > root.size() && path.starts_with(root) && path[root.size()] == '/' &&
         !path.ends_with("-shm");
}

bool IsRootOrOurs(std::string_view path) { return IsOurs(path) || (!path.empty() && path == Root()); }

const std::string& ProgramName() {
  static const std::string name = [] {
    std::array<char, 4096> path;
    const ssize_t size = readlink("/proc/self/exe", path.data(), path.size());
    return std::filesystem::path(std::string(path.data(), size > 0 ? static_cast<std::size_t>(size) : 0))
        .filename()
        .string();
  }();
  return name;
}

std::string Callers() {
  std::array<void*, 48> frames;
  const int count = backtrace(frames.data(), static_cast<int>(frames.size()));
  std::string text;
  for (int i = 0; i < count; ++i) {
    const auto address = reinterpret_cast<std::uint64_t>(frames[static_cast<std::size_t>(i)]);
    if (address < Program().begin || address >= Program().end) continue;
    const std::uint64_t relative = address - Program().base;
    text.append(reinterpret_cast<const char*>(&relative), sizeof relative);
  }
  return text;
}

}  // namespace rigcal::fault
