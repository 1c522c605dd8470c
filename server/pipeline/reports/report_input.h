// READ: everything that a revision's report shows.
#pragma once

#include "server/report/render.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// `revision` with its document. Without `evidence`, which is there once the pictures are linked.
[[nodiscard]] Result<report::ReportInput> LoadReportInput(storage::Store& store, const Revision& revision);
// As much of it as a certificate says (report/certificate/content.h).
[[nodiscard]] Result<report::ReportInput> LoadCertificateInput(storage::Store& store, const Revision& revision);

}  // namespace rigcal::pipeline
