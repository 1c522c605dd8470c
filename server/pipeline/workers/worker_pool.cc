#include "server/pipeline/workers/worker_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <thread>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/memory_budget.h"
#include "server/metrics/noted.h"
#include "server/pipeline/workers/worker.h"

extern char** environ;

namespace rigcal::pipeline {
namespace {

using std::chrono::steady_clock;

constexpr int kOrdersMax = 500;
constexpr std::chrono::minutes kStartMax{5};

// What is counted where the server is asked for it; false: the line is about something else.
bool IsNoted(const std::vector<std::string>& fields) {
  const bool erred = fields[0] == "erred" && fields.size() == 2, spent = fields[0] == "spent" && fields.size() == 4;
  if (erred) metrics::NoteError(ErrorCodeOf(fields[1]));
  const auto stage = spent ? metrics::StageOf(fields[1]) : std::nullopt;
  if (stage) metrics::Note({*stage, std::strtod(fields[2].c_str(), nullptr), fields[3] == "failed"});
  return erred || spent;
}

struct Pipe {
  PipeEnd read, write;
};
std::optional<Pipe> OpenPipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  return Pipe{PipeEnd(ends[0]), PipeEnd(ends[1])};
}

Error CannotStart(int code) {
  return {ErrorCode::kStorage, std::string("no process to work in could be started: ") + std::strerror(code),
          "Look at the limits of the server: processes, handles and memory."};
}

std::string HowItEnded(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    const std::string name = "signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
    return signal == SIGKILL ? name + ": somebody killed it, or the system did for want of memory" : name;
  }
  return "exit code " + std::to_string(WEXITSTATUS(status));
}

std::int64_t IdleBytesMax() { return std::min<std::int64_t>(512LL << 20, MemoryOfProcess() / 16); }

}  // namespace

void MemoryOnBehalf::Ask(const std::string& id, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  asked_.emplace_back(id, bytes);
  if (asking_) return;
  std::thread([self = shared_from_this()] { self->TakeAll(); }).detach();
  asking_ = true;
}

void MemoryOnBehalf::Give(const std::string& id) {
  const std::lock_guard lock(mutex_);
  shares_.erase(id);
}

void MemoryOnBehalf::End() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  asked_.clear();
  shares_.clear();
}

void MemoryOnBehalf::TakeAll() {
  while (OnceThereIsMemory([this] { return TakeFirst(); })) {
  }
}

bool MemoryOnBehalf::TakeFirst() {
  std::unique_lock lock(mutex_);
  if (asked_.empty()) {
    asking_ = false;
    return false;
  }
  const auto [id, bytes] = asked_.front();
  lock.unlock();
  auto share = DecodingBudget().Take(bytes);
  lock.lock();
  if (ended_) asked_.clear();
  if (ended_) return true;
  if (share) shares_.emplace(id, std::move(*share));
  granted_(id);
  asked_.pop_front();
  return true;
}

PipeEnd::~PipeEnd() {
  if (fd_ >= 0) close(fd_);
}

Result<std::unique_ptr<WorkerProcess>> WorkerProcess::Start(const std::string& program,
                                                            const std::vector<std::string>& arguments) {
  auto orders = OpenPipe(), answers = OpenPipe();
  if (!orders || !answers) return Fail(CannotStart(errno));
  std::vector<char*> texts;
  for (const std::string& argument : arguments) texts.push_back(const_cast<char*>(argument.c_str()));
  texts.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, orders->read.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, answers->write.get(), STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);  // no socket, no lock of the server's
  pid_t pid = -1;
  const int failed = posix_spawn(&pid, program.c_str(), &files, nullptr, texts.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) return Fail(CannotStart(failed));
  return std::unique_ptr<WorkerProcess>(new WorkerProcess(pid, std::move(orders->write), std::move(answers->read)));
}

WorkerProcess::WorkerProcess(pid_t pid, PipeEnd orders, PipeEnd answers)
    : pid_(pid),
      orders_(std::move(orders)),
      answers_(std::move(answers)),
      memory_(std::make_shared<MemoryOnBehalf>([this](const std::string& id) { Say("granted\t" + id); })) {}

