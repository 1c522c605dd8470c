#include "client/print/svg.h"

#include <array>
#include <charconv>
#include <cmath>

namespace rigcal::print {
namespace {

std::string Millimetres(double length_m) {
  std::array<char, 40> text{};
  const double rounded = std::round(length_m * 1e7) / 1e4;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), rounded == 0 ? 0.0 : rounded, std::chars_format::fixed).ptr;
  return {text.data(), end};
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else
      escaped += c;
  }
  return escaped;
}

std::string PathOf(const std::vector<Rectangle>& black) {
  std::string path;
  for (const Rectangle& one : black)
    path += "M" + Millimetres(one.x_m) + " " + Millimetres(one.y_m) + "H" + Millimetres(one.x_m + one.width_m) + "V" +
            Millimetres(one.y_m + one.height_m) + "H" + Millimetres(one.x_m) + "Z\n";
  return path;
}

}  // namespace

std::string WriteSvg(const Sheet& sheet, const std::string& title) {
  const std::string width = Millimetres(sheet.width_m), height = Millimetres(sheet.height_m);
  std::string svg = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
                    width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height + "\">\n<title>" +
                    Escaped(title) + "</title>\n<rect width=\"" + width + "\" height=\"" + height +
                    "\" fill=\"#fff\"/>\n<path fill=\"#000\" d=\"" + PathOf(sheet.black) + "\"/>\n";
  for (const Disc& one : sheet.discs)
    svg += "<circle cx=\"" + Millimetres(one.x_m) + "\" cy=\"" + Millimetres(one.y_m) + "\" r=\"" +
           Millimetres(one.diameter_m / 2) + "\"/>\n";
  for (const Label& label : sheet.labels)
    svg += "<text x=\"" + Millimetres(label.x_m) + "\" y=\"" + Millimetres(label.y_m) + "\" font-size=\"" +
           Millimetres(label.height_m) + "\" font-family=\"" + (label.is_monospace ? "monospace" : "sans-serif") +
           "\" xml:space=\"preserve\">" + Escaped(label.text) + "</text>\n";
  return svg + "</svg>\n";
}

}  // namespace rigcal::print
