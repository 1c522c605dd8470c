#include "client/print/pdf.h"

#include <cairo/cairo-pdf.h>

#include <cmath>
#include <memory>

namespace rigcal::print {
namespace {

constexpr double kPointsPerMetre = 72 / 0.0254;

cairo_status_t Append(void* bytes, const unsigned char* data, unsigned int count) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), count);
  return CAIRO_STATUS_SUCCESS;
}

// One path: between rectangles that touch nothing shines through.
void DrawBlack(cairo_t* cairo, const Sheet& sheet) {
  for (const Rectangle& one : sheet.black) cairo_rectangle(cairo, one.x_m, one.y_m, one.width_m, one.height_m);
  cairo_fill(cairo);
  for (const Disc& one : sheet.discs) {
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, one.x_m, one.y_m, one.diameter_m / 2, 0, 2 * M_PI);
    cairo_close_path(cairo);
  }
  cairo_fill(cairo);
}

void DrawLabels(cairo_t* cairo, const Sheet& sheet) {
  for (const Label& label : sheet.labels) {
    cairo_select_font_face(cairo, label.is_monospace ? "monospace" : "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, label.height_m);
    cairo_move_to(cairo, label.x_m, label.y_m);
    cairo_show_text(cairo, label.text.c_str());
  }
}

tl::unexpected<Error> CairoFailed(cairo_status_t status) {
  return Fail(ErrorCode::kStorage, std::string("the PDF could not be drawn: ") + cairo_status_to_string(status),
              "Write an .svg instead, and print that.");
}

}  // namespace

Result<std::string> WritePdf(const Sheet& sheet, const std::string& title) {
  return WritePdf(std::vector<Sheet>{sheet}, title);
}

Result<std::string> WritePdf(const std::vector<Sheet>& sheets, const std::string& title) {
  std::string bytes;
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_pdf_surface_create_for_stream(Append, &bytes, sheets.front().width_m * kPointsPerMetre,
                                          sheets.front().height_m * kPointsPerMetre),
      cairo_surface_destroy);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, title.c_str());
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");  // else it is now
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_scale(cairo.get(), kPointsPerMetre, kPointsPerMetre);
  cairo_set_source_rgb(cairo.get(), 0, 0, 0);
  for (const Sheet& sheet : sheets) {
    DrawBlack(cairo.get(), sheet);
    DrawLabels(cairo.get(), sheet);
    cairo_show_page(cairo.get());
  }
  const cairo_status_t drawn = cairo_status(cairo.get());
  cairo_surface_finish(surface.get());
  if (drawn != CAIRO_STATUS_SUCCESS) return CairoFailed(drawn);
  if (const cairo_status_t written = cairo_surface_status(surface.get()); written != CAIRO_STATUS_SUCCESS)
    return CairoFailed(written);
  return bytes;
}

}  // namespace rigcal::print
