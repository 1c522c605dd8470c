// The program as people run it: exit codes, help, and what it says where nobody answers.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

namespace {

struct Ran {
  int code = -1;
  std::string text;  // out and err
  double took_s = 0.0;
};

// `arguments` come from this file only.
Ran Rigcal(const std::string& arguments) {
  static const std::string tag = "test-" + std::to_string(std::random_device()()) + "-" + std::to_string(getpid());
  const auto start = std::chrono::steady_clock::now();
  const std::string command = "RIGCAL_DDS_TAG=" + tag + " '" RIGCAL_PROGRAM "' " + arguments + " 2>&1";
  Ran ran;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer{};
  while (pipe != nullptr && std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) ran.text += buffer.data();
  const int status = pipe == nullptr ? -1 : pclose(pipe);
  ran.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  ran.took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return ran;
}

const std::vector<std::string> kVerbs = {
    "push",        "push-edges",     "robots",   "sessions",   "edges",   "show",   "history", "lookup",
    "status",      "watch",          "report",   "due",        "compare", "export", "diff",    "doctor",
    "check",       "companion",      "simulate", "completion", "policy",  "audit",  "approve", "reject",
    "rollback",    "agent",          "tf",       "model",      "fleet",   "epoch",  "board",   "import",
    "backup",      "restore-backup", "fsck",     "user",       "token",   "record", "replay",  "identity",
    "certificate", "support-bundle"};

TEST(Program, HelpOfEveryVerbHasExamples) {
  const Ran top = Rigcal("--help");
  EXPECT_NE(top.text.find("6 verdict unknown or calibration overdue"), std::string::npos) << top.text;
  EXPECT_EQ(top.code, 0);
  for (const std::string& verb : kVerbs) {
    EXPECT_NE(top.text.find("\n  " + verb + " "), std::string::npos) << verb;
    const Ran ran = Rigcal(verb + " --help");
    EXPECT_EQ(ran.code, 0) << verb;
    const std::size_t examples = ran.text.find("Examples:\n");
    ASSERT_NE(examples, std::string::npos) << verb;
    EXPECT_NE(ran.text.find("\n  rigcal " + verb, examples), std::string::npos) << verb;
  }
}

TEST(Program, Version) {
  const Ran ran = Rigcal("--version");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.text.rfind("rigcal ", 0), 0U);
  EXPECT_NE(ran.text.find("protocol"), std::string::npos);
}

constexpr const char* kWrongUses[] = {"",
                                      "frobnicate",
                                      "lookup r a",
                                      "lookup r a b c",
                                      "push",
                                      "push-edges file.json",
                                      "show",
                                      "edges",
                                      "report",
                                      "show r --revision zero",
                                      "show r --revision 0",
                                      "history",
                                      "history r --limit 0",
                                      "history r --before x",
                                      "sessions --limit 1001",
                                      "edges r --limit none",
                                      "status --timeout never",
                                      "status --timeout -1",
                                      "due --max-age tomorrow",
                                      "watch --count 0",
                                      "push-edges f --robot r --shuffle x",
                                      "robots --frobnicate",
                                      "simulate --captures x",
                                      "--frobnicate simulate",
                                      "check",
                                      "check a b",
                                      "companion",
                                      "companion a --port x",
                                      "companion a --port 70000",
                                      "import",
                                      "import bag",
                                      "import bag --rig r",
                                      "import bag --list --every -1",
                                      "record",
                                      "record rig.yaml",
                                      "record rig.yaml --bag b --for 0",
                                      "replay",
                                      "replay bag --rate 0",
                                      "check --frobnicate x",
                                      "policy",
                                      "policy sow r",
                                      "user",
                                      "user add",
                                      "user add ada",
                                      "user add ada --role root",
                                      "user list ada",
                                      "token",
                                      "token new grafana",
                                      "identity",
                                      "identity new robot",
                                      "identity new ship x",
                                      "identity new robot x --days 0",
                                      "board",
                                      "board burn x",
                                      "board show",
                                      "board measure x --ruler-x-mm 100",
                                      "policy check",
                                      "policy set file",
                                      "policy set --reason x",
                                      "policy show --robot a --model b",
                                      "approve r",
                                      "agent r",
                                      "agent r --out x --frobnicate",
                                      "tf",
                                      "tf r --ros-domain 231",
                                      "tf r --ros-domain x",
                                      "approve r 0 --reason x",
                                      "reject r",
                                      "rollback r --reason x",
                                      "audit r --limit 0",
                                      "audit verify --limit 3"};

