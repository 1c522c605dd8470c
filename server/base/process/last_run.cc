#include "server/base/process/last_run.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <string>

#include "server/base/files/durable_file.h"
#include "server/base/log.h"

namespace rigcal {
namespace {

constexpr std::array kCrashes = {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP};
constexpr std::size_t kNoteBytesMax = 4096;
constexpr char kRuns = '-', kCrashed = 'x';  // the first byte of a note

volatile int g_note = -1;  // open: a handler may need a disk that is full
std::array<struct sigaction, kCrashes.size()> g_before;

// Then whoever handled the signal before does so.
void NoteCrash(int signal) {
  if (g_note >= 0) static_cast<void>(!pwrite(g_note, &kCrashed, 1, 0));
  for (std::size_t i = 0; i < kCrashes.size(); ++i)
    if (kCrashes[i] == signal) sigaction(signal, &g_before[i], nullptr);
  raise(signal);
}

void HandleCrashes() {
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

std::filesystem::path NoteIn(const std::filesystem::path& folder) { return folder / "run"; }

}  // namespace

RunEnd EndOfLastRun(const std::filesystem::path& folder) {
  const std::string note = ReadFile(NoteIn(folder), kNoteBytesMax).value_or(""), now = MachineState();
  if (note.size() < 2 || note[0] != kRuns || now.empty()) return RunEnd::kMayBeItsOwn;
  const std::string then = note.substr(1);
  const bool same_boot = then.substr(0, then.find('\n')) == now.substr(0, now.find('\n'));
  return !same_boot || then == now ? RunEnd::kFromOutside : RunEnd::kMayBeItsOwn;
}

void BeginRun(const std::filesystem::path& folder) {
  const Status noted = WriteDurably(NoteIn(folder), kRuns + MachineState());
  if (!noted) {
    LogWarn(noted.error().what);
    std::error_code gone;
    std::filesystem::remove(NoteIn(folder), gone);
  }
  const bool handled = g_note >= 0;
  if (handled) close(g_note);
  g_note = open(NoteIn(folder).c_str(), O_WRONLY | O_CLOEXEC);
  if (!handled && g_note >= 0) HandleCrashes();
}

}  // namespace rigcal
