#include <algorithm>

#include "server/base/text.h"
#include "server/formats/answers/answers.h"
#include "server/formats/answers/parameters.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/answers/lists.h"
#include "server/pipeline/boards/registry.h"
#include "server/pipeline/pages/experiments.h"
#include "server/pipeline/pages/metrics_page.h"
#include "server/pipeline/pages/robot_pages.h"
#include "server/pipeline/rig_models/population.h"
#include "server/pipeline/rig_models/rig_models.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/summaries.h"
#include "server/report/boards/boards_page.h"
#include "server/report/frame/assets.h"
#include "server/report/models/model_pages.h"
#include "server/report/pages/fleet_csv.h"
#include "server/report/pages/site_fleet.h"
#include "server/report/render.h"
#include "storage/boards/measures.h"
#include "storage/fleet/fleet_list.h"
#include "storage/settings/rig_models.h"
#include "storage/sites/forward_queue.h"

namespace rigcal::pipeline {
namespace {

constexpr const char* kHtml = "text/html; charset=utf-8";
constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kJson = "application/json; charset=utf-8";
constexpr const char* kCsv = "text/csv; charset=utf-8";
constexpr const char* kCalendar = "text/calendar; charset=utf-8";

Result<FleetQuery> FleetQueryOf(const std::string& query) {
  RIGCAL_ASSIGN(const auto parameters, ParametersAsked(query));
  FleetQuery asked;
  asked.search = parameters.Text("q").value_or("");
  asked.verdict = parameters.Text("verdict").value_or("");
  asked.sort = parameters.Text("sort").value_or("");
  asked.descending = parameters.Text("order") == "down";
  asked.cause = parameters.Text("cause").value_or("");
  asked.status = parameters.Text("status").value_or("");
  asked.site = parameters.Text("site").value_or("");
  asked.model = parameters.Text("model").value_or("");
  RIGCAL_ASSIGN(const std::int64_t page, parameters.IntegerOr("page", 1));
  asked.page = static_cast<std::size_t>(std::max<std::int64_t>(page, 1));
  return asked;
}

Result<PageText> Fleet(const AnswerContext& context, const std::string& query) {
  RIGCAL_ASSIGN(const FleetQuery asked, FleetQueryOf(query));
  const Stamp now = context.clock.Now();
  static_cast<void>(FreshenSummaries(context.store, context.clock));  // what could not be kept is there soon
  FleetCounts fleet;
  FleetPage list;
  std::int64_t boards = 0;
  std::optional<ForwardState> forward;
  RIGCAL_TRY(context.store.Read([&]() -> Status {
    RIGCAL_ASSIGN(fleet, storage::CountFleet(context.store, now));
    RIGCAL_ASSIGN(list, storage::LoadFleetPage(context.store, asked, now));
    RIGCAL_ASSIGN(boards, storage::CountBoards(context.store));
    RIGCAL_ASSIGN(forward, storage::LoadForwardState(context.store));
    return {};
  }));
  const std::size_t experiments = ListExperiments(context.store.folder()).size();
  RIGCAL_ASSIGN(std::string body,
                report::RenderSiteFleet(fleet, list, now, asked, experiments, static_cast<std::size_t>(boards),
                                        forward.value_or(ForwardState{})));
  return PageText{std::move(body), kHtml};
}

// The whole of what a list shows a page of.
Result<PageText> FleetAsCsv(const AnswerContext& context, const std::string& query) {
  RIGCAL_ASSIGN(const FleetQuery asked, FleetQueryOf(query));
  static_cast<void>(FreshenSummaries(context.store, context.clock));  // what could not be kept is there soon
  std::string text = report::FleetCsvHeading();
  const Stamp now = context.clock.Now();
  const auto add = [&](const RobotSummary& robot) { text += report::FleetCsvRow(robot, now); };
  RIGCAL_TRY(context.store.Read([&] { return storage::ForEachRobot(context.store, asked, now, add); }));
  return PageText{std::move(text), kCsv};
}

Result<PageText> Boards(const AnswerContext& context) {
  RIGCAL_ASSIGN(const auto answer, LoadBoardsAnswer(context.store, context.clock.Now(), {}));
  RIGCAL_ASSIGN(std::string body, report::RenderBoards(answer));
  return PageText{std::move(body), kHtml};
}

Result<PageText> DueAsCalendar(const AnswerContext& context, const std::string& query) {
  RIGCAL_ASSIGN(const auto parameters, ParametersAsked(query));
  RIGCAL_ASSIGN(DueCalendar calendar, MakeDueCalendar(context, parameters));
  return PageText{std::move(calendar.text), kCalendar};
}

Result<PageText> ModelList(const AnswerContext& context) {
  RIGCAL_ASSIGN(const auto rows, LoadRigModelRows(context.store));
  std::vector<report::RigModelLine> lines;
  for (const formats::RigModelRow& row : rows) lines.push_back({row.name, row.version, row.robots});
  RIGCAL_ASSIGN(std::string body, report::RenderRigModels(lines));
  return PageText{std::move(body), kHtml};
}

Result<PageText> ModelPage(const AnswerContext& context, const std::string& model) {
  RIGCAL_ASSIGN(const Population population, LoadPopulation(context.store, model));
  RIGCAL_ASSIGN(const auto set, storage::LoadRigModelVersion(context.store, model));
  RIGCAL_ASSIGN(std::string body, report::RenderRigModel(population, set));
  return PageText{std::move(body), kHtml};
}

// `rest` is what follows "/models/": "" is the list, "NAME/" the page of one. kNotFound for everything else.
Result<PageText> AnswerModelPage(const AnswerContext& context, const std::string& rest) {
  if (rest.empty()) return ModelList(context);
  if (rest.back() == '/') return ModelPage(context, rest.substr(0, rest.size() - 1));
  return Fail(ErrorCode::kNotFound, "there is no page /models/" + Quoted(rest),
              "Start at the list of rig models, /models/.");
}

Result<PageText> Script(const std::string& name) {
  for (const report::Asset& asset : report::Assets())
    if (asset.name == name) return PageText{std::string(asset.bytes), kScript, true};
  return Fail(ErrorCode::kNotFound, "there is no script " + name, "Reload the page: a newer version has other names.");
}

Result<PageText> Api(const AnswerContext& context, const std::string& verb, const std::string& query) {
  RIGCAL_ASSIGN(const std::string json, formats::ParametersOfQuery(query));
  RIGCAL_ASSIGN(std::string body, Answer(context, verb, json));
  return PageText{std::move(body), kJson};
}

PageText Healthz(const AnswerContext& context) {
  const formats::HealthAnswer health = LookAtHealth(context);
  const bool stands_still =
      std::any_of(health.parts.begin(), health.parts.end(), [](const PartState& part) { return part.stands_still; });
  return {formats::WriteHealth(health, context.clock.Now()), kJson, false, stands_still ? 503 : 200};
}

// Whether it can store and answer; if not, one sentence why.
PageText Readyz(const AnswerContext& context) {
  constexpr const char* kText = "text/plain; charset=utf-8";
  const auto problem = LookAtHealth(context).problem();
  return problem ? PageText{Sentence(*problem) + "\n", kText, false, 503} : PageText{"ready\n", kText};
}

}  // namespace

Result<PageText> AnswerPage(const AnswerContext& context, const std::string& path, const std::string& query) {
  const std::string api = "/api/v1/", robots = "/robots/", assets = "/assets/", experiments = "/experiments/",
                    models = "/models/";
  if (path == "/") return Fleet(context, query);
  if (path == "/fleet.csv") return FleetAsCsv(context, query);
  if (path == "/boards/") return Boards(context);
  if (path == "/due.ics") return DueAsCalendar(context, query);
  if (path == "/style.css") return PageText{report::StyleSheet(), "text/css; charset=utf-8"};
  if (path.rfind(assets, 0) == 0) return Script(path.substr(assets.size()));
  if (path == "/healthz") return Healthz(context);
  if (path == "/readyz") return Readyz(context);
  if (path == "/metrics") return AnswerMetrics(context);
  if (path.rfind(api, 0) == 0) return Api(context, path.substr(api.size()), query);
  if (path.rfind(robots, 0) == 0) return AnswerRobotPage(context, path.substr(robots.size()), query);
  if (path.rfind(models, 0) == 0) return AnswerModelPage(context, path.substr(models.size()));
  if (path.rfind(experiments, 0) == 0) return AnswerExperiments(context, path.substr(experiments.size()));
  return Fail(ErrorCode::kNotFound, "there is no page " + path, "Start at the list of robots.");
}

}  // namespace rigcal::pipeline
