// One line per event on standard error: time, level, text; or one JSON object with what it is about. Thread-safe.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

enum class LogLevel { kDebug, kInfo, kWarn, kError };
// Less severe events are not written; until the first call, kInfo and above are.
void SetLogLevel(LogLevel level);
// kJson: {"time", "level", "event", ids that there are, "text"} in this order. Before any other thread is made.
enum class LogForm { kText, kJson };
void SetLogForm(LogForm form);

// What an event is about; an empty one is left out. Only JSON shows it: the text says it in words.
struct LogSubject {
  std::string event = {};  // in one word: "receipt", "edge"; empty: "message", or "error" of an error
  std::string robot = {}, session = {}, job = {}, request = {};
  std::string kind = {};  // of a refusal or an error: as NameOf(ErrorCode) spells it
};

// While it lives, what its thread logs is about this too, where the line itself does not say otherwise.
class LogAbout {
 public:
  explicit LogAbout(LogSubject subject);
  ~LogAbout();
  LogAbout(const LogAbout&) = delete;
  LogAbout& operator=(const LogAbout&) = delete;

 private:
  LogSubject before_;
};

// Control characters in `text` become spaces, so that one event stays one line.
void Log(LogLevel level, std::string_view text);
void Log(LogLevel level, const LogSubject& subject, std::string_view text);
inline void LogInfo(std::string_view text) { Log(LogLevel::kInfo, text); }
inline void LogWarn(std::string_view text) { Log(LogLevel::kWarn, text); }
// What went wrong and its cure, as one sentence.
void LogError(const Error& error);
// Is told the kind of each error that is logged from now on; from any thread. Before any other thread is made.
void OnLoggedError(std::function<void(ErrorCode)> told);

}  // namespace rigcal