TEST(Program, WrongUsageIsTwoWithASentence) {
  for (const char* arguments : kWrongUses) {
    const Ran ran = Rigcal(arguments);
    EXPECT_EQ(ran.code, 2) << arguments << "\n" << ran.text;
    EXPECT_EQ(ran.text.rfind("rigcal: ", 0), 0U) << arguments << "\n" << ran.text;
  }
}

TEST(Program, AMisspeltWordIsToldWhatItMayMean) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"pusch", "there is no verb 'pusch': did you mean push?"},
      {"pusch visit/ --no-wait", "there is no verb 'pusch': did you mean push?"},
      {"frobnicate --no-wait", "there is no verb 'frobnicate'\n"},
      {"--tga bench pusch visit/", "there is no verb 'pusch': did you mean push?"},
      {"psuh-edges file.json", "there is no verb 'psuh-edges': did you mean push-edges?"},
      {"shwo mapper-01", "there is no verb 'shwo': did you mean show?"},
      {"frobnicate", "there is no verb 'frobnicate'\n"},
      {"--jsno robots", "there is no option '--jsno': did you mean --json?"},
      {"--domian=3 check visit/", "there is no option '--domian': did you mean --domain?"},
      {"show mapper-01 --revison 3", "there is no option '--revison': did you mean --revision?"},
      {"show --revison=3", "there is no option '--revison': did you mean --revision?"},
      {"compare r --poess file", "there is no option '--poess': did you mean --poses?"},
      {"check visit/ --jsn", "there is no option '--jsn': did you mean --json?"},
      {"simulate mars-mapper --sede 3", "there is no option '--sede': did you mean --seed?"},
      {"show r -q", "there is no option '-q'\n"}};
  for (const auto& [arguments, sentence] : cases) {
    const Ran ran = Rigcal(arguments);
    EXPECT_EQ(ran.code, 2) << arguments << "\n" << ran.text;
    EXPECT_EQ(ran.text.rfind("rigcal: " + sentence, 0), 0U) << arguments << "\n" << ran.text;
    EXPECT_NE(ran.text.find("rigcal --help"), std::string::npos) << ran.text;
  }
}

