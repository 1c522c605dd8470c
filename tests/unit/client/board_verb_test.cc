// `rigcal board` against a server in memory: what is asked, what is printed.
#include <gtest/gtest.h>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

constexpr const char* kBoard =
    R"("serial":"B-7","type":"charuco","cols":11,"rows":8,"counts":"squares","square_m":0.03,"size":{"x_m":0.02985,"y_m":0.03,)"
    R"("sigma_x_m":2e-05,"sigma_y_m":3e-05},"sigma_assumed":true,"flatness_m":0.0004,"measured_at":"2026-11-03T12:00:00Z",)"
    R"("who":"Ada","reason":"","next_check":"2027-05-31","check_due":false,"sessions":3)";

TEST(BoardVerb, MeasureAsksInMetresAndSaysWhatDependsOnIt) {
  std::string asked;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + " " + json;
    return std::string(R"({"board":{)") + kBoard +
           R"(},"before":{"size":{"x_m":0.03,"y_m":0.03}},"size_changed":true,)" +
           R"("depends":{"sessions":3,"revisions":2,"robots":1}})";
  });
  const Ran ran =
      Rigcal({"board",  "measure", "B-7",         "--type",       "charuco",      "--cols",     "11",
              "--rows", "8",       "--square-mm", "30",           "--ruler-x-mm", "199",        "--ruler-y-mm",
              "99.9",   "--by",    "Ada",         "--next-check", "2027-05-31",   "--sigma-mm", "0.1"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(asked, R"(measure_board {"serial":"B-7","who":"Ada","type":"charuco","cols":11,"rows":8,"square_m":"0.03",)"
                   R"("measured_x_m":"0.199","measured_y_m":"0.0999","sigma_m":"1e-04","next_check":"2027-05-31"})");
  EXPECT_EQ(ran.out,
            "Board B-7, a charuco of 11 x 8 squares, 30 mm: its squares measure 29.850 x 30.000 mm (sigma 0.030 "
            "assumed), by Ada.\n"
            "Next check: 2027-05-31.\nBefore, they measured 30.000 x 30.000 mm.\n"
            "3 sessions, 2 revisions and 1 robot depend on it, and stay as they are: `rigcal board trace B-7` lists "
            "them, `rigcal resolve --board B-7` computes them again.\n");
  Rigcal(
      {"board", "measure", "B-7", "--ruler-x-mm", "300", "--ruler-y-mm", "299", "--nominal-mm", "300", "--by", "Ada"});
  EXPECT_EQ(
      asked,
      R"(measure_board {"serial":"B-7","who":"Ada","measured_x_m":"0.3","measured_y_m":"0.299","length_x_m":"0.3","length_y_m":"0.3"})");
  EXPECT_EQ(Rigcal({"board", "measure", "B-7", "--ruler-x-mm", "300"}).code, 2);
  EXPECT_EQ(Rigcal({"board", "measure", "--ruler-x-mm", "300", "--ruler-y-mm", "299"}).code, 2);
  EXPECT_EQ(Rigcal({"board", "burn", "B-7"}).code, 2);
}

TEST(BoardVerb, ListShowAndTrace) {
  FakeServer server("r", [&](const std::string& verb, const std::string&) -> Result<std::string> {
    if (verb == "boards")
      return std::string(R"({"boards":[{)") + kBoard +
             R"(}],"unregistered":[{"serial":"C-1","type":"april_grid","cols":6,"rows":6,)" +
             R"("counts":"tags","square_m":0.088,"sessions":1}],"next":null})";
    if (verb == "board") return std::string(R"({"board":{)") + kBoard + R"(},"history":[{)" + kBoard + "}]}";
    return R"({"serial":"B-7","totals":{"sessions":2,"revisions":4,"robots":1},"more":false,"robots":[{"robot":"r","revisions":[2,3,4,7],)"
           R"("sessions_total":2,"sessions":[{"session":"aaaaaaaaaaaaaaaaaaaaaaaa","captured_at":"2026-11-03T12:00:00Z","counts":true},)"
           R"({"session":"bbbbbbbbbbbbbbbbbbbbbbbb","captured_at":"2026-11-04T12:00:00Z","counts":false}]}]})";
  });
  const std::string list = Rigcal({"board", "list"}).out;
  EXPECT_NE(list.find("charuco of 11 x 8 squares, 30 mm  29.850 x 30.000"), std::string::npos) << list;
  EXPECT_NE(list.find("Not in the registry: C-1, a april_grid of 6 x 6 tags, 88 mm, in 1 session\n"), std::string::npos)
      << list;
  const std::string show = Rigcal({"board", "show", "B-7"}).out;
  EXPECT_NE(show.find("B-7, a charuco of 11 x 8 squares, 30 mm, in 3 sessions\n"), std::string::npos) << show;
  const std::string trace = Rigcal({"board", "trace", "B-7"}).out;
  EXPECT_NE(trace.find("On board B-7 depend 2 sessions, 4 revisions and 1 robot.\n"), std::string::npos) << trace;
  EXPECT_NE(trace.find("a session whose sensors did not see it is among them"), std::string::npos) << trace;
  EXPECT_NE(trace.find("2 to 4, 7"), std::string::npos) << trace;
  EXPECT_NE(trace.find("bbbbbbbbbbbbbbbb  2026-11-04T12:00:00Z  no"), std::string::npos) << trace;
}

TEST(BoardVerb, ShowOfARobotTellsEachRemarkOnce) {
  FakeServer server("r", [&](const std::string&, const std::string&) -> Result<std::string> {
    return R"({"robot":"r","revision":1,"board_remarks":[{"session":"a","level":"mark","what":"board B-7 is not in the registry","cure":"Measure it."},)"
           R"({"session":"b","level":"mark","what":"board B-7 is not in the registry","cure":"Measure it."}],)"
           R"("document":{"robot":"r","verdict":{"level":"pass","why":"all agree"}}})";
  });
  const std::string shown = Rigcal({"show", "r"}).out;
  EXPECT_NE(shown.find("Note: board B-7 is not in the registry (2 sessions). Measure it.\n"), std::string::npos)
      << shown;
}

TEST(BoardVerb, EmptyAndForeignDocumentsAreTaken) {
  for (const char* text :
       {"{}",
        R"({"boards":[null],"unregistered":[7],"board":[],"history":{},"robots":[{}],"totals":"x","depends":3})"}) {
    FakeServer server("r", Always(text));
    EXPECT_EQ(Rigcal({"board", "list"}).code, 0);
    EXPECT_EQ(Rigcal({"board", "show", "B-7"}).code, 0);
    EXPECT_EQ(Rigcal({"board", "trace", "B-7"}).code, 0);
    EXPECT_EQ(Rigcal({"board", "measure", "B-7", "--ruler-x-mm", "1", "--ruler-y-mm", "1"}).code, 0);
  }
}

}  // namespace
}  // namespace rigcal::client
