#include "server/report/text/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace rigcal::report {
namespace {

constexpr const char* kNotKnown = "not known";

std::string Format(double value, std::chars_format format, int precision) {
  std::array<char, 400> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, precision);
  return error == std::errc() ? std::string(buffer.data(), end) : std::string(kNotKnown);
}

// "4.10e-06" -> "4.10e-6".
std::string ShortExponent(std::string text) {
  const auto zero = text.find('e') + 2;
  if (zero < text.size() - 1 && text[zero] == '0') text.erase(zero, 1);
  return text;
}

bool IsZeroText(const std::string& text) { return text.find_first_not_of("-0.") == std::string::npos; }

// "0.00960000" -> "0.0096", "5.00000" -> "5".
std::string WithoutEndingZeros(std::string text) {
  if (text.find('.') == std::string::npos || text.find('e') != std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

struct Unit {
  std::string_view suffix, shown;
  double scale;
};
constexpr std::array<Unit, 8> kUnits = {{{"_px", " px", 1.0},
                                         {"_mm", " mm", 1.0},
                                         {"_m", " mm", kMmPerMetre},
                                         {"_rad", " deg", kDegPerRad},
                                         {"_deg", " deg", 1.0},
                                         {"_s", " s", 1.0},
                                         {"_ns", " ns", 1.0},
                                         {"_ratio", "", 1.0}}};

const Unit* UnitOf(std::string_view figure) {
  const auto ends = [figure](const Unit& unit) {
    return figure.size() > unit.suffix.size() && figure.substr(figure.size() - unit.suffix.size()) == unit.suffix;
  };
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), ends);
  return found == kUnits.end() ? nullptr : &*found;
}

}  // namespace

std::string Fixed(double value, int decimals) {
  if (!std::isfinite(value)) return kNotKnown;
  std::string text = Format(value, std::chars_format::fixed, decimals);
  if (text.front() == '-' && IsZeroText(text)) text.erase(0, 1);
  return text;
}

std::string Significant(double value, int digits) {
  if (!std::isfinite(value)) return kNotKnown;
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size < 1e-4 || size >= 1e7) return ShortExponent(Format(value, std::chars_format::scientific, digits - 1));
  const int exponent = static_cast<int>(std::floor(std::log10(size)));
  return Fixed(value, std::max(0, digits - 1 - exponent));
}

std::string AsCertainAs(double value, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma)) return WithoutEndingZeros(Significant(value, 6));
  return Fixed(value, std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 8));
}

std::string Mm(double value_m) { return Fixed(value_m * kMmPerMetre, 2); }
std::string Deg(double value_rad) { return Fixed(value_rad * kDegPerRad, 3); }
std::string SigmaMm(double value_m) { return Significant(value_m * kMmPerMetre, 2); }
std::string SigmaDeg(double value_rad) { return Significant(value_rad * kDegPerRad, 2); }

RollPitchYaw RollPitchYawOf(const Eigen::Quaterniond& q) {
  const Eigen::Matrix3d R = q.toRotationMatrix();
  const double cos_pitch = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cos_pitch);
  if (cos_pitch < 1e-9) return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

std::string FigureName(const std::string& figure) {
  const Unit* unit = UnitOf(figure);
  std::string name = unit ? figure.substr(0, figure.size() - unit->suffix.size()) : figure;
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

FigureUnit UnitOfFigure(const std::string& figure) {
  const Unit* unit = UnitOf(figure);
  return unit ? FigureUnit{std::string(unit->shown), unit->scale} : FigureUnit{};
}

std::string FigureValue(const std::string& figure, double value) {
  const Unit* unit = UnitOf(figure);
  if (!unit && std::isfinite(value) && value == std::floor(value)) return Fixed(value, 0);
  const std::string number = Significant(value * (unit ? unit->scale : 1.0), 4);
  return !unit || number == kNotKnown ? number : number + std::string(unit->shown);
}

std::string InAddress(const std::string& words) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  constexpr const char* kDigits = "0123456789ABCDEF";
  std::string address;
  for (const char letter : words) {
    const auto byte = static_cast<unsigned char>(letter);
    if (letter == ' ')
      address += '+';
    else if (kPlain.find(letter) != std::string_view::npos)
      address += letter;
    else
      address += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  return address;
}

std::string Count(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string TimeText(Stamp stamp) {
  std::string iso = ToIso(stamp).substr(0, 19);
  std::replace(iso.begin(), iso.end(), 'T', ' ');
  return iso + " UTC";
}

std::string VerdictWord(VerdictLevel level) {
  switch (level) {
    case VerdictLevel::kPass:
      return "Pass";
    case VerdictLevel::kWarn:
      return "Warning";
    case VerdictLevel::kFail:
      return "Fail";
    case VerdictLevel::kUnknown:
      break;
  }
  return "Unknown";
}

std::string HowText(const Standing& standing) {
  if (standing.how == "pushed") return "pushed";
  if (standing.how == "pushed_again") return "pushed again";
  const std::string reason = standing.word.reason.empty() ? "" : " (" + standing.word.reason + ")";
  return standing.how + " by " + standing.word.who + reason;
}

std::string ShortDigest(const std::string& digest) { return digest.substr(0, 12); }

}  // namespace rigcal::report
