#include "server/report/frame/retired_section.h"

#include "server/model/edges/merged_edge.h"
#include "server/model/edges/past.h"

namespace rigcal::report {

void FillGone(Dictionary& page, const RobotId& robot, const std::vector<RetiredSensor>& gone) {
  for (const RetiredSensor& one : gone) {
    Dictionary* row = page.AddSectionDictionary("GONE");
    row->SetValue("WHY", RetiredText(one));
    row->SetValue("COMMAND", RestoreCommand(robot, one.sensor));
  }
}

bool HasWayOut(const Edge& edge) { return !IsMerged(edge) && !IsPast(edge); }

void FillRetire(Dictionary& row, const std::string& command) { ShowValue(row, "RETIRE", "COMMAND", command); }

}  // namespace rigcal::report
