#include "client/certificate/paper.h"

#include <algorithm>
#include <cmath>

#include "client/certificate/table_lines.h"
#include "client/text/table.h"

namespace rigcal::client {
namespace {

constexpr double kWidth_m = 0.210, kHeight_m = 0.297, kMargin_m = 0.014, kFoot_m = 0.008;
constexpr double kBottom_m = kHeight_m - kMargin_m - kFoot_m;
constexpr double kMonospaceRatio = 0.61;  // of a character's advance to the height of the type
constexpr std::size_t kTextColumns = 122;

struct Type {
  double height_m, step_m;  // step: from the line before
  bool is_monospace = false;
};
constexpr Type kTitle = {0.0056, 0.0070}, kHeading = {0.0034, 0.0068}, kText = {0.0026, 0.0038};
constexpr double kTableType_m = 0.0025, kTableStepRatio = 1.45;

// Pages as they fill from the top.
class Pages {
 public:
  Pages() { Turn(); }
  void Add(const std::string& text, const Type& type) {
    if (y_m_ + type.step_m > kBottom_m) Turn();
    y_m_ += type.step_m;
    sheets_.back().labels.push_back({kMargin_m, y_m_, type.height_m, text, type.is_monospace});
  }
  [[nodiscard]] bool HasRoom(double height_m) const { return y_m_ + height_m <= kBottom_m; }
  void Turn() {
    print::Sheet& sheet = sheets_.emplace_back();
    sheet.paper = "A4", sheet.width_m = kWidth_m, sheet.height_m = kHeight_m;
    y_m_ = kMargin_m;
  }
  // With `name` at the foot of each.
  [[nodiscard]] std::vector<print::Sheet> Numbered(const std::string& name) && {
    for (std::size_t i = 0; i < sheets_.size(); ++i)
      sheets_[i].labels.push_back({kMargin_m, kHeight_m - kMargin_m, kText.height_m,
                                   name + ", page " + std::to_string(i + 1) + " of " + std::to_string(sheets_.size()),
                                   false});
    return std::move(sheets_);
  }

 private:
  std::vector<print::Sheet> sheets_;
  double y_m_ = 0.0;
};

// Further lines are indented.
void AddText(const std::string& text, Pages& pages) {
  const std::vector<std::string> lines = Wrapped(text, kTextColumns);
  for (std::size_t i = 0; i < lines.size(); ++i) pages.Add((i > 0 ? "   " : "") + lines[i], kText);
}

Type TypeOf(const TableLines& table) {
  std::size_t widest = 1;
  for (const std::string& line : table.title) widest = std::max(widest, WidthOf(line));
  for (const auto& row : table.rows)
    for (const std::string& line : row) widest = std::max(widest, WidthOf(line));
  const double height_m =
      std::min(kTableType_m, (kWidth_m - 2 * kMargin_m) / (kMonospaceRatio * static_cast<double>(widest)));
  return {height_m, kTableStepRatio * height_m, true};
}

double HeightOf(const std::vector<std::string>& lines, const Type& type) {
  return static_cast<double>(lines.size()) * type.step_m;
}

// The first row stays with the titles, and these with the heading above them.
void AddTable(const std::string& heading, const CertificateTable& table, Pages& pages) {
  const TableLines lines = LinesOf(table);
  const Type type = TypeOf(lines);
  const auto add = [&](const std::vector<std::string>& row) {
    for (const std::string& line : row) pages.Add(line, type);
  };
  add(lines.title);
  for (const auto& row : lines.rows) {
    if (!pages.HasRoom(HeightOf(row, type))) {
      pages.Turn();
      pages.Add(heading + " (continued)", kHeading);
      add(lines.title);
    }
    add(row);
  }
}

// What a heading must not be parted from: two lines of text, or the titles and a row.
double HeightOfBegin(const CertificatePart& part) {
  return kHeading.step_m + kText.step_m * static_cast<double>(std::min<std::size_t>(part.text.size(), 2)) +
         (part.table.columns.empty() ? 0.0 : 4 * kText.step_m);
}

void AddPart(const CertificatePart& part, Pages& pages) {
  if (!pages.HasRoom(HeightOfBegin(part))) pages.Turn();
  pages.Add(part.heading, kHeading);
  for (const std::string& text : part.text) AddText(text, pages);
  if (!part.table.columns.empty()) AddTable(part.heading, part.table, pages);
  for (const std::string& note : part.notes) AddText(note, pages);
}

std::string NameOf(const Certificate& certificate) {
  return certificate.robot.str() + (certificate.rig_model.empty() ? "" : ", rig model " + certificate.rig_model) +
         ", revision " + std::to_string(certificate.revision);
}

void AddHead(const Certificate& certificate, Pages& pages) {
  pages.Add(certificate.title, kTitle);
  pages.Add(Plain(NameOf(certificate)), kHeading);
  AddText(certificate.measured + " " + certificate.state, pages);
  const Verdict& verdict = certificate.verdict;
  AddText(certificate.rule, pages);
  AddText("Verdict " + rigcal::NameOf(verdict.level) + ": " + verdict.why, pages);
  if (!verdict.what_to_do.empty()) AddText("What to do: " + verdict.what_to_do, pages);
}

void AddSignature(Pages& pages) {
  constexpr Type kLine = {kText.height_m, 0.0130};
  pages.Add("Place and date ______________________  Name ______________________  Signature ______________________",
            kLine);
}

}  // namespace

std::vector<print::Sheet> OnPaper(const Certificate& certificate) {
  Pages pages;
  AddHead(certificate, pages);
  for (const CertificatePart& part : certificate.parts) AddPart(part, pages);
  if (certificate.to_sign) AddSignature(pages);
  return std::move(pages).Numbered(Plain(certificate.title + ", " + NameOf(certificate)));
}

}  // namespace rigcal::client
