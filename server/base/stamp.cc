#include "server/base/stamp.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <limits>
#include <optional>

#include "server/base/text.h"

namespace rigcal {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kSecondsPerMinute = 60, kSecondsPerHour = 3600, kSecondsPerDay = 86400;
constexpr std::int64_t kSecondsPerYear = 31'556'952;  // of the Gregorian calendar, on average
constexpr int kYearMin = 1970, kYearMax = 2200;

// A cursor over text: each function consumes what it recognises, or reports that it is not there.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}
  [[nodiscard]] bool AtEnd() const { return rest_.empty(); }
  bool Skip(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  // Exactly `digits` digits with a value in [low, high].
  std::optional<int> Number(std::size_t digits, int low, int high) {
    const std::string_view field = Digits();
    if (field.size() != digits) return std::nullopt;
    int value = 0;
    std::from_chars(field.data(), field.data() + field.size(), value);
    if (value < low || value > high) return std::nullopt;
    return value;
  }
  std::string_view Digits() {
    const auto end = std::find_if(rest_.begin(), rest_.end(), [](char c) { return c < '0' || c > '9'; });
    const std::string_view field = rest_.substr(0, static_cast<std::size_t>(end - rest_.begin()));
    rest_.remove_prefix(field.size());
    return field;
  }

 private:
  std::string_view rest_;
};

// A number of so many digits.
struct Field {
  std::size_t digits = 0;
  int min = 0, max = 0;
};

// One after the other with `between` between them.
template <std::size_t N>
std::optional<std::array<std::int64_t, N>> ScanFields(Scanner& in, const std::array<Field, N>& fields, char between) {
  std::array<std::int64_t, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    if (i > 0 && !in.Skip(between)) return std::nullopt;
    const auto value = in.Number(fields[i].digits, fields[i].min, fields[i].max);
    if (!value) return std::nullopt;
    values[i] = *value;
  }
  return values;
}

constexpr Field kHours{2, 0, 23}, kMinutes{2, 0, 59}, kSeconds{2, 0, 59};

std::optional<std::int64_t> ScanDateSeconds(Scanner& in) {
  const auto fields = ScanFields(in, std::array{Field{4, kYearMin, kYearMax}, Field{2, 1, 12}, Field{2, 1, 31}}, '-');
  if (!fields) return std::nullopt;
  const auto [year, month, day] = *fields;
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count() * kSecondsPerDay;
}

std::optional<std::int64_t> ScanTimeSeconds(Scanner& in) {
  const auto fields = ScanFields(in, std::array{kHours, kMinutes, kSeconds}, ':');
  if (!fields) return std::nullopt;
  return (*fields)[0] * kSecondsPerHour + (*fields)[1] * kSecondsPerMinute + (*fields)[2];
}

std::optional<std::int64_t> ScanFractionNs(Scanner& in) {
  if (!in.Skip('.')) return 0;
  std::string field(in.Digits());
  if (field.empty() || field.size() > 9) return std::nullopt;
  field.resize(9, '0');
  std::int64_t ns = 0;
  std::from_chars(field.data(), field.data() + field.size(), ns);
  return ns;
}

// Seconds east of Greenwich.
std::optional<std::int64_t> ScanZoneSeconds(Scanner& in) {
  if (in.AtEnd() || in.Skip('Z')) return 0;
  const bool west = in.Skip('-');
  if (!west && !in.Skip('+')) return std::nullopt;
  const auto fields = ScanFields(in, std::array{kHours, kMinutes}, ':');
  if (!fields) return std::nullopt;
  return (west ? -1 : 1) * ((*fields)[0] * kSecondsPerHour + (*fields)[1] * kSecondsPerMinute);
}

