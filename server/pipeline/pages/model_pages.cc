#include "server/pipeline/pages/model_pages.h"

#include "server/base/text.h"
#include "server/pipeline/rig_models/population.h"
#include "server/pipeline/rig_models/rig_models.h"
#include "server/report/models/model_pages.h"
#include "storage/settings/rig_models.h"

namespace rigcal::pipeline {
namespace {

constexpr const char* kModelPageType = "text/html; charset=utf-8";

Result<PageText> ModelList(const AnswerContext& context) {
  RIGCAL_ASSIGN(const auto rows, LoadRigModelRows(context.store));
  std::vector<report::RigModelLine> lines;
  for (const formats::RigModelRow& row : rows) lines.push_back({row.name, row.version, row.robots});
  RIGCAL_ASSIGN(std::string body, report::RenderRigModels(lines));
  return PageText{std::move(body), kModelPageType};
}

Result<PageText> ModelPage(const AnswerContext& context, const std::string& model) {
  RIGCAL_ASSIGN(const Population population, LoadPopulation(context.store, model));
  RIGCAL_ASSIGN(const auto set, storage::LoadRigModelVersion(context.store, model));
  RIGCAL_ASSIGN(std::string body, report::RenderRigModel(population, set));
  return PageText{std::move(body), kModelPageType};
}

}  // namespace

Result<PageText> AnswerModelPage(const AnswerContext& context, const std::string& rest) {
  if (rest.empty()) return ModelList(context);
  if (rest.back() == '/') return ModelPage(context, rest.substr(0, rest.size() - 1));
  return Fail(ErrorCode::kNotFound, "there is no page /models/" + Quoted(rest),
              "Start at the list of rig models, /models/.");
}

}  // namespace rigcal::pipeline
