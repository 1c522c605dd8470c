#include "client/upkeep/support/machine.h"

#include <sys/statvfs.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

namespace rigcal::client {
namespace {

constexpr std::streamoff kLogBytesMax = 4 << 20;
constexpr const char* kJournal = "journalctl --unit rigcald --lines 5000 --no-pager --output short-iso 2>&1";

std::string FirstLines(const char* file, int count) {
  std::ifstream in(file);
  std::string text, line;
  for (int i = 0; i < count && std::getline(in, line); ++i) text += line + "\n";
  return text;
}

std::string KernelText() {
  utsname name{};
  if (uname(&name) != 0) return "kernel: not known\n";
  return "kernel: " + std::string(name.sysname) + " " + name.release + " " + name.version + " " + name.machine + "\n";
}

std::string DiskText(const std::filesystem::path& data) {
  struct statvfs disk {};
  if (statvfs(data.c_str(), &disk) != 0) return "disk of " + data.string() + ": not known\n";
  const auto bytes = [&](auto blocks) { return std::to_string(std::uint64_t{blocks} * disk.f_frsize); };
  return "disk of " + data.string() + ": " + bytes(disk.f_blocks) + " bytes, free " + bytes(disk.f_bavail) +
         "; files free " + std::to_string(disk.f_favail) + "\n";
}

Result<std::string> JournalText() {
  const std::unique_ptr<FILE, int (*)(FILE*)> out(popen(kJournal, "r"), pclose);
  if (!out) return Fail(ErrorCode::kStorage, "journalctl cannot be started", "Give the log's file as --log FILE.");
  std::string text;
  std::array<char, 65'536> piece{};
  while (const std::size_t count = fread(piece.data(), 1, piece.size(), out.get())) text.append(piece.data(), count);
  return text;
}

}  // namespace

std::string MachineText(const std::filesystem::path& data) {
  return KernelText() + FirstLines("/etc/os-release", 1) +
         "processors: " + std::to_string(sysconf(_SC_NPROCESSORS_ONLN)) + "\nload: " + FirstLines("/proc/loadavg", 1) +
         "up (s): " + FirstLines("/proc/uptime", 1) + DiskText(data) + FirstLines("/proc/meminfo", 5);
}

Result<std::string> LastLog(const std::filesystem::path& file) {
  if (file.empty()) return JournalText();
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) return Fail(ErrorCode::kNotFound, file.string() + " cannot be read", "Give the log of rigcald.");
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - kLogBytesMax));
  std::ostringstream text;
  text << in.rdbuf();
  const std::string read = text.str();
  return size <= kLogBytesMax ? read : read.substr(std::min(read.find('\n') + 1, read.size()));
}

}  // namespace rigcal::client