// A program of its own runs it: the words before the verb and after it reach that one.
TEST(Program, SimulateTakesItsWordsAndEndsLikeTheOthers) {
  const Ran rig = Rigcal("simulate --print-rig mars-mapper");
  EXPECT_EQ(rig.code, 0) << rig.text;
  EXPECT_NE(rig.text.find("lidar_vertical"), std::string::npos) << rig.text;
  const Ran refused = Rigcal("--json simulate no-such-rig --captures 2");
  EXPECT_EQ(refused.code, 4) << refused.text;
  EXPECT_NE(refused.text.find(R"("what":"rig no-such-rig)"), std::string::npos) << refused.text;
}

TEST(Program, CheckTakesItsWordsAndRefusesWhatIsNoSession) {
  const Ran refused = Rigcal("--json check /does/not/exist");
  EXPECT_EQ(refused.code, 4) << refused.text;
  EXPECT_NE(refused.text.find("there is no such folder"), std::string::npos) << refused.text;
  EXPECT_NE(refused.text.find(R"("code":"not_found")"), std::string::npos) << refused.text;
}

TEST(Program, SimulateSaysHowADisturbanceIsWritten) {
  const auto [reads, refuses] = std::pair{
      std::vector<std::string>{"--bump back --bump-by 0.02,2 --bump-at 0.25", "--board-moved 0.005,0.5@0.25:front",
                               "--wrong-instant drawn", "--wrong-instant 02:back", "--shift-capture 8@01:back",
                               "--visit-scatter 0.3,0.01", "--lens-misfit 0.05 --bursts 2", "--pose-clock-offset -12.3",
                               "--sway 0.1,5 --pose-clock-offset 20"},
      std::vector<std::pair<std::string, std::string>>{
          {"--bump-by 5", "Write it as M,DEG"},
          {"--board-moved 0.005,x", "Write it as M,DEG, M,DEG@RATIO"},
          {"--board-moved 0.005,0.5:nobody", "board nobody cannot be moved"},
          {"--wrong-instant 02", "Write it as CAPTURE:SENSOR"},
          {"--shift-capture 8@99:back", "capture 99 is none of this visit"},
          {"--shift-capture 8@01:body", "sensor body takes no pictures"},
          {"--visit-scatter 0.3", "Write it as MM,DEG"},
          {"--sway 0.1", "Write it as M,DEG"},
          {"--pose-clock-offset 2000", "pose-clock-offset is out of range"},
          {"--lens-misfit -1", "lens-misfit is out of range"},
          {"--bump back --bump-at 1", "bump-at is out of range"}}};
  for (const std::string& words : reads) {
    const Ran ran = Rigcal("simulate mars-mapper --captures 4 " + words);
    EXPECT_EQ(ran.code, 0) << words << "\n" << ran.text;
  }
  for (const auto& [words, sentence] : refuses) {
    const Ran ran = Rigcal("simulate mars-mapper --captures 4 " + words);
    EXPECT_EQ(ran.code, 4) << words << "\n" << ran.text;
    EXPECT_NE(ran.text.find(sentence), std::string::npos) << words << "\n" << ran.text;
  }
}

TEST(Program, ADomainThatIsNoneIsWrongUsage) {
  for (const char* domain : {"x", "231", "-1", "99999999999"}) {
    const Ran ran = Rigcal(std::string("status --timeout 0.2 --domain=") + domain);
    EXPECT_EQ(ran.code, 2) << ran.text;
    EXPECT_NE(ran.text.find("--domain"), std::string::npos) << ran.text;
  }
}

TEST(Program, ATagThatIsNoneIsRefused) {
  const Ran ran = Rigcal("status --timeout 0.2 --tag 'a b'");
  EXPECT_EQ(ran.code, 4) << ran.text;
  EXPECT_NE(ran.text.find("a b"), std::string::npos) << ran.text;
}

TEST(Program, NobodyThereIsThreeWithinTheTimeout) {
  for (const char* verb : {"robots", "sessions", "edges r", "show r", "lookup r a b", "status", "report r", "due"}) {
    const Ran ran = Rigcal(std::string(verb) + " --timeout 0.3");
    EXPECT_EQ(ran.code, 3) << verb << "\n" << ran.text;
    EXPECT_NE(ran.text.find("no rigcald answers on DDS domain 0, tag 'test-"), std::string::npos) << ran.text;
    EXPECT_NE(ran.text.find("rigcal doctor"), std::string::npos);
    EXPECT_GE(ran.took_s, 0.3);
    EXPECT_LT(ran.took_s, 5.0);
  }
}

TEST(Program, DoctorSaysThatNobodyIsThere) {
  const Ran ran = Rigcal("doctor");
  EXPECT_EQ(ran.code, 3) << ran.text;
  EXPECT_NE(ran.text.find("fail"), std::string::npos);
  EXPECT_NE(ran.text.find("-> "), std::string::npos);
  const Ran json = Rigcal("doctor --json");
  EXPECT_EQ(json.code, 3);
  EXPECT_EQ(json.text.rfind("{\"checks\":[", 0), 0U) << json.text;
}

TEST(Program, InputThatIsNotThereIsRefusedBeforeAnythingIsSent) {
  for (const char* arguments :
       {"push /nonexistent", "push-edges /nonexistent.json --robot r", "push-edges /nonexistent.g2o --robot r",
        "push-edges /dev/null --robot '../x'", "watch ../x"}) {
    const Ran ran = Rigcal(arguments);
    EXPECT_EQ(ran.code, 4) << arguments << "\n" << ran.text;
    EXPECT_EQ(ran.text.rfind("rigcal: ", 0), 0U) << ran.text;
  }
}

TEST(Program, WatchEndsAfterItsTimeout) {
  const Ran ran = Rigcal("watch --timeout 0.3");
  EXPECT_EQ(ran.code, 0) << ran.text;
  EXPECT_LT(ran.took_s, 5.0);
}

}  // namespace
