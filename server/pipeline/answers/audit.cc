#include "server/pipeline/answers/audit.h"

#include "server/formats/answers/answers.h"
#include "server/pipeline/robots/asked.h"
#include "storage/audit.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

// 0 where it is not there.
Result<std::int64_t> AuditRowBefore(const Parameters& parameters) {
  if (!parameters.Text("before")) return 0;
  RIGCAL_ASSIGN(const std::int64_t before, parameters.IntegerOr("before", 0));
  if (before >= 1) return before;
  return Fail(ErrorCode::kInvalidInput, "the parameter 'before' is " + std::to_string(before),
              "Give the number of an audit row.");
}

}  // namespace

Result<std::string> ListAudit(const AnswerContext& context, const Parameters& parameters) {
  RobotId robot;
  if (parameters.Text("robot")) {
    RIGCAL_ASSIGN(robot, KnownRobot(context.store, parameters));
  }
  RIGCAL_ASSIGN(const std::int64_t page_rows, PageRows(parameters));
  RIGCAL_ASSIGN(const std::int64_t before, AuditRowBefore(parameters));
  RIGCAL_ASSIGN(auto rows,
                storage::LoadAudit(context.store, robot, before, page_rows == 0 ? storage::kAllRows : page_rows + 1));
  std::optional<std::int64_t> next;
  if (page_rows > 0) next = CutToPage(page_rows, rows) ? rows.back().number : 0;
  return formats::WriteAudit(rows, next);
}

Result<std::string> VerifyAudit(const AnswerContext& context, const Parameters&) {
  RIGCAL_ASSIGN(const AuditCheck check, storage::VerifyAudit(context.store));
  return formats::WriteAuditCheck(check);
}

}  // namespace rigcal::pipeline
