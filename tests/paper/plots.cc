#include "tests/paper/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rigcal::paper {
namespace {

constexpr double kWidth_px = 920, kHeight_px = 280, kLeft_px = 70, kTop_px = 34, kFoot_px = 34, kBoxes_px = 130;
constexpr std::array<const char*, 5> kColours = {"#4269d0", "#efb118", "#3ca951", "#ff725c", "#a463f2"};

std::string Line(double x0, double y0, double x1, double y1, const std::string& style) {
  return fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' {}/>\n", x0, y0, x1, y1, style);
}

std::string Text(double x, double y, const std::string& anchor, const std::string& text) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", x, y, anchor, text);
}

std::string Open(const std::string& title, const std::string& unit) {
  return fmt::format("<svg viewBox='0 0 {0} {1}' width='{0}' role='img' aria-label='{2}'>\n", kWidth_px, kHeight_px,
                     title) +
         Text(kLeft_px, 18, "start", fmt::format("<tspan font-weight='600'>{}</tspan> [{}]", title, unit));
}

// A round value at or above `value`.
double RoundUp(double value) {
  if (!(value > 0)) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * decade >= value) return step * decade;
  return 10 * decade;
}

double Quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  const double at = part * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

struct Linear {
  double top = 1.0;
  double operator()(double value) const {
    return kHeight_px - kFoot_px - value / top * (kHeight_px - kFoot_px - kTop_px);
  }
};

std::string Box(const Series& series, double x, const Linear& y) {
  const std::string stroke = fmt::format("stroke='{}' stroke-width='1.5'", series.colour);
  const double q1 = Quantile(series.values, 0.25), q3 = Quantile(series.values, 0.75);
  return Line(x, y(Quantile(series.values, 0)), x, y(q1), stroke) +
         Line(x, y(q3), x, y(Quantile(series.values, 1)), stroke) +
         fmt::format("<rect x='{:.1f}' y='{:.1f}' width='30' height='{:.1f}' fill='none' {}/>\n", x - 15, y(q3),
                     y(q1) - y(q3), stroke) +
         Line(x - 15, y(Quantile(series.values, 0.5)), x + 15, y(Quantile(series.values, 0.5)), stroke);
}

std::string Dots(const Series& series, const Linear& y) {
  std::string svg;
  const double width = kWidth_px - kLeft_px - kBoxes_px;
  for (std::size_t k = 0; k < series.values.size(); ++k)
    svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2' fill='{}' fill-opacity='0.75'/>\n",
                       kLeft_px + width * (static_cast<double>(k) + 0.5) / static_cast<double>(series.values.size()),
                       y(series.values[k]), series.colour);
  return svg + Line(kLeft_px, y(series.expected), kLeft_px + width, y(series.expected),
                    fmt::format("stroke='{}' stroke-width='2' stroke-dasharray='7 4'", series.colour));
}

std::string Grid(const Linear& y) {
  std::string svg;
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double at = y(part * y.top);
    svg += Line(kLeft_px, at, kWidth_px, at, "class='grid'") +
           Text(kLeft_px - 6, at + 4, "end", fmt::format("{:.3g}", part * y.top));
  }
  return svg;
}

}  // namespace

std::string PlotSeries(const std::string& title, const std::string& unit, const std::vector<Series>& series) {
  double largest = 0;
  std::size_t sets = 0;
  for (const Series& one : series) {
    for (const double value : one.values) largest = std::max(largest, value);
    sets = one.values.size();
  }
  const Linear y{RoundUp(largest)};
  std::string svg = Open(title, unit) + Grid(y);
  double x = kWidth_px - kBoxes_px + 40, name_x = kLeft_px + 330;
  for (const Series& one : series) {
    svg += Dots(one, y) + Box(one, x, y);
    svg += fmt::format("<circle cx='{:.1f}' cy='14' r='5' fill='{}'/>", name_x, one.colour) +
           Text(name_x + 10, 18, "start", one.name);
    x += 50, name_x += 200;
  }
  svg += Text(kLeft_px, kHeight_px - 12, "start", "data set 1") +
         Text(kWidth_px - kBoxes_px, kHeight_px - 12, "end", fmt::format("data set {}", sets));
  return svg + "</svg>\n";
}

std::string PlotBars(const std::string& title, const std::string& unit, const std::vector<std::string>& groups,
                     const std::vector<Bars>& bars) {
  double largest = 1e-12, smallest = 1e12;
  for (const Bars& one : bars)
    for (const double value : one.values)
      if (value > 0) largest = std::max(largest, value), smallest = std::min(smallest, value);
  const double top = std::ceil(std::log10(largest)), bottom = std::floor(std::log10(smallest));
  const double decades = std::max(1.0, top - bottom);
  const auto y = [&](double value) {
    return kHeight_px - kFoot_px - (std::log10(value) - bottom) / decades * (kHeight_px - kFoot_px - kTop_px);
  };
  std::string svg = Open(title, unit);
  for (double decade = bottom; decade <= top; ++decade)
    svg += Line(kLeft_px, y(std::pow(10, decade)), kWidth_px, y(std::pow(10, decade)), "class='grid'") +
           Text(kLeft_px - 6, y(std::pow(10, decade)) + 4, "end", fmt::format("{:g}", std::pow(10, decade)));
  const double group_px = (kWidth_px - kLeft_px) / static_cast<double>(std::max<std::size_t>(1, groups.size()));
  const double bar_px = 0.8 * group_px / static_cast<double>(std::max<std::size_t>(1, bars.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double x = kLeft_px + group_px * (static_cast<double>(g) + 0.1);
    for (std::size_t k = 0; k < bars.size(); ++k)
      if (const double value = bars[k].values[g]; value > 0)
        svg += fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='{}'/>\n",
                           x + bar_px * static_cast<double>(k), y(value), 0.92 * bar_px,
                           kHeight_px - kFoot_px - y(value), kColours[k % kColours.size()]);
    svg += Text(x + 0.4 * group_px, kHeight_px - 12, "middle", groups[g]);
  }
  for (std::size_t k = 0; k < bars.size(); ++k)
    svg += fmt::format("<rect x='{0:.1f}' y='9' width='10' height='10' fill='{1}'/>",
                       kLeft_px + 330 + 150.0 * static_cast<double>(k), kColours[k % kColours.size()]) +
           Text(kLeft_px + 345 + 150.0 * static_cast<double>(k), 18, "start", bars[k].name);
  return svg + "</svg>\n";
}

}  // namespace rigcal::paper
