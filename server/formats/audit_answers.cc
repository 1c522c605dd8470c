#include "server/formats/answers.h"
#include "server/formats/json_values.h"

namespace rigcal::formats {
namespace {

void WriteAuditRow(JsonWriter& out, const AuditRow& row) {
  out.Integer("number", row.number);
  WriteStamp(out, "at", row.at);
  row.robot.empty() ? out.Null("robot") : out.Text("robot", row.robot.str());
  out.Text("who", row.who);
  out.Text("what", row.what);
  row.hash ? out.Text("hash", row.hash->str()) : out.Null("hash");
}

void WriteAuditFault(JsonWriter& out, const std::optional<AuditFault>& fault) {
  if (!fault) return out.Null("fault");
  out.Object("fault", [&] {
    out.Integer("number", fault->number);
    WriteStamp(out, "at", fault->at);
    out.Text("what", TextOf(*fault));
  });
}

}  // namespace

std::string WriteAudit(const std::vector<AuditRow>& rows, const std::optional<std::int64_t>& next) {
  return WriteObject([&](JsonWriter& out) {
    if (next) *next > 0 ? out.Integer("next", *next) : out.Null("next");
    out.List("rows", [&] {
      for (const AuditRow& row : rows) out.Object([&] { WriteAuditRow(out, row); });
    });
  });
}

std::string WriteAuditCheck(const AuditCheck& check) {
  return WriteObject([&](JsonWriter& out) {
    out.Integer("rows", check.rows);
    out.Object("head", [&] {
      out.Integer("number", check.head_number);
      out.Text("hash", check.head.str());
    });
    WriteAuditFault(out, check.fault);
  });
}

}  // namespace rigcal::formats
