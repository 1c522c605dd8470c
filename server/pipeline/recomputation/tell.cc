#include "server/pipeline/recomputation/tell.h"

#include "server/base/limits.h"
#include "server/formats/answers/recomputation.h"
#include "server/pipeline/robots/decide.h"
#include "storage/revisions/revisions.h"
#include "storage/work/recomputation_result.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

constexpr std::int64_t kRobotsTold = 100;

Result<formats::RecomputedRobotRow> RowOfRecomputed(storage::Store& store, RecomputedRobot done) {
  formats::RecomputedRobotRow row{std::move(done), RevisionState::kUnusable, ""};
  if (row.done.revision == 0) return row;
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(store, row.done.robot, row.done.revision));
  if (!revision) return row;
  RIGCAL_ASSIGN(const Approval approval, LoadApproval(store, *revision));
  row.state = approval.state;
  row.verdict = NameOf(revision->verdict.level);
  return row;
}

Status TakeRows(storage::Store& store, std::int64_t limit, formats::RecomputationAnswer& answer) {
  RIGCAL_ASSIGN(answer.progress, storage::LoadRecomputationProgress(store, answer.run.number));
  RIGCAL_ASSIGN(answer.left, storage::LoadSessionsLeft(store, answer.run.number, limit));
  RIGCAL_ASSIGN(auto robots, storage::LoadRecomputedRobots(store, answer.run.number, limit));
  for (RecomputedRobot& done : robots) {
    RIGCAL_ASSIGN(auto row, RowOfRecomputed(store, std::move(done)));
    answer.robots.push_back(std::move(row));
  }
  return {};
}

}  // namespace

Result<std::string> TellRecomputation(storage::Store& store, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("run", 0));
  RIGCAL_ASSIGN(const std::int64_t limit, parameters.IntegerOr("limit", kRobotsTold));
  if (limit < 0 || limit > limits::kPageRowsMax)
    return Fail(ErrorCode::kInvalidInput, "the parameter 'limit' is out of range", "Ask for 0 to 1000 robots at once.");
  formats::RecomputationAnswer answer;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto run, storage::LoadRecomputation(store, number));
    if (!run)
      return Fail(ErrorCode::kNotFound,
                  number > 0 ? "there is no run " + std::to_string(number) + " of `rigcal resolve`"
                             : "nothing was computed again yet",
                  "`rigcal resolve --all`, `--model M` or `rigcal resolve ROBOT` asks for it.");
    answer.run = *run;
    return TakeRows(store, limit, answer);
  }));
  return formats::WriteRecomputation(answer);
}

}  // namespace rigcal::pipeline
