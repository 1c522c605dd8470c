#include "server/report/frame/figure.h"

namespace rigcal::report {

Dictionary& AddFigures(Dictionary& page, const char* place, const char* label) {
  Dictionary* figures = page.AddIncludeDictionary(place);
  figures->SetValue("LABEL", label);
  figures->SetFilename("figures.tpl");
  return *figures;
}

void AddFigure(Dictionary& figures, const Figure& figure) {
  Dictionary* card = figures.AddSectionDictionary("FIGURE");
  card->SetValue("NAME", figure.name);
  card->SetValue("VALUE", figure.value);
  card->SetValue("TONE", figure.tone);
  for (const std::string& detail : figure.details) ShowValue(*card, "DETAIL", "TEXT", detail);
}

std::optional<Figure> DecidingFigureOf(const Verdict& verdict, const VerdictBasis& basis) {
  const DecidingFigure& decided = basis.decided_by;
  if (verdict.level == VerdictLevel::kPass || decided.name.empty()) return std::nullopt;
  Figure figure{decided.name, decided.value, verdict.level == VerdictLevel::kFail ? "fail" : "warn", {}};
  if (!decided.limit.empty()) figure.details.push_back(decided.limit);
  return figure;
}

}  // namespace rigcal::report
