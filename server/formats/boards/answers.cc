#include "server/formats/boards/answers.h"

#include <algorithm>

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

void WriteOptionalNumber(JsonWriter& out, const char* key, const std::optional<double>& value) {
  value ? out.Number(key, *value) : out.Null(key);
}

// A day, as it was given.
void WriteDay(JsonWriter& out, const char* key, const std::optional<Stamp>& day) {
  day ? out.Text(key, ToIso(*day).substr(0, 10)) : out.Null(key);
}

// Counts as session.yaml has them.
void WritePatternMembers(JsonWriter& out, const BoardPattern& pattern) {
  const TypedCounts counts = TypedCountsOf(pattern);
  out.Text("type", NameOf(pattern.kind));
  out.Integer("cols", counts.cols);
  out.Integer("rows", counts.rows);
  out.Text("counts", counts.of);
  out.Number("square_m", pattern.square_m);
}

void WriteMeasureMembers(JsonWriter& out, const BoardMeasure& measure) {
  const BoardSize size = SizeOf(measure);
  WritePatternMembers(out, measure.pattern);
  out.Object("size", [&] {
    out.Number("x_m", size.x_m);
    out.Number("y_m", size.y_m);
    out.Number("sigma_x_m", size.sigma_x_m);
    out.Number("sigma_y_m", size.sigma_y_m);
  });
  out.Number("length_x_m", measure.length_x_m);
  out.Number("length_y_m", measure.length_y_m);
  out.Number("measured_x_m", measure.measured_x_m);
  out.Number("measured_y_m", measure.measured_y_m);
  out.Number("sigma_m", measure.sigma_m);
  out.Flag("sigma_assumed", measure.sigma_is_assumed);
  WriteOptionalNumber(out, "flatness_m", measure.flatness_m);
  WriteDay(out, "next_check", measure.next_check_at);
  WriteStamp(out, "measured_at", measure.word.at);
  out.Text("who", measure.word.who);
  out.Text("reason", measure.word.reason);
}

void WriteBoardMembers(JsonWriter& out, const BoardRow& row) {
  out.Text("serial", row.measure.serial);
  WriteMeasureMembers(out, row.measure);
  out.Flag("check_due", row.check_due);
  out.Integer("sessions", row.sessions);
}

void WriteTraceCounts(JsonWriter& out, const BoardTrace& trace) {
  out.Integer("robots", static_cast<std::int64_t>(trace.robots.size()));
  out.Integer("revisions", static_cast<std::int64_t>(trace.revisions()));
  out.Integer("sessions", static_cast<std::int64_t>(trace.sessions()));
}

void WriteTracedRobot(JsonWriter& out, const TracedRobot& robot, std::size_t sessions) {
  out.Text("robot", robot.robot.str());
  out.List("revisions", [&] {
    for (const int revision : robot.revisions) out.Integer(revision);
  });
  out.Integer("sessions_total", static_cast<std::int64_t>(robot.sessions.size()));
  out.List("sessions", [&] {
    for (std::size_t idx = robot.sessions.size() - sessions; idx < robot.sessions.size(); ++idx)
      out.Object([&] {
        const TracedSession& session = robot.sessions[idx];
        out.Text("session", session.session.str());
        WriteStamp(out, "captured_at", session.captured_at);
        out.Flag("counts", session.counts);
      });
  });
}

}  // namespace

std::string WriteBoards(const BoardsAnswer& answer) {
  return WriteObject([&](JsonWriter& out) {
    out.List("boards", [&] {
      for (const BoardRow& row : answer.boards) out.Object([&] { WriteBoardMembers(out, row); });
    });
    out.List("unregistered", [&] {
      for (const UnregisteredBoard& board : answer.unregistered)
        out.Object([&] {
          out.Text("serial", board.serial);
          WritePatternMembers(out, board.pattern);
          out.Integer("sessions", board.sessions);
        });
    });
    answer.next.empty() ? out.Null("next") : out.Text("next", answer.next);
  });
}

std::string WriteBoard(const BoardRow& row, const std::vector<BoardMeasure>& history) {
  return WriteObject([&](JsonWriter& out) {
    out.Object("board", [&] { WriteBoardMembers(out, row); });
    out.List("history", [&] {
      for (const BoardMeasure& measure : history) out.Object([&] { WriteMeasureMembers(out, measure); });
    });
  });
}

std::string WriteBoardTrace(const std::string& serial, const BoardTrace& trace, std::size_t sessions_max) {
  std::size_t left = sessions_max;
  return WriteObject([&](JsonWriter& out) {
    out.Text("serial", serial);
    out.Object("totals", [&] { WriteTraceCounts(out, trace); });
    out.List("robots", [&] {
      for (const TracedRobot& robot : trace.robots) {
        const std::size_t listed = std::min(left, robot.sessions.size());
        left -= listed;
        out.Object([&] { WriteTracedRobot(out, robot, listed); });
      }
    });
    out.Flag("more", trace.sessions() > sessions_max);
  });
}

std::string WriteBoardMeasured(const BoardRow& row, const std::optional<BoardMeasure>& before,
                               const BoardTrace& trace) {
  return WriteObject([&](JsonWriter& out) {
    out.Object("board", [&] { WriteBoardMembers(out, row); });
    if (before)
      out.Object("before", [&] { WriteMeasureMembers(out, *before); });
    else
      out.Null("before");
    out.Flag("size_changed", before && !IsSameSize(*before, row.measure));
    out.Object("depends", [&] { WriteTraceCounts(out, trace); });
  });
}

void WriteBoardRemarks(JsonWriter& out, const std::vector<BoardRemark>& remarks) {
  out.List("board_remarks", [&] {
    for (const BoardRemark& remark : remarks)
      out.Object([&] {
        out.Text("session", remark.session.str());
        out.Text("target", remark.target.str());
        out.Text("serial", remark.serial);
        out.Text("code", remark.code);
        out.Text("level", remark.is_warning ? "warn" : "mark");
        out.Text("what", remark.what);
        out.Text("cure", remark.cure);
      });
  });
}

}  // namespace rigcal::formats
