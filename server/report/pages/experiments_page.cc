#include "server/report/pages/experiments_page.h"

#include <algorithm>

#include "server/report/frame/page.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr std::size_t kExperimentsMax = 1000;  // on one page

// "noise_whitening" -> "Noise whitening".
std::string TitleOf(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  std::replace(name.begin(), name.end(), '-', ' ');
  if (!name.empty() && name.front() >= 'a' && name.front() <= 'z')
    name.front() = static_cast<char>(name.front() - 'a' + 'A');
  return name;
}

}  // namespace

Result<std::string> RenderExperiments(const std::vector<ExperimentRow>& rows) {
  Dictionary page("experiments");
  FillHead(page, "Experiments", "../");
  if (rows.empty()) page.ShowSection("EMPTY");
  Dictionary* list = rows.empty() ? nullptr : page.AddSectionDictionary("LIST");
  const std::size_t count = std::min(rows.size(), kExperimentsMax);
  for (std::size_t idx = 0; idx < count; ++idx) {
    const ExperimentRow& row = rows[idx];
    Dictionary* one = list->AddSectionDictionary("EXPERIMENT");
    one->SetValue("NAME", row.name);
    one->SetValue("TITLE", row.title.empty() ? TitleOf(row.name) : row.title);
    one->SetValue("TIME", TimeText(row.written_at));
    if (row.has_figures) ShowValue(*one, "FIGURES", "NAME", row.name);
  }
  if (count < rows.size())
    ShowValue(*list, "CUT", "TEXT",
              std::to_string(count) + " of " + std::to_string(rows.size()) +
                  " experiments are listed, by name; the others open by their address, /experiments/NAME/.");
  return Expand("experiments.tpl", page);
}

}  // namespace rigcal::report
