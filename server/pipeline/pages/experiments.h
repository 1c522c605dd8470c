// READ: pages that another program put into <data>/experiments/<name>/: index.html, what it refers to, and
// experiment.json with the figures behind it.
#pragma once

#include <filesystem>

#include "server/pipeline/answers/answer.h"
#include "server/report/pages/experiments_page.h"

namespace rigcal::pipeline {

// Folders with an index.html, by name; `folder` is the server's data folder. Nothing where there are none.
[[nodiscard]] std::vector<report::ExperimentRow> ListExperiments(const std::filesystem::path& folder);

// `rest` is what follows "/experiments/": "" (the list), "<name>/", "<name>/<file>". A file is served as what its
// suffix says if it is a plain file inside its folder and its kind is known; kNotFound for everything else.
[[nodiscard]] Result<PageText> AnswerExperiments(const AnswerContext& context, const std::string& rest);

}  // namespace rigcal::pipeline
