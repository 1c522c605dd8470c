#include "client/wire/connection.h"

#include <gtest/gtest.h>

#include "tests/unit/client/fake_server.h"

namespace rigcal::client {
namespace {

struct Asking {
  wire::Participant participant = wire::Participant::Open(TestPlace()).value();
  Connection connection = Connection::Open(participant, TestPlace()).value();
};

TEST(Connection, GivesTheDocumentVerbatim) {
  FakeServer server("r", [](const std::string& verb, const std::string& json) -> Result<std::string> {
    return "{ \"verb\":\"" + verb + "\",  \"json\":" + json + "}";
  });
  Asking asking;
  EXPECT_EQ(asking.connection.Ask("show", "{\"robot\":\"r\"}", milliseconds(10'000)).value_or("none"),
            "{ \"verb\":\"show\",  \"json\":{\"robot\":\"r\"}}");
  EXPECT_EQ(asking.connection.Ask("health", "{}", milliseconds(10'000)).value_or("none"),
            "{ \"verb\":\"health\",  \"json\":{}}");
}

TEST(Connection, PutsPartsTogether) {
  const std::string text = "{\"text\":\"" + std::string(100'000, 'x') + "\"}";
  FakeServer server("r", [&](const std::string&, const std::string&) -> Result<std::string> { return text; });
  server.part_bytes = 9'999;
  Asking asking;
  EXPECT_EQ(asking.connection.Ask("show", "{}", milliseconds(10'000)).value_or("none"), text);
}

TEST(Connection, AnErrorDocumentIsAnError) {
  FakeServer server("r", [](const std::string&, const std::string&) -> Result<std::string> {
    return Fail(ErrorCode::kNotFound, "robot 'x' is not known", "`rigcal robots` lists those that are");
  });
  Asking asking;
  const auto answer = asking.connection.Ask("show", "{}", milliseconds(10'000));
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(answer.error().what, "robot 'x' is not known");
}

TEST(Connection, AQuestionThatGotLostIsAskedAgain) {
  FakeServer server("r", [](const std::string&, const std::string&) -> Result<std::string> { return "{\"n\":1}"; });
  server.requests_to_ignore = 2;
  Asking asking;
  EXPECT_EQ(asking.connection.Ask("show", "{}", milliseconds(10'000)).value_or("none"), "{\"n\":1}");
  EXPECT_EQ(server.requests_seen, 3);
}

TEST(Connection, NobodyThereIsUnreachableWithinTheTimeout) {
  Asking asking;
  const auto start = std::chrono::steady_clock::now();
  const auto answer = asking.connection.Ask("show", "{}", milliseconds(150));
  const auto took = std::chrono::steady_clock::now() - start;
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kUnreachable);
  EXPECT_NE(answer.error().what.find("DDS domain 0, tag 'test-"), std::string::npos) << answer.error().what;
  EXPECT_NE(answer.error().cure.find("rigcal doctor"), std::string::npos);
  EXPECT_GE(took, milliseconds(150));
  EXPECT_LT(took, milliseconds(5000));
}

TEST(Connection, AServerThatIsSilentIsUnreachableToo) {
  FakeServer server("r");
  server.requests_to_ignore = 1'000'000;
  Asking asking;
  const auto answer = asking.connection.Ask("show", "{}", milliseconds(200));
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kUnreachable);
}

}  // namespace
}  // namespace rigcal::client
