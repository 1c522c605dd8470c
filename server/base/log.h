// One line per event on standard error: time, level, text. Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

enum class LogLevel { kDebug, kInfo, kWarn, kError };
// Less severe events are not written; until the first call, kInfo and above are.
void SetLogLevel(LogLevel level);
// Control characters in `text` become spaces, so that one event stays one line.
void Log(LogLevel level, std::string_view text);
inline void LogInfo(std::string_view text) { Log(LogLevel::kInfo, text); }
inline void LogWarn(std::string_view text) { Log(LogLevel::kWarn, text); }
// What went wrong and its cure, as one sentence.
inline void LogError(const Error& error) { Log(LogLevel::kError, Sentence(error)); }

}  // namespace rigcal
