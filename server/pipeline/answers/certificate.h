// The certificate of a revision as it stands when somebody asks: its document (the verb `certificate`), and its page.
#pragma once

#include "server/base/result.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// READ. `robot`, and `revision`, optional: the newest.
[[nodiscard]] Result<std::string> TellCertificate(const AnswerContext& context, const formats::Parameters& parameters);
// READ: /robots/<id>/revisions/<n>/certificate.html, whether the report is on disk or not. kNotFound: no such revision.
[[nodiscard]] Result<std::string> CertificatePage(const AnswerContext& context, const RobotId& robot, int number);

}  // namespace rigcal::pipeline
