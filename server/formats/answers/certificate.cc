#include "server/formats/answers/certificate.h"

#include <limits>

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kCertificateBytesMax = 64u << 20, kParagraphBytesMax = 64u << 10;
constexpr std::size_t kColumnsMax = 32, kParagraphsMax = 1024, kPartsMax = 32;

void WriteSentences(JsonWriter& out, const char* key, const std::vector<std::string>& texts) {
  out.List(key, [&] {
    for (const std::string& text : texts) out.Text(text);
  });
}

void WriteTable(JsonWriter& out, const CertificateTable& table) {
  if (table.columns.empty()) return out.Null("table");
  out.Object("table", [&] {
    out.List("columns", [&] {
      for (const CertificateTable::Column& column : table.columns)
        out.Object([&] { out.Text("title", column.title), out.Flag("number", column.is_number); });
    });
    out.List("rows", [&] {
      for (const auto& row : table.rows)
        out.List([&] {
          for (const CertificateCell& cell : row)
            out.Object([&] { out.Text("text", cell.text), out.Integer("span", cell.span); });
        });
    });
  });
}

void WritePart(JsonWriter& out, const CertificatePart& part) {
  out.Object([&] {
    out.Text("heading", part.heading);
    WriteSentences(out, "text", part.text);
    WriteTable(out, part.table);
    WriteSentences(out, "notes", part.notes);
  });
}

std::vector<std::string> ReadSentences(const JsonField& field) {
  std::vector<std::string> texts;
  for (const JsonField& text : field.Items(kParagraphsMax)) texts.push_back(text.Text(kParagraphBytesMax));
  return texts;
}

std::vector<CertificateCell> ReadRow(const JsonField& field, std::size_t columns) {
  std::vector<CertificateCell> row;
  std::size_t taken = 0;
  for (const JsonField& cell : field.Items(kColumnsMax)) {
    row.push_back({cell.At("text").Text(kParagraphBytesMax),
                   static_cast<int>(cell.At("span").Integer(1, static_cast<std::int64_t>(kColumnsMax)))});
    taken += static_cast<std::size_t>(row.back().span);
  }
  if (taken != columns) field.Refuse("must fill the columns of the table");
  return row;
}

CertificateTable ReadTable(const JsonField& field) {
  CertificateTable table;
  for (const JsonField& column : field.At("columns").Items(kColumnsMax))
    table.columns.push_back({column.At("title").Text(), column.At("number").Flag()});
  for (const JsonField& row : field.At("rows").Items(limits::kSensorsPerRobotMax))
    table.rows.push_back(ReadRow(row, table.columns.size()));
  return table;
}

CertificatePart ReadPart(const JsonField& field) {
  CertificatePart part;
  part.heading = field.At("heading").Text();
  part.text = ReadSentences(field.At("text"));
  if (const auto table = field.Find("table")) part.table = ReadTable(*table);
  part.notes = ReadSentences(field.At("notes"));
  return part;
}

}  // namespace

std::string WriteCertificate(const Certificate& certificate) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", certificate.robot.str());
    out.Integer("revision", certificate.revision);
    certificate.rig_model.empty() ? out.Null("rig_model") : out.Text("rig_model", certificate.rig_model);
    out.Text("title", certificate.title);
    out.Flag("to_sign", certificate.to_sign);
    out.Text("measured", certificate.measured);
    out.Text("state", certificate.state);
    out.Text("rule", certificate.rule);
    WriteVerdict(out, "verdict", certificate.verdict);
    out.List("parts", [&] {
      for (const CertificatePart& part : certificate.parts) WritePart(out, part);
    });
  });
}

Result<Certificate> ReadCertificate(std::string_view text) {
  const JsonKind kind = {"the server's answer to 'certificate'",
                         "Check with `rigcal doctor` that client and server are of the same version.",
                         kCertificateBytesMax};
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, kind));
  const JsonField root = document.Root();
  Certificate certificate;
  certificate.robot = ReadId<RobotId>(root.At("robot"));
  certificate.revision = static_cast<int>(root.At("revision").Integer(1, std::numeric_limits<int>::max()));
  if (const auto model = root.Find("rig_model")) certificate.rig_model = model->Text();
  certificate.title = root.At("title").Text();
  certificate.to_sign = root.At("to_sign").Flag();
  certificate.measured = root.At("measured").Text();
  certificate.state = root.At("state").Text(kParagraphBytesMax);
  certificate.rule = root.At("rule").Text(kParagraphBytesMax);
  certificate.verdict = ReadVerdict(root.At("verdict"));
  for (const JsonField& part : root.At("parts").Items(kPartsMax)) certificate.parts.push_back(ReadPart(part));
  RIGCAL_TRY(document.status());
  return certificate;
}

}  // namespace rigcal::formats
