// The list of experiments: pages that another program wrote.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/base/stamp.h"

namespace rigcal::report {

struct ExperimentRow {
  std::string name;  // of its folder
  Stamp written_at;
  bool has_figures = false;  // experiment.json
  std::string title = {};    // of its page; empty: its name
};
// In the order of `rows`; beyond a limit only how many there are is told.
[[nodiscard]] Result<std::string> RenderExperiments(const std::vector<ExperimentRow>& rows);

}  // namespace rigcal::report
