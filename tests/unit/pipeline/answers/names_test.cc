// Names that nobody has: what they may mean, over every way to ask; and the names that there are.
#include <ctime>

#include "server/pipeline/answers/answer.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

class NamesTest : public PipelineTest {
 protected:
  RevisionCache revisions_cache_;
  AnswerContext Context() { return {*store_, clock_, revisions_cache_, clock_.now, ""}; }
  Result<std::string> Ask(const std::string& verb, const std::string& json) { return Answer(Context(), verb, json); }
  std::string Refused(const std::string& verb, const std::string& json) {
    const auto answer = Ask(verb, json);
    if (answer) return "it was answered: " + *answer;
    EXPECT_EQ(answer.error().code, ErrorCode::kNotFound) << verb;
    return Sentence(answer.error());
  }
  void StoreRobots(const std::vector<std::string>& names) {
    ASSERT_TRUE(store_->Write([&]() -> Status {
      for (const std::string& name : names) RIGCAL_TRY(storage::AppendRobot(*store_, RobotId(name), clock_.now));
      return {};
    }));
  }
};

TEST_F(NamesTest, AMisspeltRobotIsToldWhatItMayMean) {
  StoreRobots({"mapper-01", "mapper-02", "rover"});
  const std::string sentence =
      "robot 'maper-01' is not known: did you mean mapper-01? `rigcal robots` lists those that are.";
  for (const char* verb : {"show", "status", "sessions", "edges", "revisions", "live", "report_files", "sensor_names"})
    EXPECT_EQ(Refused(verb, R"({"robot":"maper-01"})"), sentence) << verb;
  EXPECT_EQ(Refused("lookup", R"({"robot":"maper-01","a":"x","b":"y"})"), sentence);
  EXPECT_EQ(Refused("show", R"({"robot":"nobody"})"),
            "robot 'nobody' is not known. `rigcal robots` lists those that are.");
  const auto page = AnswerPage(Context(), "/robots/maper-01/", "");
  ASSERT_FALSE(page);
  EXPECT_EQ(Sentence(page.error()), sentence);
  EXPECT_EQ(Sentence(AnswerPage(Context(), "/api/v1/show", "robot=maper-01").error()), sentence);
}

TEST_F(NamesTest, AMisspeltSensorIsToldWhatItMayMean) {
  std::vector<Edge> edges = {GivenEdge("mapper-01", "front_left", "front_right", 1.0),
                             GivenEdge("mapper-01", "front_left", "top", 2.0)};
  AssignPushedIds(edges);
  StoreEdges(edges);
  StepAll();
  const std::string cure = " `rigcal show mapper-01` lists its sensors.";
  EXPECT_EQ(Refused("lookup", R"({"robot":"mapper-01","a":"front_lef","b":"top"})"),
            "robot 'mapper-01' has no sensor 'front_lef': did you mean front_left?" + cure);
  EXPECT_EQ(Refused("lookup", R"({"robot":"mapper-01","a":"top","b":"Front_Right"})"),
            "robot 'mapper-01' has no sensor 'Front_Right': did you mean front_right?" + cure);
  EXPECT_EQ(Refused("lookup", R"({"robot":"mapper-01","a":"lidar","b":"top"})"),
            "robot 'mapper-01' has no sensor 'lidar'." + cure);
  EXPECT_TRUE(Ask("lookup", R"({"robot":"mapper-01","a":"front_left","b":"top"})"));
}

