// One line per event on standard error: time, level, text. Thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

enum class LogLevel { kDebug, kInfo, kWarn, kError };
void SetLogLevel(LogLevel level);
void Log(LogLevel level, std::string_view text);
inline void LogInfo(std::string_view text) { Log(LogLevel::kInfo, text); }
inline void LogWarn(std::string_view text) { Log(LogLevel::kWarn, text); }
inline void LogError(const Error& error) { Log(LogLevel::kError, Sentence(error)); }

}  // namespace rigcal
