#include "client/positive.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include "server/base/text.h"

namespace rigcal::client {
namespace {

// Empty: it is one.
std::string WhyNotPositive(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool is_number = !text.empty() && end == text.c_str() + text.size() && std::isfinite(value);
  if (is_number && value > 0.0) return "";
  return is_number ? text + " is out of range: give a number above 0" : Quoted(text) + " is no number above 0";
}

}  // namespace

const CLI::Validator& Positive() {
  static const CLI::Validator positive([](std::string& text) { return WhyNotPositive(text); }, "POSITIVE");
  return positive;
}

}  // namespace rigcal::client
