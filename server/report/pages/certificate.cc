#include "server/report/pages/certificate.h"

#include "server/report/frame/assets.h"
#include "server/report/frame/banner.h"
#include "server/report/frame/page.h"

namespace rigcal::report {
namespace {

// A cell of words takes the place of figures, or is as wide as it needs to be.
void FillCell(Dictionary& row, const CertificateCell& cell, bool is_number) {
  Dictionary* filled = row.AddSectionDictionary("CELLS");
  Dictionary* part = filled->AddSectionDictionary(is_number && cell.span == 1 ? "FIGURE" : "WORDS");
  part->SetValue("CELL", cell.text);
  if (!is_number || cell.span > 1) part->SetValue("SPAN", std::to_string(cell.span));
}

void FillTable(Dictionary& part, const CertificateTable& table) {
  if (table.columns.empty()) return;
  Dictionary* filled = part.AddSectionDictionary("TABLE");
  for (const CertificateTable::Column& column : table.columns) ShowValue(*filled, "COLUMN", "NAME", column.title);
  for (const std::vector<CertificateCell>& cells : table.rows) {
    Dictionary* row = filled->AddSectionDictionary("ROW");
    ShowValue(*row, "FIRST", "CELL", cells.front().text);
    auto column = static_cast<std::size_t>(cells.front().span);
    for (std::size_t i = 1; i < cells.size(); column += static_cast<std::size_t>(cells[i].span), ++i)
      FillCell(*row, cells[i], table.columns[column].is_number);
  }
}

void FillPart(Dictionary& page, const CertificatePart& told, std::size_t index) {
  Dictionary* part = page.AddSectionDictionary("PART");
  part->SetValue("INDEX", std::to_string(index));
  part->SetValue("HEADING", told.heading);
  for (const std::string& line : told.text) ShowValue(*part, "TEXT", "LINE", line);
  FillTable(*part, told.table);
  for (const std::string& line : told.notes) ShowValue(*part, "NOTE", "LINE", line);
}

}  // namespace

Result<std::string> RenderCertificate(const ReportInput& input, const CertificateStanding& standing,
                                      const std::string& root) {
  const Certificate certificate = CertificateOf(input, standing);
  const std::string robot = certificate.robot.str(), number = std::to_string(certificate.revision);
  Dictionary page("certificate");
  FillHead(page, robot + ", revision " + number + ": " + certificate.title, root);
  page.SetValue("TITLE", certificate.title);
  page.SetValue("ROBOT", robot);
  page.SetValue("NUMBER", number);
  page.SetValue("MEASURED", certificate.measured);
  page.SetValue("STATE", certificate.state);
  if (!certificate.rig_model.empty()) ShowValue(page, "RIG", "NAME", certificate.rig_model);
  FillBanner(page, certificate.verdict, standing.validity, true, standing.runs);
  for (std::size_t i = 0; i < certificate.parts.size(); ++i) FillPart(page, certificate.parts[i], i);
  if (certificate.to_sign) page.ShowSection("TO_SIGN");
  AddScript(page, root + AssetPath("tables.js"));
  return Expand("certificate.tpl", page);
}

}  // namespace rigcal::report
