#include "client/companion/shown.h"

#include "companion_page.h"
#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/formats/json/json_values.h"
#include "server/formats/sessions/payload_path.h"

namespace rigcal::companion {
namespace {

constexpr std::string_view kPictures = "/pictures/";

std::string WaitingJson(const std::string& headline) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.List("captures", [] {});
    out.Flag("looking", true);
    out.Flag("enough", false);
    out.Text("headline", headline);
    out.List("remarks", [] {});
    out.List("sensors", [] {});
    out.Null("next");
  });
}

}  // namespace

Shown::Shown(std::filesystem::path folder) : folder_(std::move(folder)) {
  Put({WaitingJson("The folder is being read."), {}});
}

void Shown::Put(Document document) {
  auto next = std::make_shared<const Document>(std::move(document));
  const std::lock_guard lock(mutex_);
  now_ = std::move(next);
}

std::shared_ptr<const Shown::Document> Shown::Now() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void Shown::Show(const Standing& standing) {
  Document document{StandingJson(standing), {}};
  for (const auto& [sensor, pictures] : standing.captured.pictures)
    for (const auto& [capture, picture] : pictures) document.pictures.insert(picture.path);
  Put(std::move(document));
}

void Shown::ShowTrouble(const Error& error) { Put({WaitingJson(Sentence(error)), {}}); }

Result<http::Page> Shown::Answer(const std::string& path) const {
  if (path == "/") return http::Page{std::string(page::kcompanion_html), "text/html; charset=utf-8"};
  if (path == "/companion.css") return http::Page{std::string(page::kcompanion_css), "text/css; charset=utf-8"};
  if (path == "/companion.js") return http::Page{std::string(page::kcompanion_js), "text/javascript; charset=utf-8"};
  const auto now = Now();
  if (path == "/api/v1/companion") return http::Page{now->json, "application/json"};
  const std::string picture = path.starts_with(kPictures) ? path.substr(kPictures.size()) : "";
  if (!now->pictures.contains(picture))
    return Fail(ErrorCode::kNotFound, path + " is not shown here", "Start at the page of the companion: /");
  RIGCAL_ASSIGN(std::string bytes, ReadFile(folder_ / picture, static_cast<std::size_t>(limits::kPayloadBytesMax)));
  const bool is_png = formats::SuffixOf(picture) == "png";
  return http::Page{std::move(bytes), is_png ? "image/png" : "image/jpeg"};
}

}  // namespace rigcal::companion
