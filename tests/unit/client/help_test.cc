// What the help of every verb says at its end.
#include <gtest/gtest.h>

#include "tests/unit/client/run.h"

namespace rigcal::client {
namespace {

TEST(Help, OfEveryVerbNamesTheOptionsThatAllHave) {
  const auto ends_with = [](const std::vector<std::string>& words, const std::string& options) {
    return Rigcal(words).out.find("Options of every verb: " + options) != std::string::npos;
  };
  for (const char* verb : {"push-edges", "status", "restore", "retire", "compare", "export", "policy", "approve",
                           "reject", "rollback", "agent", "tf", "audit", "model", "epoch", "resolve"})
    EXPECT_TRUE(ends_with({verb, "--help"}, "--json")) << verb;
  EXPECT_TRUE(ends_with({"policy", "set", "--help"}, "--json"));
  EXPECT_TRUE(ends_with({"completion", "--help"}, "--domain")) << "it prints a script";
}

// A robot of many sensors has more.
TEST(Help, PromisesNoCertificateOfOnePage) {
  const std::string help = Rigcal({"--help"}).out;
  const std::size_t line = help.find("\n  certificate ");
  ASSERT_NE(line, help.npos) << help;
  EXPECT_EQ(help.substr(line, help.find("\n  ", line + 1) - line).find("one page"), std::string::npos);
}

}  // namespace
}  // namespace rigcal::client
