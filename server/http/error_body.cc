#include "server/http/error_body.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "server/http/pages/html_text.h"

namespace rigcal::http {
namespace {

std::string TitleOf(int status) {
  switch (status) {
    case 401:
      return "This needs a login";
    case 403:
      return "This is not allowed";
    case 421:
      return "This server has another name";
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

// Errors are written as parts of a sentence; a page shows them by themselves.
std::string Sentence(std::string text) {
  if (text.empty()) return text;
  if (text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  if (std::string_view(".?!/").find(text.back()) == std::string_view::npos) text += '.';
  std::string html;
  bool is_code = false;
  for (const char c : Escaped(text)) {
    if (c != '`') {
      html += c;
      continue;
    }
    html += is_code ? "</code>" : "<code>";
    is_code = !is_code;
  }
  return html + (is_code ? "</code>" : "");
}

std::string LinksOf(const std::string& robot) {
  const std::string fleet = "<p class=\"downloads\"><a class=\"button\" href=\"/\">All robots</a>";
  if (robot.empty()) return fleet + "</p>";
  return fleet + "<a class=\"button\" href=\"/robots/" + Escaped(robot) + "/\">" + Escaped(robot) + "</a></p>";
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

std::string ErrorPage(int status, const Error& error, const std::string& robot) {
  const std::string title = TitleOf(status);
  return PageAround(
      title, "<nav class=\"crumbs\" aria-label=\"Where you are\"><a href=\"/\">Fleet</a></nav><header><h1>" + title +
                 "</h1><p class=\"meta\">Error " + std::to_string(status) +
                 "</p></header><section class=\"card empty\"><p class=\"what\" dir=\"auto\">" + Sentence(error.what) +
                 "</p><p dir=\"auto\" class=\"soft\">" + Sentence(error.cure) + "</p>" + LinksOf(robot) + "</section>");
}

}  // namespace rigcal::http
