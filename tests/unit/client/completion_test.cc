// What the shells are told of a line that is being typed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using Lines = std::vector<std::string>;

Lines LinesOf(const std::string& text) {
  std::istringstream stream(text);
  Lines lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Whole lines, with the meaning behind a tab.
Lines Completed(Lines words) {
  words.insert(words.begin(), {"rigcal", "complete-words", "--"});
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream out, err;
  EXPECT_EQ(RunCommandLine(static_cast<int>(argv.size()), argv.data(), out, err, false), 0);
  EXPECT_EQ(err.str(), "");
  return LinesOf(out.str());
}

// The words alone.
Lines WordsAfter(const Lines& words) {
  Lines told = Completed(words);
  for (std::string& line : told) line = line.substr(0, line.find('\t'));
  return told;
}

TEST(Completion, OfVerbsWithTheirMeaning) {
  EXPECT_THAT(Completed({"look"}),
              ElementsAre("lookup\tPrint the pose of sensor B in sensor A with its 6x6 covariance"));
  EXPECT_THAT(WordsAfter({"push"}), ElementsAre("push", "push-edges"));
  EXPECT_THAT(WordsAfter({""}), Contains("simulate"));
  EXPECT_THAT(WordsAfter({"policy", ""}), ElementsAre("show", "check", "set"));
  EXPECT_THAT(WordsAfter({"board", ""}), ElementsAre("print", "measure", "list", "show", "trace"));
  EXPECT_THAT(WordsAfter({"board", "print", "--out", ""}), ElementsAre(":files"));
  EXPECT_THAT(WordsAfter({"policy", "check", ""}), ElementsAre(":files"));
  EXPECT_THAT(WordsAfter({"model", ""}), ElementsAre("show", "list", "check", "set"));
  EXPECT_THAT(WordsAfter({"model", "set", ""}), ElementsAre(":files"));
  EXPECT_THAT(WordsAfter({""}), Not(Contains("complete-words")));
  EXPECT_THAT(WordsAfter({"--domain", "3", "stat"}), ElementsAre("status"));
  EXPECT_THAT(WordsAfter({}), Contains("show"));
  EXPECT_THAT(WordsAfter({"frobnicate", ""}), IsEmpty());
}

TEST(Completion, OfOptionsOfTheVerbAndOfAll) {
  EXPECT_THAT(Completed({"show", "mapper-01", "--rev"}),
              ElementsAre("--revision\tA numbered revision (default: the newest)"));
  EXPECT_THAT(WordsAfter({"compare", "--p"}), ElementsAre("--poses")) << "of a group";
  EXPECT_THAT(WordsAfter({"push", "visit/", "--"}),
              testing::AllOf(Contains("--no-wait"), Contains("--rig"), Contains("--new-robot"), Contains("--json"),
                             Contains("--help")));
  EXPECT_THAT(WordsAfter({"--ve"}), ElementsAre("--version"));
  EXPECT_THAT(WordsAfter({"show", "--no-w"}), IsEmpty()) << "of another verb";
}

TEST(Completion, OfFilesAndFoldersIsTheShells) {
  EXPECT_THAT(Completed({"push", "vis"}), ElementsAre(":files"));
  EXPECT_THAT(Completed({"push", "--no-wait", "vis"}), ElementsAre(":files"));
  EXPECT_THAT(Completed({"push", "drive.mcap", "--work", ""}), ElementsAre(":folders"));
  EXPECT_THAT(Completed({"push-edges", ""}), ElementsAre(":files"));
  EXPECT_THAT(Completed({"compare", "mapper-01", "--poses", ""}), ElementsAre(":files"));
  EXPECT_THAT(Completed({"compare", "mapper-01", "--poses", "=", "vis"}), ElementsAre(":files")) << "--poses=vis";
  EXPECT_THAT(Completed({"compare", "mapper-01", "--poses", "="}), ElementsAre(":files"));
  EXPECT_THAT(Completed({"report", "mapper-01", "--out", ""}), ElementsAre(":files"));
  EXPECT_THAT(Completed({"push", "--", "-"}), ElementsAre(":files"));
}

TEST(Completion, OfWhatNobodyKnowsIsNothing) {
  EXPECT_THAT(Completed({"show", "mapper-01", "--revision", ""}), IsEmpty());
  EXPECT_THAT(Completed({"push", "visit/", "more"}), IsEmpty());
  EXPECT_THAT(Completed({"retire", ""}), IsEmpty());
  EXPECT_THAT(WordsAfter({"completion", ""}), ElementsAre("bash", "zsh", "fish"));
}

TEST(Completion, OfRobotsAndSensorsIsTheServers) {
  std::string asked;
  FakeServer server("r", [&](const std::string& verb, const std::string& json) -> Result<std::string> {
    asked = verb + json;
    if (verb == "robot_names") return R"({"more":false,"robots":["mapper-01","mapper-02"]})";
    return R"({"more":false,"robot":"mapper-01","sensors":["front_left","front_right"]})";
  });
  const std::string tag = TestPlace().tag;
  EXPECT_THAT(Completed({"--tag", tag, "--timeout", "20", "show", "map"}), ElementsAre("mapper-01", "mapper-02"));
  EXPECT_EQ(asked, R"(robot_names{"prefix":"map"})");
  EXPECT_THAT(Completed({"push-edges", "e.json", "--tag=" + tag, "--timeout=20", "--robot", ""}),
              ElementsAre("mapper-01", "mapper-02"));
  EXPECT_EQ(asked, "robot_names{}");
  for (const Lines& words : {Lines{"lookup", "mapper-01", "front"}, Lines{"lookup", "mapper-01", "top", "front"}}) {
    Lines line = {"--tag", tag, "--timeout", "20"};
    line.insert(line.end(), words.begin(), words.end());
    EXPECT_THAT(Completed(line), ElementsAre("front_left", "front_right"));
    EXPECT_EQ(asked, R"(sensor_names{"robot":"mapper-01","prefix":"front"})");
  }
}

TEST(Completion, SaysNothingWhereNobodyAnswers) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(Completed({"--tag", TestPlace().tag + "-empty", "show", ""}), IsEmpty());
  EXPECT_THAT(Completed({"--tag", "a b", "show", ""}), IsEmpty());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  FakeServer older("r", [](const std::string&, const std::string&) -> Result<std::string> {
    return Fail(ErrorCode::kInvalidInput, "the verb is not known", "docs/api.md lists the verbs");
  });
  EXPECT_THAT(Completed({"--tag", TestPlace().tag, "show", ""}), IsEmpty());
}

TEST(Completion, ScriptsAreForThreeShells) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Ran ran = Rigcal({"completion", shell});
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_NE(ran.out.find("complete-words -- "), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("`rigcal completion " + std::string(shell) + "`"), std::string::npos) << ran.out;
  }
  EXPECT_EQ(Rigcal({"completion", "csh"}).code, 2);
  EXPECT_EQ(Rigcal({"completion"}).code, 2);
}

}  // namespace
}  // namespace rigcal::client
