#include "tests/paper/page.h"

#include <fmt/format.h>

namespace rigcal::paper {
namespace {

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,">
<title>The paper's experiments</title><link rel="stylesheet" href="style.css"></head><body><main>
<h1>The paper's experiments</h1>
)";

constexpr const char* kStyle =
    R"(:root { color-scheme: light dark; --text: #1c2330; --soft: #5a6575; --back: #fff; --line: #d7dce3; }
@media (prefers-color-scheme: dark) { :root { --text: #dfe4ec; --soft: #9aa5b5; --back: #14181f; --line: #364050; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--text); background: var(--back); max-width: 64rem;
  margin: 2rem auto; padding: 0 1rem; }
h2 { margin-top: 3rem; }
figure { margin: 1rem 0; overflow-x: auto; }
figcaption { color: var(--soft); font-size: .9rem; }
svg { max-width: 100%; height: auto; }
@media (max-width: 48rem) { figure svg { max-width: none; width: 44rem; } }
.table { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .9rem; }
td, th { padding: .25rem .7rem; border-bottom: 1px solid var(--line); text-align: right; }
td.tight { white-space: nowrap; }
td.text { text-align: left; }
th { text-align: left; font-weight: 600; }
tr.sum td, tr.sum th { border-top: 2px solid var(--line); }
)";

}  // namespace

std::string Escaped(const std::string& text) {
  std::string html;
  for (const char c : text) {
    if (c == '&')
      html += "&amp;";
    else if (c == '<')
      html += "&lt;";
    else
      html += c;
  }
  return html;
}

std::string Figure(const std::string& name, const std::string& svg, const std::string& caption, Section& section) {
  section.pictures.push_back({name, svg});
  return "<figure tabindex=\"0\">" + svg + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::vector<PageFile> PageFiles(const std::string& introduction, const std::vector<Section>& sections) {
  std::string page = kHead + introduction;
  std::vector<PageFile> files = {{"style.css", kStyle}};
  for (const Section& section : sections) {
    page += section.html;
    for (const Picture& picture : section.pictures) files.push_back({picture.name + ".svg", picture.svg});
  }
  files.push_back({"index.html", page + "</main></body></html>\n"});
  return files;
}

}  // namespace rigcal::paper
