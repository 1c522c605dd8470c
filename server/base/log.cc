#include "server/base/log.h"

#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <nlohmann/json.hpp>

namespace rigcal {
namespace {

constexpr const char* kTextPattern = "%Y-%m-%dT%H:%M:%S.%eZ %l %v";
constexpr const char* kJsonPattern = R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v)";  // %v closes it

std::atomic<LogForm> form_in_use{LogForm::kText};
thread_local LogSubject subject_of_thread;

spdlog::level::level_enum LevelOf(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return spdlog::level::debug;
    case LogLevel::kInfo:
      return spdlog::level::info;
    case LogLevel::kWarn:
      return spdlog::level::warn;
    case LogLevel::kError:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

std::unique_ptr<spdlog::pattern_formatter> FormatterOf(const char* pattern) {
  return std::make_unique<spdlog::pattern_formatter>(pattern, spdlog::pattern_time_type::utc);
}

std::unique_ptr<spdlog::logger> MakeLogger() {
  auto logger = std::make_unique<spdlog::logger>("rigcal", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_formatter(FormatterOf(kTextPattern));
  logger->flush_on(spdlog::level::trace);
  return logger;
}

// Never destroyed: threads and static objects may log until the very end of the process.
spdlog::logger& Logger() {
  static spdlog::logger& logger = *MakeLogger().release();
  return logger;
}

std::function<void(ErrorCode)>& ToldOfErrors() {
  static auto& told = *std::make_unique<std::function<void(ErrorCode)>>().release();
  return told;
}

const std::string& Either(const std::string& own, const std::string& of_thread) {
  return own.empty() ? of_thread : own;
}

// From its second field on, without the brace that opens it.
std::string JsonOf(const LogSubject& subject, const std::string& line) {
  nlohmann::ordered_json json;
  const auto put = [&](const char* name, const std::string& value) {
    if (!value.empty()) json[name] = value;
  };
  json["event"] = subject.event.empty() ? "message" : subject.event;
  put("robot", Either(subject.robot, subject_of_thread.robot));
  put("session", Either(subject.session, subject_of_thread.session));
  put("job", Either(subject.job, subject_of_thread.job));
  put("request", Either(subject.request, subject_of_thread.request));
  put("kind", subject.kind);
  json["text"] = line;
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace).substr(1);
}

}  // namespace

void SetLogLevel(LogLevel level) { Logger().set_level(LevelOf(level)); }

void SetLogForm(LogForm form) {
  form_in_use = form;
  Logger().set_formatter(FormatterOf(form == LogForm::kJson ? kJsonPattern : kTextPattern));
}

LogAbout::LogAbout(LogSubject subject) : before_(std::move(subject)) {
  before_.robot = Either(before_.robot, subject_of_thread.robot);
  before_.session = Either(before_.session, subject_of_thread.session);
  before_.job = Either(before_.job, subject_of_thread.job);
  before_.request = Either(before_.request, subject_of_thread.request);
  std::swap(before_, subject_of_thread);
}

LogAbout::~LogAbout() { subject_of_thread = std::move(before_); }

void Log(LogLevel level, std::string_view text) { Log(level, {}, text); }

namespace {

void Write(LogLevel level, const LogSubject& subject, std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, ' ');
  if (form_in_use == LogForm::kJson) line = JsonOf(subject, line);
  Logger().log(LevelOf(level), spdlog::string_view_t(line.data(), line.size()));
}

// Whoever logs goes on; that a line is missing is said without memory.
template <typename Writing>
void Spared(const Writing& writing) noexcept {
  constexpr std::string_view kMissing = "rigcal: a line of the log is missing, there was no memory for it\n";
  try {
    writing();
  } catch (const std::exception&) {
    static_cast<void>(!write(STDERR_FILENO, kMissing.data(), kMissing.size()));
  }
}

}  // namespace

void Log(LogLevel level, const LogSubject& subject, std::string_view text) {
  if (Logger().should_log(LevelOf(level))) Spared([&] { Write(level, subject, text); });
}

void LogError(const Error& error) {
  Spared([&] {
    const std::string kind = NameOf(error.code);
    Log(LogLevel::kError, {.event = "error", .kind = kind}, Sentence(error));
    if (ToldOfErrors()) ToldOfErrors()(error.code);
  });
}

void OnLoggedError(std::function<void(ErrorCode)> told) { ToldOfErrors() = std::move(told); }

}  // namespace rigcal
