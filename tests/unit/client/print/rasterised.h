// A file of a board as a printer's driver has it: drawn by other programs than ours, at 254 dots per inch: 10 px a mm.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "client/print/pdf.h"
#include "client/print/sheet.h"
#include "client/print/svg.h"
#include "server/base/files/durable_file.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::print {

inline constexpr double kPixelsPerMetre = 10'000;

// poppler's pdftoppm of PDF, librsvg's rsvg-convert of SVG; PNG bytes. Nothing where that program is not installed.
inline std::optional<std::string> Rasterised(const std::string& text, const std::string& suffix) {
  const storage::TempFolder folder;
  const std::filesystem::path in = folder.path() / ("board" + suffix), out = folder.path() / "board.png";
  if (!WriteDurably(in, text)) return std::nullopt;
  const std::string stem = (folder.path() / "board").string();
  const std::string command = suffix == ".pdf"
                                  ? "pdftoppm -r 254 -gray -png -singlefile " + in.string() + " " + stem
                                  : "rsvg-convert -d 254 -p 254 -f png -o " + out.string() + " " + in.string();
  if (std::system((command + " 2>/dev/null").c_str()) != 0) return std::nullopt;
  const auto png = ReadFile(out, 64u << 20);
  return png ? std::optional(*png) : std::nullopt;
}

}  // namespace rigcal::print
