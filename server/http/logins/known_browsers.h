// Browsers in which somebody logged in before: they have tries of their own, which others cannot use up. Any thread.
#pragma once

#include <string>

namespace rigcal::http {

class KnownBrowsers {
 public:
  KnownBrowsers();
  // The value of a cookie for a browser in which `name` logged in: 64 hex digits, others each time. Good as long as
  // this object lives.
  [[nodiscard]] std::string MarkFor(const std::string& name) const;
  // Whether MarkFor(name) gave it.
  [[nodiscard]] bool Has(const std::string& mark, const std::string& name) const;

 private:
  [[nodiscard]] std::string SignedFor(const std::string& browser, const std::string& name) const;
  const std::string key_;
};

}  // namespace rigcal::http
