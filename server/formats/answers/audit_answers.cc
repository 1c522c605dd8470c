#include "server/formats/answers/answers.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

void WriteAuditRow(JsonWriter& out, const AuditRow& row) {
  out.Integer("number", row.number);
  WriteStamp(out, "at", row.at);
  row.robot.empty() ? out.Null("robot") : out.Text("robot", row.robot.str());
  out.Text("who", row.who);
  out.Text("what", row.what);
  row.digest ? out.Text("digest", row.digest->str()) : out.Null("digest");
  row.hash ? out.Text("hash", row.hash->str()) : out.Null("hash");
}

void WriteAuditFaultMembers(JsonWriter& out, const AuditFault& fault) {
  fault.number > 0 ? out.Integer("number", fault.number) : out.Null("number");
  WriteStamp(out, "at", fault.at);
  out.Text("what", TextOf(fault));
}

// Who asks for one alone is told of a row as well.
void WriteAuditFault(JsonWriter& out, const AuditCheck& check) {
  if (Holds(check)) return out.Null("fault");
  out.Object("fault", [&] { WriteAuditFaultMembers(out, check.fault ? *check.fault : check.row_faults.front()); });
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
    WriteAuditFault(out, check);
    out.Flag("chain_holds", !check.fault);
    out.Integer("from_before", check.from_before);
    out.Integer("without_digest", check.without_digest);
    out.Integer("row_faults_total", check.row_faults_count);
    out.List("row_faults", [&] {
      for (const AuditFault& fault : check.row_faults) out.Object([&] { WriteAuditFaultMembers(out, fault); });
    });
  });
}

}  // namespace rigcal::formats