WorkerProcess::~WorkerProcess() {
  memory_->End();       // from here on nothing is said to it
  orders_ = PipeEnd();  // it ends with its input
  if (pid_ <= 0) return;
  if (broken_) kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

bool WorkerProcess::Tell(const std::string& order) {
  ++told_;
  broken_ = true;  // until it has said how that went
  Say(order);
  const Time until = steady_clock::now() + kStartMax;
  auto line = NextLine(until);
  while (line && IsNoted(WorkerFields(*line))) line = NextLine(until);  // what it told after the order before
  return line && *line == "begun";
}

WorkerOutcome WorkerProcess::Await(Time until) {
  while (const auto line = NextLine(until)) {
    const std::vector<std::string> fields = WorkerFields(*line);
    if (fields[0] == "take" && fields.size() == 3) memory_->Ask(fields[1], std::stoll(fields[2]));
    if (fields[0] == "give" && fields.size() == 2) memory_->Give(fields[1]);
    if (IsNoted(fields)) continue;
    if (fields[0] != "done" && fields[0] != "failed") continue;
    broken_ = false;
    if (fields[0] == "done" && fields.size() == 2) return {fields[1]};
    if (fields[0] == "failed" && fields.size() == 4)
      return {Fail(static_cast<ErrorCode>(std::stoi(fields[1])), fields[2], fields[3])};
    break;
  }
  broken_ = true;
  memory_->End();
  return {Fail(ErrorCode::kInternal, "the process that did the work ended: " + End(until),
               "Nothing, if it is done at the next attempt; else report it with the log of the server."),
          true};
}

bool WorkerProcess::IsWorthKeeping(std::int64_t bytes_max) const {
  if (broken_ || told_ >= kOrdersMax) return false;
  std::int64_t pages = 0, resident = 0;
  std::ifstream("/proc/" + std::to_string(pid_) + "/statm") >> pages >> resident;
  return resident * sysconf(_SC_PAGESIZE) <= bytes_max;
}

void WorkerProcess::Say(const std::string& text) {
  const std::string line = text + "\n";
  const std::lock_guard lock(saying_);
  for (std::size_t at = 0; at < line.size();) {
    const ssize_t written = write(orders_.get(), line.data() + at, line.size() - at);
    if (written < 0 && errno != EINTR) return;  // its answers end too
    at += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
}

std::optional<std::string> WorkerProcess::NextLine(Time until) {
  while (true) {
    if (const std::size_t end = read_.find('\n'); end != std::string::npos) {
      std::string line = read_.substr(0, end);
      read_.erase(0, end + 1);
      return line;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - steady_clock::now()).count();
    pollfd ready{answers_.get(), POLLIN, 0};
    const int polled =
        poll(&ready, 1, static_cast<int>(std::max<std::int64_t>(0, std::min<std::int64_t>(left, 3'600'000))));
    if (polled < 0 && errno != EINTR) return std::nullopt;
    if (polled == 0 && steady_clock::now() >= until) return std::nullopt;
    if (polled <= 0) continue;
    char bytes[4096];
    const ssize_t count = read(answers_.get(), bytes, sizeof bytes);
    if (count == 0 || (count < 0 && errno != EINTR)) return std::nullopt;
    if (count > 0) read_.append(bytes, static_cast<std::size_t>(count));
  }
}

std::string WorkerProcess::End(Time until) {
  const bool late = steady_clock::now() >= until;
  kill(pid_, SIGKILL);  // nothing, where it has ended
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  return late ? "it took longer than work may" : HowItEnded(status);
}

WorkerPool::WorkerPool(Options options) : options_(std::move(options)) {}
WorkerPool::~WorkerPool() = default;

std::unique_ptr<WorkerProcess> WorkerPool::TakeWarmest() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return nullptr;
  std::unique_ptr<WorkerProcess> worker = std::move(idle_.back());
  idle_.pop_back();
  return worker;
}

void WorkerPool::Warm() {
  auto started = WorkerProcess::Start(options_.program, options_.command);
  if (!started) return LogError(started.error());
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(*started));
}

WorkerPool::Outcome WorkerPool::Run(const std::string& order) {
  std::unique_ptr<WorkerProcess> worker = TakeWarmest();
  while (worker != nullptr && !worker->Tell(order)) worker = TakeWarmest();  // it ended while it was idle
  if (worker == nullptr) {
    auto started = WorkerProcess::Start(options_.program, options_.command);
    if (!started) return {Fail(started.error())};
    worker = std::move(*started);
    if (!worker->Tell(order))
      return {Fail(ErrorCode::kStorage, "a process to work in ended at its start", "Look at the log of the server.")};
  }
  Outcome outcome{std::string()};
  try {
    outcome = worker->Await(std::chrono::steady_clock::now() + options_.order_max);
  } catch (const std::exception& thrown) {  // no thread, no memory
    return {Fail(ErrorCode::kInternal,
                 std::string("the server could not follow the process that did the work: ") + thrown.what(),
                 "Nothing, if it is done at the next attempt; else give the server more memory."),
            true};
  }
  if (!worker->IsWorthKeeping(IdleBytesMax())) return outcome;
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(worker));
  return outcome;
}

}  // namespace rigcal::pipeline
