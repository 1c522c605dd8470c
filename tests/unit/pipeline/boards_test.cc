// The order that enters a measure, what is told of boards, and where a session's board is spoken of.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/reports/report_input.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class BoardOrderTest : public PipelineTest {
 protected:
  static json First() {
    return {{"serial", "B-7"},       {"type", "checkerboard"}, {"cols", 9},   {"rows", 6}, {"square_m", "0.025"},
            {"measured_x_m", "0.2"}, {"measured_y_m", "0.2"},  {"who", "Ada"}};
  }
  Result<json> Measure(const json& parameters) {
    RIGCAL_ASSIGN(const OrderDone done, CarryOut(*store_, clock_, "measure_board", parameters.dump()));
    return json::parse(done.document);
  }
  std::string Refused(json changes) {
    json parameters = First();
    parameters.update(changes);
    const auto done = Measure(parameters);
    return done ? "taken" : Sentence(done.error());
  }
  Result<json> Ask(const std::string& verb, const json& parameters) {
    RevisionCache revisions;
    RIGCAL_ASSIGN(const std::string answer, Answer({*store_, clock_, revisions, {}, ""}, verb, parameters.dump()));
    return json::parse(answer);
  }
  std::string Page(const std::string& path) {
    RevisionCache revisions;
    const auto page = AnswerPage({*store_, clock_, revisions, {}, ""}, path, "");
    EXPECT_TRUE(page) << (page ? "" : Sentence(page.error()));
    return page ? page->body : "";
  }
  SessionId Push(const std::string& serial, double square_m = 0.025) {
    Manifest manifest;
    manifest.header.robot = RobotId("r");
    manifest.header.captured_at = clock_.now;
    manifest.header.reference = SensorId("left");
    Target board;
    board.id = TargetId("board"), board.cols = 9, board.rows = 6, board.square_m = square_m, board.serial = serial;
    manifest.header.targets = {board};
    for (const char* name : {"left", "right"}) manifest.header.sensors.emplace_back().id = SensorId(name);
    AddFile("left/01.png", "no picture " + serial, manifest);
    AddFile("right/01.png", "nor this " + serial, manifest);
    return Close(manifest);
  }
};

TEST_F(BoardOrderTest, ABoardIsNamedOnceAndMeasuredOften) {
  json later = {{"serial", "B-7"},     {"measured_x_m", "0.199"}, {"measured_y_m", "0.1"},     {"who", "Bob"},
                {"sigma_m", "0.0001"}, {"flatness_m", "0.0003"},  {"next_check", "2027-05-31"}};
  const auto unknown = Measure(later);
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().what, HasSubstr("not in the registry yet"));
  const json first = Measure(First()).value();
  EXPECT_EQ(first["before"], nullptr);
  EXPECT_EQ(first["size_changed"], false);
  EXPECT_EQ(first["board"]["sigma_assumed"], true);
  const json second = Measure(later).value();
  EXPECT_EQ(second["size_changed"], true);
  EXPECT_EQ(second["before"]["size"]["x_m"], 0.025);
  EXPECT_NEAR(second["board"]["size"]["x_m"].get<double>(), 0.024875, 1e-12);
  EXPECT_EQ(second["board"]["length_y_m"], 0.1) << "the nearest 100 mm";
  EXPECT_EQ(second["board"]["next_check"], "2027-05-31");
  EXPECT_EQ(Ask("board", {{"serial", "B-7"}}).value()["history"].size(), 2U);
  EXPECT_EQ(Ask("boards", json::object()).value()["boards"][0]["who"], "Bob");
}

TEST_F(BoardOrderTest, RefusesWhatCannotBeMeant) {
  EXPECT_THAT(Refused({{"measured_x_m", "0.02"}}), HasSubstr("more than 5 %"));
  EXPECT_THAT(Refused({{"measured_x_m", "nan"}}), HasSubstr("is no number"));
  EXPECT_THAT(Refused({{"measured_x_m", "0.2x"}}), HasSubstr("is no number"));
  EXPECT_THAT(Refused({{"next_check", "soon"}}), HasSubstr("is no day of a next check"));
  EXPECT_THAT(Refused({{"next_check", "2020-01-01"}}), HasSubstr("is not in the future"));
  EXPECT_THAT(Refused({{"type", "circles"}}), HasSubstr("not known"));
  EXPECT_THAT(Refused({{"cols", 0}}), HasSubstr("no count"));
  EXPECT_THAT(Refused({{"who", " "}}), HasSubstr("who"));
  ASSERT_TRUE(Measure(First()));
  EXPECT_THAT(Refused({{"cols", 8}}), HasSubstr("in the registry, and not a"));
  EXPECT_EQ(Refused({{"cols", 8}, {"redefine", true}}), "taken");
}

TEST_F(BoardOrderTest, SessionsAreMarkedWhereverTheyAreShown) {
  const SessionId session = Push("B-7", 0.0255);
  const std::string page = "/robots/r/sessions/" + session.str() + "/";
  EXPECT_EQ(Ask("session", {{"id", session.str()}}).value()["board_remarks"][0]["code"], "unknown_serial");
  EXPECT_THAT(Page(page), HasSubstr("board B-7 is not in the registry"));
  EXPECT_THAT(Page("/boards/"), HasSubstr("Not in the registry"));
  EXPECT_EQ(Ask("board", {{"serial", "B-7"}}).error().code, ErrorCode::kNotFound);
  const json done = Measure(First()).value();
  EXPECT_EQ(done["depends"]["sessions"], 1);
  EXPECT_EQ(Ask("session", {{"id", session.str()}}).value()["board_remarks"][0]["code"], "other_size");
  EXPECT_THAT(Page(page),
              HasSubstr("is 25.5 mm in the session (taken as exact), and was measured to be 25 mm along x by Ada"));
  EXPECT_THAT(Page("/boards/"), Not(HasSubstr("Not in the registry")));
  EXPECT_THAT(Page("/boards/"), HasSubstr("25.000 x 25.000 mm"));
  EXPECT_EQ(Ask("board_trace", {{"serial", "B-7"}}).value()["robots"][0]["sessions"][0]["session"], session.str());
  EXPECT_EQ(Ask("board_trace", {{"serial", "B-9"}}).error().code, ErrorCode::kNotFound);
}

TEST_F(BoardOrderTest, AnEmptyRegistryHasAPageThatSaysHowToBegin) {
  EXPECT_THAT(Page("/boards/"), HasSubstr("No board is in the registry yet"));
}

}  // namespace
}  // namespace rigcal::pipeline
