#include "server/http/error_body.h"

#include <nlohmann/json.hpp>

namespace rigcal::http {
namespace {

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string TitleOf(int status) {
  switch (status) {
    case 404:
      return "There is nothing here";
    case 405:
      return "This server only shows";
    case 503:
      return "This cannot be shown now";
    default:
      return status < 500 ? "This request is not understood" : "Something failed here";
  }
}

}  // namespace

int StatusOf(ErrorCode code) {
  if (code == ErrorCode::kNotFound) return 404;
  return code == ErrorCode::kInvalidInput ? 400 : 503;
}

std::string ErrorDocument(const Error& error) {
  const nlohmann::json document = {
      {"error", {{"code", NameOf(error.code)}, {"what", error.what}, {"cure", error.cure}}}};
  return document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string ErrorPage(int status, const Error& error) {
  const std::string title = TitleOf(status);
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
         "<title>" +
         title +
         "</title><link rel=\"icon\" href=\"data:,\">"
         "<link rel=\"stylesheet\" href=\"/style.css\"></head>\n<body><main>"
         "<nav class=\"crumbs\"><a href=\"/\">Fleet</a></nav><h1>" +
         title +
         "</h1>"
         "<section class=\"card empty\"><p dir=\"auto\">" +
         Escaped(error.what) + "</p><p dir=\"auto\" class=\"soft\">" + Escaped(error.cure) +
         "</p></section><p class=\"hint\">HTTP " + std::to_string(status) + "</p></main></body></html>\n";
}

}  // namespace rigcal::http