std::optional<Stamp> ScanStamp(Scanner in) {
  const auto date_s = ScanDateSeconds(in);
  if (!date_s) return std::nullopt;
  if (in.AtEnd()) return Stamp{*date_s * kNsPerSecond};
  if (!in.Skip('T')) return std::nullopt;
  const auto time_s = ScanTimeSeconds(in);
  if (!time_s) return std::nullopt;
  const auto fraction_ns = ScanFractionNs(in);
  if (!fraction_ns) return std::nullopt;
  const auto zone_s = ScanZoneSeconds(in);
  if (!zone_s || !in.AtEnd()) return std::nullopt;
  const Stamp stamp{(*date_s + *time_s - *zone_s) * kNsPerSecond + *fraction_ns};
  return stamp.ns < 0 ? std::nullopt : std::optional(stamp);
}

std::string FractionText(std::int64_t fraction_ns) {
  if (fraction_ns == 0) return "";
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), ".%09lld", static_cast<long long>(fraction_ns));
  std::string trimmed(text.data());
  trimmed.erase(trimmed.find_last_not_of('0') + 1);
  return trimmed;
}

class RealClock : public Clock {
 public:
  [[nodiscard]] Stamp Now() const override {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return Stamp{std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
  }
};

}  // namespace

std::string ToIso(Stamp stamp) {
  const std::chrono::sys_time<std::chrono::nanoseconds> time{std::chrono::nanoseconds(stamp.ns)};
  const auto days = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(days);
  const std::chrono::hh_mm_ss clock(time - days);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  return text.data() + FractionText(clock.subseconds().count()) + "Z";
}

Result<Stamp> ParseIso(std::string_view text) {
  if (const auto stamp = ScanStamp(Scanner(text))) return *stamp;
  return Fail(ErrorCode::kInvalidInput, "time " + Quoted(text) + " is not a date between 1970 and 2200",
              "Write it like 2026-01-31 or 2026-01-31T12:00:00Z or 2026-01-31T13:00:00+01:00.");
}

Result<std::int64_t> ParseDuration(std::string_view text) {
  const auto failure = [&] {
    return Fail(ErrorCode::kInvalidInput, "duration " + Quoted(text) + " is not understood",
                "Write a whole number and one of d, h, m, s: 90d, 12h, 30m, 45s; at most 36500d.");
  };
  if (text.empty()) return failure();
  constexpr std::array<std::pair<char, std::int64_t>, 4> kUnits = {
      {{'d', kSecondsPerDay}, {'h', kSecondsPerHour}, {'m', kSecondsPerMinute}, {'s', 1}}};
  const auto unit =
      std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& entry) { return entry.first == text.back(); });
  const char* const end = text.data() + text.size() - 1;
  std::int64_t count = 0;
  const auto [stop, error] = std::from_chars(text.data(), end, count);
  if (unit == kUnits.end() || text.size() < 2 || error != std::errc() || stop != end || count < 0) return failure();
  if (count > 36500 * kSecondsPerDay / unit->second) return failure();
  return count * unit->second * kNsPerSecond;
}

// One unit, of which whole ones count; years have a decimal. A person needs no more of it.
std::string AgeText(std::int64_t age_ns) {
  const std::int64_t age_s = std::max<std::int64_t>(age_ns, 0) / kNsPerSecond;
  const auto in = [&](std::int64_t unit_s, const char* unit) { return std::to_string(age_s / unit_s) + " " + unit; };
  if (age_s < kSecondsPerMinute) return in(1, "s");
  if (age_s < kSecondsPerHour) return in(kSecondsPerMinute, "min");
  if (age_s < 2 * kSecondsPerDay) return in(kSecondsPerHour, "h");
  if (age_s < 100 * kSecondsPerDay) return in(kSecondsPerDay, "days");
  if (age_s < 2 * kSecondsPerYear) return in(kSecondsPerYear / 12, "months");
  const std::int64_t tenths = (10 * age_s + kSecondsPerYear / 2) / kSecondsPerYear;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " years";
}

const Clock& SystemClock() {
  static const RealClock clock;
  return clock;
}

}  // namespace rigcal
