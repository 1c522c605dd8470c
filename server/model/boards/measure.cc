#include "server/model/boards/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "server/base/text.h"

namespace rigcal {
namespace {

constexpr std::int64_t kDay_ns = 86'400'000'000'000, kNextCheckMax_ns = 20 * 366 * kDay_ns;
constexpr double kBoardLengthMin_m = 0.01, kBoardLengthMax_m = 10.0, kRulerTick_m = 0.1;
constexpr double kPrintErrorMax_ratio = 0.05;
constexpr double kReadingSigmaMax_m = 0.005, kFlatnessMax_m = 0.05;
constexpr int kBoardCountMax = 100;
constexpr double kBoardSquareMin_m = 0.001, kBoardSquareMax_m = 1.0;
constexpr std::size_t kSerialBytesMax = 256;

Status RefuseBoard(const BoardMeasure& measure, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, "board " + Quoted(measure.serial) + ": " + what, cure);
}

Status CheckSerial(const BoardMeasure& measure) {
  const std::string& serial = measure.serial;
  if (!serial.empty() && serial.size() <= kSerialBytesMax && IsPrintableUtf8(serial) && serial.front() != ' ' &&
      serial.back() != ' ' && serial.front() != '-')
    return {};
  return Fail(ErrorCode::kInvalidInput, Quoted(serial) + " is no serial of a board",
              "Use what is written on it: one line of at most 256 bytes that begins with neither a blank nor '-'.");
}

Status CheckPattern(const BoardMeasure& measure) {
  const BoardPattern& pattern = measure.pattern;
  const TypedCounts counts = TypedCountsOf(pattern);
  for (const int count : {pattern.cols, pattern.rows})
    if (count < 1 || count > kBoardCountMax)
      return RefuseBoard(
          measure,
          std::to_string(counts.cols) + " x " + std::to_string(counts.rows) + " " + counts.of + " are out of range",
          "Count them as session.yaml has them, 1 to 100 each way.");
  if (pattern.square_m >= kBoardSquareMin_m && pattern.square_m <= kBoardSquareMax_m) return {};
  return RefuseBoard(measure, "a square of " + BoardMm(pattern.square_m) + " is out of range",
                     "Give its side as it was to be printed, in millimetres, 1 to 1000.");
}

// Where it would be right in another unit, that is said.
std::string UnitMeant(double length_m, double measured_m) {
  const auto is_near = [&](double scale) {
    return std::abs(measured_m * scale / length_m - 1) <= kPrintErrorMax_ratio;
  };
  if (is_near(10)) return "Give millimetres; it looks like centimetres.";
  if (is_near(25.4)) return "Give millimetres; it looks like inches.";
  if (is_near(1000)) return "Give millimetres; it looks like metres.";
  return "Were millimetres meant? Measure again from 0 to the last tick, or say with --nominal-mm what length was "
         "measured; a board that is so far off is to be printed anew, at 100 %.";
}

Status CheckLength(const BoardMeasure& measure, const char* axis, double length_m, double measured_m) {
  if (!(length_m >= kBoardLengthMin_m && length_m <= kBoardLengthMax_m))
    return RefuseBoard(measure,
                       std::string("the nominal length along ") + axis + ", " + BoardMm(length_m) + ", is out of range",
                       "Give millimetres, 10 to 10000.");
  if (!(measured_m > 0 && std::isfinite(measured_m)))
    return RefuseBoard(measure, std::string("the length measured along ") + axis + " is not above 0",
                       "Give what the rule says, in millimetres.");
  if (std::abs(measured_m / length_m - 1) <= kPrintErrorMax_ratio) return {};
  return RefuseBoard(measure,
                     BoardMm(measured_m) + " measured along " + axis + " is more than 5 % from the " +
                         BoardMm(length_m) + " that were to be there",
                     UnitMeant(length_m, measured_m));
}

Status CheckDoubts(const BoardMeasure& measure) {
  if (!(measure.sigma_m > 0 && measure.sigma_m <= kReadingSigmaMax_m))
    return RefuseBoard(measure, "a standard deviation of " + BoardMm(measure.sigma_m) + " is out of range",
                       "Give that of one reading in millimetres, above 0 and up to 5; no rule is exact.");
  if (measure.flatness_m && !(*measure.flatness_m >= 0 && *measure.flatness_m <= kFlatnessMax_m))
    return RefuseBoard(measure, "a flatness of " + BoardMm(*measure.flatness_m) + " is out of range",
                       "Give the largest distance from a straight edge in millimetres, 0 to 50.");
  return {};
}

Status CheckDates(const BoardMeasure& measure) {
  if (!measure.next_check_at) return {};
  const std::int64_t in_ns = measure.next_check_at->ns - measure.word.at.ns;
  if (in_ns > 0 && in_ns <= kNextCheckMax_ns) return {};
  return RefuseBoard(measure,
                     "the next check, " + ToIso(*measure.next_check_at).substr(0, 10) +
                         (in_ns <= 0 ? ", is not in the future" : ", is more than 20 years away"),
                     "Give the day until which this measurement holds, such as 2027-05-31.");
}

}  // namespace

