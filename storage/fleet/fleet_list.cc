#include "storage/fleet/fleet_list.h"

#include <algorithm>
#include <tuple>

#include "storage/fleet/fleet_sql.h"
#include "storage/fleet/robot_status.h"
#include "storage/fleet/summary_row.h"

namespace rigcal::storage {
namespace {

// The robots that are asked for.
class Matches {
 public:
  Matches(Store& store, const FleetQuery& asked, Stamp now)
      : store_(store), asked_(asked), now_(now), words_(SearchWordsOf(asked.search)) {}

  std::size_t Count() {
    Query query(store_, "SELECT count(*) " + MatchesSql(words_));
    BindMatches(query, asked_, words_, now_);
    return query.Step() ? static_cast<std::size_t>(query.Int(0)) : 0;
  }

  std::vector<std::int64_t> Numbers(std::int64_t max, std::size_t skipped) {
    Query query(store_, "SELECT number " + MatchesSql(words_) + OrderSql(asked_) + " LIMIT ? OFFSET ?");
    BindMatches(query, asked_, words_, now_);
    query.Bind(max, skipped);
    std::vector<std::int64_t> numbers;
    while (query.Step()) numbers.push_back(query.Int(0));
    return numbers;
  }

 private:
  Store& store_;
  const FleetQuery& asked_;
  Stamp now_;
  std::vector<std::string> words_;
};

std::optional<RobotSummary> LoadRow(Store& store, std::int64_t number, Stamp now) {
  Query query(store, std::string("SELECT ") + kSummaryColumns + " FROM summary_robot WHERE number = ?");
  return query.Bind(number).Step() ? std::optional(SummaryOf(query, now)) : std::nullopt;
}

std::map<DriveKind, std::int64_t> CountKinds(Store& store, Stamp now) {
  Query query(store, "SELECT " + DriveKindSql() + " AS kind, count(*) FROM summary_robot GROUP BY kind");
  query.Bind(now);
  std::map<DriveKind, std::int64_t> kinds;
  while (query.Step())
    if (const auto kind = DriveKindOf(query.Text(0))) kinds[*kind] = query.Int(1);
  return kinds;
}

// Each row's status is worked out once.
std::map<StatusWord, std::int64_t> CountStatuses(Store& store, Stamp now) {
  Query query(store, "SELECT " + StatusSql() + " AS word, count(*) FROM summary_robot GROUP BY word");
  query.Bind(now);
  std::map<StatusWord, std::int64_t> statuses;
  for (const StatusWord word : kStatusWords) statuses[word] = 0;
  while (query.Step()) statuses[StatusWordOf(query.Text(0))] = query.Int(1);
  return statuses;
}

std::vector<ModelCount> CountByModel(Store& store, Stamp now) {
  Query query(store, "SELECT rig_model, count(*), count(*) FILTER (WHERE " + HasWorkSql() +
                         ") FROM summary_robot GROUP BY rig_model");
  query.Bind(now);
  std::vector<ModelCount> models;
  while (query.Step())
    if (!query.Text(0).empty()) models.push_back({query.Text(0), query.Int(1), query.Int(2)});
  return models;
}

// The most work first, then the most robots.
std::vector<ModelCount> FirstModels(std::vector<ModelCount> models) {
  const auto before = [](const ModelCount& a, const ModelCount& b) {
    return std::tie(b.with_work, b.robots, a.rig_model) < std::tie(a.with_work, a.robots, b.rig_model);
  };
  std::sort(models.begin(), models.end(), before);
  if (models.size() > kModelsListedMax + 1) models.resize(kModelsListedMax + 1);
  return models;
}

}  // namespace

Result<FleetPage> LoadFleetPage(Store& store, const FleetQuery& asked, Stamp now) {
  return Load<FleetPage>(store, "list of robots", [&]() -> Result<FleetPage> {
    Matches matches(store, asked, now);
    FleetPage page;
    page.matches = matches.Count();
    page.pages = std::max<std::size_t>(1, (page.matches + kFleetRowsMax - 1) / kFleetRowsMax);
    page.page = std::clamp<std::size_t>(asked.page, 1, page.pages);
    for (const std::int64_t number : matches.Numbers(kFleetRowsMax, (page.page - 1) * kFleetRowsMax))
      if (auto row = LoadRow(store, number, now)) page.rows.push_back(std::move(*row));
    return page;
  });
}

Status ForEachRobot(Store& store, const FleetQuery& asked, Stamp now,
                    const std::function<void(const RobotSummary&)>& take) {
  return store.connection().Load("list of robots", [&]() -> Status {
    for (const std::int64_t number : Matches(store, asked, now).Numbers(kAllRows, 0))
      if (const auto row = LoadRow(store, number, now)) take(*row);
    return {};
  });
}

Result<FleetCounts> CountFleet(Store& store, Stamp now) {
  return Load<FleetCounts>(store, "counts of all robots", [&]() -> Result<FleetCounts> {
    Query query(store, "SELECT count(*), count(*) FILTER (WHERE " + kIsOverdue +
                           "), CAST(coalesce(sum(sessions), 0) AS BIGINT), CAST(coalesce(sum(edges), 0) AS BIGINT), "
                           "CAST(coalesce(sum(jobs_waiting), 0) AS BIGINT), "
                           "count(*) FILTER (WHERE verdict = 'fail'), count(*) FILTER (WHERE verdict = 'unknown'), "
                           "count(*) FILTER (WHERE verdict = 'warn'), count(*) FILTER (WHERE verdict = 'pass'), "
                           "count(*) FILTER (WHERE " +
                           kIsDueThisWeek + "), count(*) FILTER (WHERE " + kIsDueNextWeek +
                           "), count(*) FILTER (WHERE " + kIsDueLater +
                           "), count(*) FILTER (WHERE site <> ''), "
                           "count(*) FILTER (WHERE operator_name <> ''), count(*) FILTER (WHERE " +
                           kIsNotCalibrated + ") FROM summary_robot");
    FleetCounts counts;
    BindDue(query, now);
    if (!query.Step()) return counts;
    counts.robots = query.Int(0);
    counts.overdue = query.Int(1);
    counts.sessions = query.Int(2);
    counts.edges = query.Int(3);
    counts.jobs_waiting = query.Int(4);
    counts.verdicts = {{VerdictLevel::kFail, query.Int(5)},
                       {VerdictLevel::kUnknown, query.Int(6)},
                       {VerdictLevel::kWarn, query.Int(7)},
                       {VerdictLevel::kPass, query.Int(8)}};
    counts.due_this_week = query.Int(9);
    counts.due_next_week = query.Int(10);
    counts.due_later = query.Int(11);
    counts.kinds = CountKinds(store, now);
    counts.with_site = query.Int(12);
    counts.with_operator = query.Int(13);
    counts.not_calibrated = query.Int(14);
    counts.statuses = CountStatuses(store, now);
    counts.models = FirstModels(CountByModel(store, now));
    RIGCAL_ASSIGN(counts.causes, LoadCauseCounts(store, kCausesListedMax + 1));
    return counts;
  });
}

Result<std::vector<CauseCount>> LoadCauseCounts(Store& store, std::size_t max) {
  using Counts = std::vector<CauseCount>;
  return Load<Counts>(store, "causes that robots have in common", [&]() -> Result<Counts> {
    Query query(
        store,
        "SELECT cause_key, robots FROM summary_cause_count WHERE robots > 0 ORDER BY robots DESC, cause_key LIMIT ?");
    query.Bind(max);
    Counts counts;
    while (query.Step()) counts.push_back({query.Text(0), query.Int(1)});
    return counts;
  });
}

Result<FleetSize> LoadFleetSize(Store& store) {
  return Load<FleetSize>(store, "size of the fleet", [&]() -> Result<FleetSize> {
    Query query(store,
                "SELECT robots, sessions, edges, (SELECT count(*) FROM waiting_job) + (SELECT count(*) FROM "
                "waiting_revision) + "
                "(SELECT count(*) FROM waiting_verdict) + (SELECT count(*) FROM waiting_rig_model) + "
                "(SELECT count(*) FROM waiting_merge_anew) + (SELECT count(*) FROM waiting_publication) "
                "FROM summary_fleet WHERE only_row = 1");
    if (!query.Step()) return FleetSize{};
    return FleetSize{query.Int(0), query.Int(1), query.Int(2), query.Int(3)};
  });
}

}  // namespace rigcal::storage
