#include "client/certificate/paper.h"

#include <algorithm>

#include "client/text/table.h"

namespace rigcal::client {
namespace {

constexpr double kWidth_m = 0.210, kHeight_m = 0.297, kMargin_m = 0.016;
constexpr double kMonospaceRatio = 0.61;  // of a character's advance to the height of the type
constexpr double kTableType_m = 0.0026;

struct Type {
  double height_m, step_m;  // step: from the line before
  bool is_monospace;
};
Type TypeOf(LineStyle style) {
  switch (style) {
    case LineStyle::kTitle:
      return {0.0060, 0.0080, false};
    case LineStyle::kHeading:
      return {0.0036, 0.0080, false};
    case LineStyle::kTable:
      return {kTableType_m, 0.0040, true};
    case LineStyle::kText:
      break;
  }
  return {0.0028, 0.0042, false};
}

double TableType_m(const std::vector<CertificateLine>& lines) {
  std::size_t widest = 1;
  for (const CertificateLine& line : lines)
    if (line.style == LineStyle::kTable) widest = std::max(widest, WidthOf(line.text));
  return std::min(kTableType_m, (kWidth_m - 2 * kMargin_m) / (kMonospaceRatio * static_cast<double>(widest)));
}

}  // namespace

Result<print::Sheet> OnPaper(const std::vector<CertificateLine>& lines) {
  print::Sheet sheet;
  sheet.paper = "A4", sheet.width_m = kWidth_m, sheet.height_m = kHeight_m;
  const double table_m = TableType_m(lines);
  double y_m = kMargin_m;
  for (const CertificateLine& line : lines) {
    Type type = TypeOf(line.style);
    if (line.style == LineStyle::kTable) type.height_m = table_m;
    y_m += type.step_m;
    if (!line.text.empty()) sheet.labels.push_back({kMargin_m, y_m, type.height_m, line.text, type.is_monospace});
  }
  if (y_m > kHeight_m - kMargin_m)
    return Fail(ErrorCode::kInvalidInput, "the certificate has more lines than one page of A4 takes",
                "`rigcal report ROBOT --out FILE.zip` has all of it.");
  return sheet;
}

}  // namespace rigcal::client
