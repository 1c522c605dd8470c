#include "server/report/pages/work_lists.h"

#include <algorithm>
#include <array>

#include "server/report/text/cause_words.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

std::string RobotsText(std::int64_t robots) { return Count(static_cast<std::size_t>(robots), "robot", "robots"); }

void FillByCause(Dictionary& work, const std::vector<CauseCount>& causes) {
  if (causes.empty()) return;
  Dictionary* list = work.AddSectionDictionary("CAUSES");
  for (std::size_t i = 0; i < std::min(causes.size(), kCausesListedMax); ++i) {
    Dictionary* item = list->AddSectionDictionary("ITEM");
    item->SetValue("KEY", InAddress(causes[i].key));
    item->SetValue("TEXT", CauseText(causes[i].key));
    item->SetValue("ROBOTS", RobotsText(causes[i].robots));
  }
  if (causes.size() > kCausesListedMax) list->ShowSection("MORE");
}

void FillByWeek(Dictionary& work, const FleetCounts& fleet) {
  struct Due {
    const char *value, *text;
    std::int64_t robots;
  };
  for (const Due& due :
       std::array{Due{"not_calibrated", "not calibrated", fleet.not_calibrated},
                  Due{"overdue", "overdue", fleet.overdue}, Due{"this_week", "due this week", fleet.due_this_week},
                  Due{"next_week", "due next week", fleet.due_next_week}, Due{"later", "due later", fleet.due_later}}) {
    if (due.robots == 0) continue;
    Dictionary* item = work.AddSectionDictionary("ITEM");
    item->SetValue("VALUE", due.value);
    item->SetValue("TEXT", due.text);
    item->SetValue("ROBOTS", RobotsText(due.robots));
  }
}

// Each leads to the robots of the model that are to be looked at.
void FillByModel(Dictionary& work, const std::vector<ModelCount>& models) {
  Dictionary* list = nullptr;
  std::size_t listed = 0;
  for (const ModelCount& model : models) {
    if (model.with_work == 0 || listed++ == kModelsListedMax) break;
    if (list == nullptr) list = work.AddSectionDictionary("MODELS");
    Dictionary* item = list->AddSectionDictionary("ITEM");
    item->SetValue("KEY", InAddress(model.rig_model));
    item->SetValue("TEXT", model.rig_model);
    item->SetValue("ROBOTS", std::to_string(model.with_work) + " of " + RobotsText(model.robots));
  }
}

// Those that are all right are no work.
void FillByStatus(Dictionary& work, const std::map<StatusWord, std::int64_t>& statuses) {
  Dictionary* list = nullptr;
  for (const auto& [word, robots] : statuses) {
    if (robots == 0 || word == StatusWord::kOk) continue;
    if (list == nullptr) list = work.AddSectionDictionary("STATUSES");
    Dictionary* item = list->AddSectionDictionary("ITEM");
    item->SetValue("VALUE", NameOf(word));
    item->SetValue("ROBOTS", RobotsText(robots));
  }
}

}  // namespace

void FillWorkLists(Dictionary& page, const FleetCounts& fleet) {
  const std::int64_t due =
      fleet.not_calibrated + fleet.overdue + fleet.due_this_week + fleet.due_next_week + fleet.due_later;
  if (fleet.causes.empty() && due == 0) return;
  Dictionary* work = page.AddSectionDictionary("WORK");
  FillByCause(*work, fleet.causes);
  FillByModel(*work, fleet.models);
  FillByStatus(*work, fleet.statuses);
  if (due > 0) FillByWeek(*work->AddSectionDictionary("WEEKS"), fleet);
}

}  // namespace rigcal::report
