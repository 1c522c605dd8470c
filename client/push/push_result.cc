#include "client/push/push_result.h"

#include <algorithm>

#include "client/text/approval_text.h"
#include "client/text/cause_list.h"
#include "client/text/edge_table.h"
#include "client/text/table.h"
#include "client/verb.h"

namespace rigcal::client {
namespace {

constexpr std::size_t kEdgesPrintedMax = 40;

std::string AddressOf(const Awaited& awaited) {
  return ReportAddress(awaited.status, awaited.show["robot"].Text(), awaited.show["revision"].Integer().value_or(0));
}

// Whatever older sessions of the robot say.
bool CalibratedNothing(const Awaited& awaited) { return awaited.failed_pairs > 0 && awaited.good_pairs == 0; }

// A good edge of another session, or one that was pushed.
bool KnowsOlder(const Awaited& awaited) {
  const auto edges = awaited.show["document"]["edges"].Items();
  return std::any_of(edges.begin(), edges.end(), [](const Document& edge) { return edge["state"].Text() == "good"; });
}

void PrintAddress(const Awaited& awaited, const std::string& robot, std::ostream& out) {
  const std::string address = AddressOf(awaited);
  out << "report  " << (address.empty() ? "`rigcal report " + robot + "` tells where it is" : address)
      << (awaited.report_is_drawn ? "\n" : "  (still being drawn: the page comes by itself)\n");
}

}  // namespace

PushSummary SummaryOf(const PushEngine& engine, std::string kind, std::string robot, std::string id,
                      std::size_t items) {
  const PushCounts& counts = engine.chunks().counts();
  return {std::move(kind),    std::move(robot),           std::move(id),     items,
          counts.total_bytes, counts.held_at_first_bytes, engine.restarts(), 0};
}

void PrintResult(const Awaited& awaited, std::ostream& out) {
  if (!awaited.has_revision) {
    out << "Stored. It has no two sensors that this version can calibrate against each other, so there is no result.\n";
    return;
  }
  const Document revision = awaited.show["document"];
  const std::string robot = Plain(awaited.show["robot"].Text("?"));
  out << '\n';
  if (CalibratedNothing(awaited))
    out << "Nothing of this session could be calibrated (" << awaited.failed_pairs
        << (awaited.failed_pairs == 1 ? " pair" : " pairs")
        << (KnowsOlder(awaited) ? "): what follows is what older ones of the robot know.\n" : ").\n");
  PrintDrive(awaited.show, out);
  out << robot << ", revision " << CountOf(awaited.show["revision"]) << '\n';
  PrintVerdict(revision["verdict"], awaited.show, out);
  PrintApproval(awaited.show, out);
  PrintGlobalError(revision, out);
  const auto edges = revision["edges"].Items();
  const auto past = static_cast<std::size_t>(std::count_if(edges.begin(), edges.end(), IsPast));
  if (edges.size() <= kEdgesPrintedMax)
    PrintEdgesByCause(revision["causes"], edges, out);
  else
    out << edges.size() - past << " edges" << (past > 0 ? " and " + std::to_string(past) + " past ones" : "")
        << "; `rigcal edges " << robot << "` lists them\n";
  PrintAddress(awaited, robot, out);
}

ExitCode JudgeResult(const Awaited& awaited) {
  if (!awaited.has_revision) return ExitCode::kVerdictUnknown;
  const ExitCode code = JudgeMeasured(awaited.show["document"]["verdict"], awaited.show);
  return code == ExitCode::kGood && CalibratedNothing(awaited) ? ExitCode::kVerdictWarn : code;
}

std::string ResultJson(const PushSummary& summary, const Awaited* awaited) {
  const bool has_revision = awaited != nullptr && awaited->has_revision;
  const auto total = static_cast<std::int64_t>(summary.total);
  std::vector<Field> fields = {{"held_before", summary.held_before},
                               {"id", summary.id},
                               {"items", static_cast<std::int64_t>(summary.items)},
                               {"kind", summary.kind},
                               Field::Raw("report", "null"),
                               {"robot", summary.robot},
                               {"server_restarts", std::int64_t{summary.restarts}},
                               Field::Raw("session", awaited == nullptr ? "null" : awaited->session.Dump()),
                               Field::Raw("show", has_revision ? awaited->show_text : "null"),
                               {"state", "closed"},
                               {"total", total},
                               {"transfer_ns", summary.transfer_ns},
                               {"unit", summary.kind == "session" ? "bytes" : "edges"}};
  if (has_revision) fields[4] = Field("report", AddressOf(*awaited));
  return JsonObject(fields);
}

}  // namespace rigcal::client
