#include "server/pipeline/answers/certificate.h"

#include "server/formats/answers/certificate.h"
#include "server/pipeline/reports/report_input.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/validity.h"
#include "server/report/pages/certificate.h"

namespace rigcal::pipeline {
namespace {

constexpr const char* kRootOfSite = "../../../../";  // of the page's address

struct Asked {
  report::ReportInput input;
  report::CertificateStanding standing;
};

Result<Asked> LoadAsked(const AnswerContext& context, const RobotId& robot, std::int64_t number) {
  RIGCAL_ASSIGN(const Revision revision, LoadRevisionOf(context.store, robot, number));
  Asked asked;
  RIGCAL_ASSIGN(asked.input, LoadCertificateInput(context.store, revision));
  RIGCAL_ASSIGN(asked.standing.validity, LoadValidity(context.store, revision, context.clock.Now()));
  RIGCAL_ASSIGN(asked.standing.approval, LoadApproval(context.store, revision));
  RIGCAL_ASSIGN(asked.standing.runs, LoadWhatRuns(context.store, robot));
  return asked;
}

}  // namespace

Result<std::string> TellCertificate(const AnswerContext& context, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const RobotId robot, KnownRobot(context.store, parameters));
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("revision", 0));
  RIGCAL_ASSIGN(const Asked asked, LoadAsked(context, robot, number));
  return formats::WriteCertificate(report::CertificateOf(asked.input, asked.standing));
}

Result<std::string> CertificatePage(const AnswerContext& context, const RobotId& robot, int number) {
  RIGCAL_ASSIGN(const Asked asked, LoadAsked(context, robot, number));
  return report::RenderCertificate(asked.input, asked.standing, kRootOfSite);
}

}  // namespace rigcal::pipeline
