#include "server/base/last_run.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string>

#include "server/base/durable_file.h"
#include "server/base/log.h"

namespace rigcal {
namespace {

constexpr std::array kCrashes = {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV};
constexpr std::size_t kNoteBytesMax = 4096;

std::array<char, 4096> g_crash_note;  // its path: a handler may not make one
std::array<struct sigaction, kCrashes.size()> g_before;

// A file that is there: this run crashed. Then whoever handled the signal before does so.
void NoteCrash(int signal) {
  if (const int file = open(g_crash_note.data(), O_CREAT | O_WRONLY | O_CLOEXEC, 0644); file >= 0) close(file);
  for (std::size_t i = 0; i < kCrashes.size(); ++i)
    if (kCrashes[i] == signal) sigaction(signal, &g_before[i], nullptr);
  raise(signal);
}

void NoteCrashesIn(const std::filesystem::path& note) {
  if (note.native().size() >= g_crash_note.size()) return;
  const bool handled = g_crash_note[0] != '\0';
  std::strcpy(g_crash_note.data(), note.c_str());
  if (handled) return;
  struct sigaction action = {};
  action.sa_handler = NoteCrash;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kCrashes.size(); ++i) sigaction(kCrashes[i], &action, &g_before[i]);
}

std::string LineOf(const char* file, const std::string& starts_with) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(starts_with)) return line;
  return "";
}

// Which boot this is, and how many processes it has killed for want of memory; empty: not known.
std::string MachineState() {
  const std::string boot = LineOf("/proc/sys/kernel/random/boot_id", ""), killed = LineOf("/proc/vmstat", "oom_kill ");
  return boot.empty() || killed.empty() ? "" : boot + "\n" + killed + "\n";
}

RunEnd Judged(const std::string& then, const std::string& now, bool crashed) {
  if (crashed || then.empty() || now.empty()) return RunEnd::kMayBeItsOwn;
  const bool same_boot = then.substr(0, then.find('\n')) == now.substr(0, now.find('\n'));
  return !same_boot || then == now ? RunEnd::kFromOutside : RunEnd::kMayBeItsOwn;
}

}  // namespace

RunEnd BeginRun(const std::filesystem::path& folder) {
  const std::filesystem::path run = folder / "run", crash = folder / "run.crashed";
  const std::string now = MachineState();
  const RunEnd last = Judged(ReadFile(run, kNoteBytesMax).value_or(""), now, std::filesystem::exists(crash));
  std::error_code failed;
  std::filesystem::remove(crash, failed);
  NoteCrashesIn(crash);
  if (const Status noted = WriteDurably(run, now); !noted) LogWarn(noted.error().what);
  return last;
}

}  // namespace rigcal
