#include "server/pipeline/pages/experiments.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <sstream>

#include "server/base/text.h"

namespace rigcal::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFileBytesMax = 64u << 20;
constexpr std::array<std::pair<const char*, const char*>, 8> kTypes = {{{".html", "text/html; charset=utf-8"},
                                                                        {".json", "application/json; charset=utf-8"},
                                                                        {".css", "text/css; charset=utf-8"},
                                                                        {".js", "text/javascript; charset=utf-8"},
                                                                        {".svg", "image/svg+xml"},
                                                                        {".png", "image/png"},
                                                                        {".jpg", "image/jpeg"},
                                                                        {".csv", "text/csv; charset=utf-8"}}};

tl::unexpected<Error> NoExperiment(const std::string& rest) {
  return Fail(ErrorCode::kNotFound, "there is no page /experiments/" + rest, "See the list: /experiments/");
}

// Letters, digits, '.', '_', '-', not beginning with '.': neither a parent folder nor a hidden file.
bool IsName(const std::string& text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '-';
  };
  return !text.empty() && text.size() <= 100 && text.front() != '.' && std::all_of(text.begin(), text.end(), is_plain);
}

// As it is: a link may lead out of the folder.
bool IsPlainFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(path, error)) && !error;
}
bool IsPlainFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(fs::symlink_status(path, error)) && !error;
}

Stamp WrittenAt(const fs::path& file) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  if (error) return {};
  const auto since = std::chrono::file_clock::to_sys(written).time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since).count()};
}

Result<PageText> ExperimentFile(const fs::path& file, const std::string& rest) {
  const auto type =
      std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& one) { return file.extension() == one.first; });
  std::error_code error;
  if (type == kTypes.end() || !IsPlainFile(file)) return NoExperiment(rest);
  const auto bytes = fs::file_size(file, error);
  if (error || bytes > kFileBytesMax) return NoExperiment(rest);
  std::string body(bytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(body.data(), static_cast<std::streamsize>(bytes))) return NoExperiment(rest);
  return PageText{std::move(body), type->second};
}

// Of a page, as far as it is plain text near the page's beginning; "" otherwise.
std::string TitleOf(const fs::path& page) {
  constexpr std::size_t kHeadBytesMax = 4096, kTitleBytesMax = 200;
  std::string head(kHeadBytesMax, '\0');
  std::ifstream stream(page, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  const std::string open = "<title>";
  const std::size_t start = head.find(open), end = head.find("</title>");
  if (start == std::string::npos || end == std::string::npos || end < start) return "";
  std::istringstream words(head.substr(start + open.size(), end - start - open.size()));
  std::string title, word;
  while (words >> word) title += (title.empty() ? "" : " ") + word;
  const bool is_plain = title.find_first_of("&<") == std::string::npos && IsPrintableUtf8(title);
  return is_plain && title.size() <= kTitleBytesMax ? title : "";
}

}  // namespace

std::vector<report::ExperimentRow> ListExperiments(const fs::path& folder) {
  std::vector<report::ExperimentRow> rows;
  std::error_code error;
  const fs::path all = folder / "experiments";
  for (fs::directory_iterator at(all, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    const fs::path page = at->path() / "index.html";
    if (!IsName(name) || !IsPlainFolder(at->path()) || !IsPlainFile(page)) continue;
    rows.push_back({name, WrittenAt(page), IsPlainFile(at->path() / "experiment.json")});
  }
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return rows;
}

Result<PageText> AnswerExperiments(const AnswerContext& context, const std::string& rest) {
  const fs::path all = context.store.folder() / "experiments";
  if (rest.empty()) {
    std::vector<report::ExperimentRow> rows = ListExperiments(context.store.folder());
    for (report::ExperimentRow& row : rows) row.title = TitleOf(all / row.name / "index.html");
    RIGCAL_ASSIGN(std::string body, report::RenderExperiments(rows));
    return PageText{std::move(body), kTypes[0].second};
  }
  const std::size_t slash = rest.find('/');
  const std::string name = rest.substr(0, slash);
  const std::string file = slash == std::string::npos ? "" : rest.substr(slash + 1);
  if (!IsName(name) || slash == std::string::npos || !IsPlainFolder(all / name)) return NoExperiment(rest);
  if (file.empty()) return ExperimentFile(all / name / "index.html", rest);
  return IsName(file) ? ExperimentFile(all / name / file, rest) : NoExperiment(rest);
}

}  // namespace rigcal::pipeline
