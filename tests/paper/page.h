// The experiments' page: index.html, style.css and the figures beside it. No scripts, no outside links, no style within
// the page, so that a server with a strict content policy can show it too.
#pragma once

#include <string>
#include <vector>

namespace rigcal::paper {

struct Picture {
  std::string name;  // of its file, without ".svg"
  std::string svg;
};

// Titles and texts are HTML. Figures are part of the page, and files beside it.
struct Section {
  std::string html;
  std::vector<Picture> pictures;
};

// Text as HTML.
[[nodiscard]] std::string Escaped(const std::string& text);
// A picture as HTML, with a sentence under it; the picture goes into the section's list.
[[nodiscard]] std::string Figure(const std::string& name, const std::string& svg, const std::string& caption,
                                 Section& section);

struct PageFile {
  std::string name, text;
};
[[nodiscard]] std::vector<PageFile> PageFiles(const std::string& introduction, const std::vector<Section>& sections);

}  // namespace rigcal::paper