TEST_F(NamesTest, OfRobotsByPrefix) {
  StoreRobots({"mapper-01", "mapper-02", "rover"});
  EXPECT_EQ(*Ask("robot_names", "{}"), R"({"more":false,"robots":["mapper-01","mapper-02","rover"]})");
  EXPECT_EQ(*Ask("robot_names", R"({"prefix":"map"})"), R"({"more":false,"robots":["mapper-01","mapper-02"]})");
  EXPECT_EQ(*Ask("robot_names", R"({"prefix":""})"), *Ask("robot_names", "{}"));
  EXPECT_EQ(*Ask("robot_names", R"({"prefix":"x"})"), R"({"more":false,"robots":[]})");
  EXPECT_EQ(Ask("robot_names", R"({"prefix":"a'; --"})").error().code, ErrorCode::kInvalidInput);
  std::vector<std::string> many;
  for (int i = 0; i < 1001; ++i) many.push_back("z" + std::to_string(1000 + i));
  StoreRobots(many);
  const std::string page = *Ask("robot_names", R"({"prefix":"z"})");
  EXPECT_EQ(page.rfind(R"({"more":true,"robots":["z1000",)", 0), 0U) << page.substr(0, 80);
  EXPECT_EQ(page.find("z2000"), std::string::npos);
  EXPECT_NE(page.find("z1999"), std::string::npos);
}

TEST_F(NamesTest, OfSensorsWithAPoseOrListed) {
  StoreEdges(Triangle("r"));
  StepAll();
  StoreSession("r", {{"left/01.png", "1"}, {"right/01.png", "2"}});
  EXPECT_EQ(*Ask("sensor_names", R"({"robot":"r"})"),
            R"({"more":false,"robot":"r","sensors":["a","b","c","left","right"]})");
  EXPECT_EQ(*Ask("sensor_names", R"({"robot":"r","prefix":"le"})"), R"({"more":false,"robot":"r","sensors":["left"]})");
  StoreRobots({"new"});
  EXPECT_EQ(*Ask("sensor_names", R"({"robot":"new"})"), R"({"more":false,"robot":"new","sensors":[]})");
}

TEST_F(NamesTest, WhetherARobotIsKnownOrItsNameASlip) {
  StoreRobots({"mapper-01", "rig"});
  const auto told = [&](const std::string& robot) { return *Ask("known_robot", R"({"robot":")" + robot + R"("})"); };
  EXPECT_EQ(told("mapper-01"), R"({"known":true,"robot":"mapper-01","slip_of":[]})");
  EXPECT_EQ(told("maper-01"), R"({"known":false,"robot":"maper-01","slip_of":["mapper-01"]})");
  EXPECT_EQ(told("mapper-1"), R"({"known":false,"robot":"mapper-1","slip_of":["mapper-01"]})");
  EXPECT_EQ(told("mapper-02"), R"({"known":false,"robot":"mapper-02","slip_of":[]})") << "the next of the series";
  EXPECT_EQ(told("maper-1"), R"({"known":false,"robot":"maper-1","slip_of":[]})") << "two edits";
  EXPECT_EQ(told("ring"), R"({"known":false,"robot":"ring","slip_of":[]})") << "a short name";
  EXPECT_EQ(Ask("known_robot", "{}").error().code, ErrorCode::kInvalidInput);
}

TEST_F(NamesTest, WhoseFilesTheyAre) {
  const std::string none = std::string(64, 'e');
  EXPECT_EQ(*Ask("known_files", R"({"robot":"rover","digests":")" + none + R"("})"), R"({"asked":1,"files":0})");
  EXPECT_EQ(Ask("known_files", R"({"robot":"rover","digests":""})").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Ask("known_files", R"({"robot":"rover","digests":"12"})").error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(Ask("known_files", R"({"robot":"rover"})").error().code, ErrorCode::kInvalidInput);
}

double ProcessorMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

// 20,000 names are compared and 131 per character looked up, however many there are.
TEST_F(NamesTest, ASlipIsFoundAmongAHundredThousandRobots) {
  std::vector<std::string> fleet;
  for (int i = 0; i < 100'000; ++i) fleet.push_back("mapper-" + std::to_string(100'000 + i));
  StoreRobots(fleet);
  for (const char* name : {"maper-199999", "xmapper-100000", "mapper150000"}) {
    const double start_ms = ProcessorMs();
    const std::string text = Refused("show", R"({"robot":")" + std::string(name) + R"("})");
    const double took_ms = ProcessorMs() - start_ms;
    const std::string meant = "mapper-" + std::string(name).substr(std::string(name).size() - 6);
    EXPECT_NE(text.find("did you mean " + meant + "?"), std::string::npos) << text;
    EXPECT_LT(took_ms, 500.0) << name;
  }
}

}  // namespace
}  // namespace rigcal::pipeline
