// `rigcal tf` against a server in memory: what it refuses, in whose words.
#include <gmock/gmock.h>

#include "tests/unit/client/ros/ros_reader.h"
#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<std::string> TfOnceWords(const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {
      "tf", "r", "--once", "--ros-domain", std::to_string(kRosTestDomain), "--ros-tag", RosTestSide().tag};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(Tf, ACandidateIsRefusedWithTheCommandThatApprovesIt) {
  FakeServer server(
      "r",
      Always(
          R"({"robot":"r","revision":2,"state":"candidate","usable":null,"document":{"verdict":{"level":"pass"}}})"));
  const Ran ran = Rigcal(TfOnceWords());
  EXPECT_EQ(ran.code, 4) << ran.err;
  EXPECT_THAT(
      ran.err,
      HasSubstr("revision 2 of r is not approved: it is candidate. `rigcal approve r 2 --reason TEXT` approves it."));
  EXPECT_THAT(ran.err, Not(HasSubstr("--even-if-not-approved"))) << "it has no such option";
  EXPECT_EQ(ran.out, "");
}

TEST(Tf, AFailIsRefused) {
  FakeServer server(
      "r",
      Always(
          R"({"robot":"r","revision":2,"state":"unusable","usable":null,"document":{"verdict":{"level":"fail","why":"b moved"}}})"));
  const Ran ran = Rigcal(TfOnceWords());
  EXPECT_EQ(ran.code, 4) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("revision 2 of r has the verdict fail: b moved"));
}

TEST(Tf, AWrongDomainOfTheEnvironmentIsNamed) {
  setenv("ROS_DOMAIN_ID", "forty", 1);
  const Ran ran = Rigcal({"tf", "r", "--once"});
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(ran.code, 4) << ran.err;
  EXPECT_THAT(ran.err, HasSubstr("ROS_DOMAIN_ID is 'forty'"));
}

}  // namespace
}  // namespace rigcal::client
