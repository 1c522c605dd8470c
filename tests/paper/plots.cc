#include "tests/paper/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rigcal::paper {
namespace {

constexpr double kWidth_px = 920, kHeight_px = 280, kLeft_px = 70, kTop_px = 34, kFoot_px = 40;
constexpr const char* kGrid = "stroke='currentColor' stroke-opacity='0.2'";

std::string Line(double x0, double y0, double x1, double y1, const std::string& style) {
  return fmt::format("<line x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}' {}/>\n", x0, y0, x1, y1, style);
}

std::string Text(double x, double y, const std::string& anchor, const std::string& text) {
  return fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='{}'>{}</text>\n", x, y, anchor, text);
}

std::string Open(const std::string& title, const std::string& unit) {
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' role='img' aria-label='{2}' "
             "font-family='system-ui, sans-serif' font-size='12' fill='currentColor'>\n",
             kWidth_px, kHeight_px, title) +
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

std::string Dot(double x, double y, const std::string& colour) {
  return fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2' fill='{}' fill-opacity='0.75'/>\n", x, y, colour);
}

std::string Dashes(double x0, double x1, double y, const std::string& colour) {
  return Line(x0, y, x1, y, fmt::format("stroke='{}' stroke-width='2' stroke-dasharray='7 4'", colour));
}

std::string Dots(const Series& series, double width, const Linear& y) {
  std::string svg;
  for (std::size_t k = 0; k < series.values.size(); ++k)
    svg += Dot(kLeft_px + width * (static_cast<double>(k) + 0.5) / static_cast<double>(series.values.size()),
               y(series.values[k]), series.colour);
  return svg + Dashes(kLeft_px, kLeft_px + width, y(series.expected), series.colour);
}

std::string Grid(const Linear& y) {
  std::string svg;
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double at = y(part * y.top);
    svg += Line(kLeft_px, at, kWidth_px, at, kGrid) +
           Text(kLeft_px - 6, at + 4, "end", fmt::format("{:.3g}", part * y.top));
  }
  return svg;
}

// Names in their colours, one after another at the top.
class Legend {
 public:
  void Add(const std::string& name, const std::string& colour) {
    svg_ += fmt::format("<circle cx='{:.1f}' cy='14' r='5' fill='{}'/>", x_, colour) + Text(x_ + 10, 18, "start", name);
    x_ += 40 + 6.5 * static_cast<double>(name.size());
  }
  [[nodiscard]] const std::string& svg() const { return svg_; }

 private:
  double x_ = kLeft_px + 290;
  std::string svg_;
};

struct Logarithmic {
  double bottom = 0, top = 1;  // powers of ten
  double operator()(double value) const {
    const double part = (std::log10(std::max(value, 1e-300)) - bottom) / (top - bottom);
    return kHeight_px - kFoot_px - std::clamp(part, 0.0, 1.0) * (kHeight_px - kFoot_px - kTop_px);
  }
};

// Smallest and largest positive value; a few strays near zero do not count.
std::pair<double, double> RangeOf(const std::vector<Strips>& strips) {
  double smallest = 1e300, largest = 1e-300;
  const auto add = [&](double value) {
    if (value > 0) smallest = std::min(smallest, value), largest = std::max(largest, value);
  };
  for (const Strips& one : strips) {
    for (const double value : one.expected) add(value);
    for (const auto& values : one.values)
      for (const double value : values) add(value);
  }
  return {std::min(std::max(smallest, largest * 1e-4), largest), largest};
}

Logarithmic LogarithmicOf(double smallest, double largest) {
  Logarithmic y{std::floor(std::log10(smallest) * 2) / 2, std::ceil(std::log10(largest) * 2) / 2};
  if (!(y.top > y.bottom)) y.top = y.bottom + 1;
  return y;
}

std::string Grid(const Logarithmic& y) {
  std::string svg;
  for (double decade = std::floor(y.bottom); decade <= y.top; ++decade)
    for (const double step : {1.0, 2.0, 5.0}) {
      const double value = step * std::pow(10.0, decade);
      if (std::log10(value) < y.bottom - 1e-9 || std::log10(value) > y.top + 1e-9) continue;
      svg += Line(kLeft_px, y(value), kWidth_px, y(value), kGrid) +
             Text(kLeft_px - 6, y(value) + 4, "end", fmt::format("{:g}", value));
    }
  return svg;
}

// One group of one series: its dots spread over `width` about x, its dash across.
template <typename Axis>
std::string Strip(const std::vector<double>& values, double expected, double x, double width, const std::string& colour,
                  const Axis& y) {
  std::string svg;
  for (std::size_t k = 0; k < values.size(); ++k)
    svg += Dot(x + width * ((static_cast<double>(k) + 0.5) / static_cast<double>(values.size()) - 0.5), y(values[k]),
               colour);
  return expected > 0 ? svg + Dashes(x - 0.6 * width, x + 0.6 * width, y(expected), colour) : svg;
}

template <typename Axis>
std::string StripsOn(const Axis& y, const std::vector<GroupName>& groups, const std::vector<Strips>& strips) {
  const double group_px = (kWidth_px - kLeft_px) / static_cast<double>(std::max<std::size_t>(1, groups.size()));
  const double strip_px = 0.8 * group_px / static_cast<double>(std::max<std::size_t>(1, strips.size()));
  std::string svg = Grid(y);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double left = kLeft_px + group_px * (static_cast<double>(g) + 0.1);
    for (std::size_t k = 0; k < strips.size(); ++k)
      svg += Strip(strips[k].values[g], strips[k].expected[g], left + strip_px * (static_cast<double>(k) + 0.5),
                   0.7 * strip_px, strips[k].colour, y);
    svg += Text(left + 0.4 * group_px, kHeight_px - 20, "middle", groups[g].first) +
           Text(left + 0.4 * group_px, kHeight_px - 5, "middle", groups[g].second);
  }
  Legend legend;
  for (const Strips& one : strips) legend.Add(one.name, one.colour);
  return svg + legend.svg();
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
  const double boxes_px = 30 + 50 * static_cast<double>(series.size());
  const double width = kWidth_px - kLeft_px - boxes_px;
  std::string svg = Open(title, unit) + Grid(y);
  Legend legend;
  double x = kWidth_px - boxes_px + 40;
  for (const Series& one : series) {
    svg += Dots(one, width, y) + Box(one, x, y);
    legend.Add(one.name, one.colour);
    x += 50;
  }
  svg += legend.svg() + Text(kLeft_px, kHeight_px - 12, "start", "data set 1") +
         Text(kWidth_px - boxes_px, kHeight_px - 12, "end", fmt::format("data set {}", sets));
  return svg + "</svg>\n";
}

std::string PlotStrips(const std::string& title, const std::string& unit, const std::vector<GroupName>& groups,
                       const std::vector<Strips>& strips, Scale scale) {
  const auto [smallest, largest] = RangeOf(strips);
  return Open(title, unit) +
         (scale == Scale::kLinear ? StripsOn(Linear{RoundUp(largest)}, groups, strips)
                                  : StripsOn(LogarithmicOf(smallest, largest), groups, strips)) +
         "</svg>\n";
}

}  // namespace rigcal::paper
