#include "server/report/edges/bars.h"

#include <algorithm>
#include <cmath>

#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kBarsMax = 120, kNamedMax = 24;
constexpr double kLeft_px = 44, kTop_px = 12, kHeight_px = 110, kFoot_px = 22;

double RmsOf(const CaptureResidual& capture) {
  return std::isfinite(capture.rms) && capture.used ? std::max(capture.rms, 0.0) : 0.0;
}

// All of them, or the worst ones in their own order.
std::vector<const CaptureResidual*> Drawn(const std::vector<CaptureResidual>& captures) {
  std::vector<const CaptureResidual*> drawn;
  for (const CaptureResidual& capture : captures) drawn.push_back(&capture);
  if (drawn.size() <= kBarsMax) return drawn;
  std::stable_sort(drawn.begin(), drawn.end(), [](const auto* a, const auto* b) { return RmsOf(*a) > RmsOf(*b); });
  drawn.resize(kBarsMax);
  std::sort(drawn.begin(), drawn.end());
  return drawn;
}

// 1, 2 or 5 times a power of ten, at or above `value`.
double NiceTop(double value) {
  if (!(value > 0.0)) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= value) return step * decade;
  return 10.0 * decade;
}

void FillGrid(Dictionary& svg, double top, double width) {
  for (const double part : {0.0, 0.5, 1.0}) {
    Dictionary* line = svg.AddSectionDictionary("GRID");
    line->SetValue("X0", Fixed(kLeft_px - 6, 0));
    line->SetValue("X1", Fixed(kLeft_px, 0));
    line->SetValue("X2", Fixed(width - 6, 0));
    line->SetValue("Y", Fixed(kTop_px + kHeight_px * (1 - part), 1));
    line->SetValue("TEXT", part == 0.0 ? "0" : Significant(top * part, 2));
  }
}

struct Slot {
  double left = 0.0, width = 0.0;
};

double HeightOf(const CaptureResidual& capture, double top) {
  return capture.used ? std::max(1.0, RmsOf(capture) / top * kHeight_px) : kHeight_px * 0.5;
}

// An ordinary bar among many is a piece of one path: a page has thousands of them.
std::string PieceOf(const CaptureResidual& capture, const Slot& slot, double top) {
  const std::string width = Fixed(slot.width * 0.7, 0), height = Fixed(HeightOf(capture, top), 1);
  return "M" + Fixed(slot.left + slot.width * 0.15, 0) + " " + Fixed(kTop_px + kHeight_px, 0) + "v-" + height + "h" +
         width + "v" + height + "z";
}

void FillName(Dictionary& svg, const CaptureResidual& capture, const Slot& slot) {
  const std::string& name = capture.capture.str();
  Dictionary* label = svg.AddSectionDictionary("NAMED");
  label->SetValue("X", Fixed(slot.left + slot.width / 2, 0));
  label->SetValue("Y", Fixed(kTop_px + kHeight_px + 15, 0));
  label->SetValue("TEXT", name.size() > 7 ? "\xE2\x80\xA6" + name.substr(name.size() - 6) : name);
}

// The worst, what was not used, and all where they are few: with words.
void FillBar(Dictionary& svg, const CaptureResidual& capture, const Slot& slot, double top, bool is_worst,
             const std::string& unit) {
  const double height = HeightOf(capture, top);
  Dictionary* bar = svg.AddSectionDictionary("BAR");
  bar->SetValue("STATE", !capture.used ? "unused" : is_worst ? "worst" : "used");
  bar->SetValue("X", Fixed(slot.left + slot.width * 0.15, 1));
  bar->SetValue("Y", Fixed(kTop_px + kHeight_px - height, 1));
  bar->SetValue("W", Fixed(slot.width * 0.7, 1));
  bar->SetValue("H", Fixed(height, 1));
  bar->SetValue("TITLE", capture.capture.str() + ": " +
                             (capture.used ? Significant(capture.rms, 3) + " " + unit : "not used. " + capture.note));
}

void FillAll(Dictionary& svg, const std::vector<const CaptureResidual*>& drawn, double step, double worst,
             const std::string& unit) {
  const double top = NiceTop(worst);
  std::string ordinary;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const Slot slot{kLeft_px + step * static_cast<double>(i), step};
    const bool named = drawn.size() <= kNamedMax, is_worst = !(RmsOf(*drawn[i]) < worst);
    if (drawn[i]->used && !is_worst && !named)
      ordinary += PieceOf(*drawn[i], slot, top);
    else
      FillBar(svg, *drawn[i], slot, top, is_worst, unit);
    if (named) FillName(svg, *drawn[i], slot);
  }
  if (!ordinary.empty()) ShowValue(svg, "USED", "D", ordinary);
}

}  // namespace

std::string FillBars(Dictionary& parent, const std::vector<CaptureResidual>& captures, const std::string& unit) {
  const auto drawn = Drawn(captures);
  const double step = drawn.size() <= kNamedMax ? 52.0 : std::max(7.0, 1000.0 / static_cast<double>(drawn.size()));
  const double width = kLeft_px + step * static_cast<double>(drawn.size()) + 8;
  double worst = 0.0;
  for (const CaptureResidual* capture : drawn) worst = std::max(worst, RmsOf(*capture));
  Dictionary* svg = parent.AddIncludeDictionary("BARS");
  svg->SetFilename("bars.tpl");
  svg->SetValue("WIDTH", Fixed(width, 0));
  svg->SetValue("HEIGHT", Fixed(kTop_px + kHeight_px + kFoot_px, 0));
  svg->SetValue("LABEL", "Residual of each capture, largest " + Significant(worst, 3) + " " + unit);
  FillGrid(*svg, NiceTop(worst), width);
  FillAll(*svg, drawn, step, worst, unit);
  if (drawn.size() == captures.size()) return "";
  return "The " + std::to_string(drawn.size()) + " worst of " + std::to_string(captures.size()) +
         " captures are drawn.";
}

}  // namespace rigcal::report