BoardPattern PatternOf(const Target& target) { return {target.kind, target.cols, target.rows, target.square_m}; }

bool IsSamePattern(const BoardPattern& a, const BoardPattern& b) {
  return a.kind == b.kind && a.cols == b.cols && a.rows == b.rows;
}

TypedCounts TypedCountsOf(const BoardPattern& pattern) {
  if (pattern.kind == TargetKind::kCharuco) return {pattern.cols + 1, pattern.rows + 1, "squares"};
  return {pattern.cols, pattern.rows, CountedOf(pattern.kind)};
}

BoardPattern PatternTyped(TargetKind kind, int cols, int rows, double square_m) {
  const int less = kind == TargetKind::kCharuco ? 1 : 0;
  return {kind, cols - less, rows - less, square_m};
}

std::string TextOf(const BoardPattern& pattern) {
  const TypedCounts counts = TypedCountsOf(pattern);
  return NameOf(pattern.kind) + " of " + std::to_string(counts.cols) + " x " + std::to_string(counts.rows) + " " +
         counts.of + ", " + BoardMm(pattern.square_m);
}

BoardSize SizeOf(const BoardMeasure& measure) {
  const double x = measure.pattern.square_m / measure.length_x_m, y = measure.pattern.square_m / measure.length_y_m;
  return {x * measure.measured_x_m, y * measure.measured_y_m, x * measure.sigma_m, y * measure.sigma_m};
}

double RulerLength_m(double measured_m) {
  if (!(measured_m > 0 && measured_m <= 2 * kBoardLengthMax_m)) return kRulerTick_m;
  return std::max(1.0, std::round(measured_m / kRulerTick_m)) * kRulerTick_m;
}

Status Validate(const BoardMeasure& measure) {
  RIGCAL_TRY(CheckSerial(measure));
  RIGCAL_TRY(CheckPattern(measure));
  RIGCAL_TRY(CheckLength(measure, "x", measure.length_x_m, measure.measured_x_m));
  RIGCAL_TRY(CheckLength(measure, "y", measure.length_y_m, measure.measured_y_m));
  RIGCAL_TRY(CheckDoubts(measure));
  return CheckDates(measure);
}

bool IsCheckDue(const BoardMeasure& measure, Stamp at) {
  return measure.next_check_at && at.ns - measure.next_check_at->ns >= kDay_ns;
}

bool IsSameSize(const BoardMeasure& a, const BoardMeasure& b) {
  const BoardSize one = SizeOf(a), other = SizeOf(b);
  return one.x_m == other.x_m && one.y_m == other.y_m;
}

bool IsSameCheck(const BoardMeasure& a, const BoardMeasure& b) {
  return a.serial == b.serial && a.pattern == b.pattern && a.length_x_m == b.length_x_m &&
         a.length_y_m == b.length_y_m && a.measured_x_m == b.measured_x_m && a.measured_y_m == b.measured_y_m &&
         a.sigma_m == b.sigma_m && a.sigma_is_assumed == b.sigma_is_assumed && a.flatness_m == b.flatness_m &&
         a.next_check_at == b.next_check_at && a.word.who == b.word.who && a.word.reason == b.word.reason &&
         a.word.at.ns / kDay_ns == b.word.at.ns / kDay_ns;
}

std::string BoardMm(double length_m) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f", std::clamp(length_m, -1e6, 1e6) * 1000);
  std::string number = std::isfinite(length_m) ? text.data() : "?";
  if (number.find('.') != std::string::npos) {
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.') number.pop_back();
  }
  return number + " mm";
}

std::string TextOf(const BoardSize& size) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.3f x %.3f mm (sigma %.2g)", size.x_m * 1000, size.y_m * 1000,
                std::max(size.sigma_x_m, size.sigma_y_m) * 1000);
  return text.data();
}

std::string TypedSerial(const std::string& serial) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-/";
  if (!serial.empty() && serial.find_first_not_of(kPlain) == std::string::npos) return serial;
  std::string quoted = "'";
  for (const char c : serial) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string MeasureCommand(const std::string& serial, const BoardPattern* pattern) {
  std::string command = "rigcal board measure " + TypedSerial(serial);
  if (pattern != nullptr) {
    const TypedCounts counts = TypedCountsOf(*pattern);
    const std::string size = BoardMm(pattern->square_m);
    command += " --type " + NameOf(pattern->kind) + " --cols " + std::to_string(counts.cols) + " --rows " +
               std::to_string(counts.rows) + " --square-mm " + size.substr(0, size.find(' '));
  }
  return command + " --ruler-x-mm A --ruler-y-mm B";
}

}  // namespace rigcal
