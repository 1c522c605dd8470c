#include "storage/fleet/fleet_list.h"

#include <algorithm>

#include "storage/fleet/fleet_sql.h"
#include "storage/fleet/summary_row.h"
#include "storage/fleet/summary_text.h"

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

}  // namespace rigcal::storage
