// The file of `rigcal agent`: the server's document byte for byte, or what it was before.
#include "client/change/agent_file.h"

#include <gtest/gtest.h>

#include "server/base/digests/sha256.h"
#include "server/base/files/durable_file.h"
#include "tests/unit/client/fake_server.h"

namespace rigcal::client {
namespace {

class AgentFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path File() const { return folder_.path() / "calibration.json"; }
  SessionFolder folder_;
};

TEST_F(AgentFileTest, TheDocumentIsCutOutOfTheAnswer) {
  const std::string document = R"({"a":{"b":"}\"{"},"c":[{}]})";
  EXPECT_EQ(DocumentIn(R"({"age_ns":1,"decision":{"reason":"\"document\":{x"},"document":)" + document +
                       R"(,"drive":{"rule":"x"}})"),
            document);
  for (const char* text : {"", "{}", R"({"document":null})", R"({"document":{"a":1)", R"({"document":3})"})
    EXPECT_EQ(DocumentIn(text), "") << text;
}

TEST_F(AgentFileTest, WhatIsWrittenHasTheDigestOfTheRevision) {
  EXPECT_FALSE(LookAtApplied(File()).value());
  const std::string document = R"({"reference":"left"})";
  ASSERT_TRUE(Apply(document, Sha256Of(document), File()));
  EXPECT_EQ(ReadFile(File(), 1 << 20).value(), document);
  const AppliedFile applied = *LookAtApplied(File()).value();
  EXPECT_EQ(applied.digest, Sha256Of(document));
  EXPECT_GT(applied.applied_at.ns, 1'700'000'000'000'000'000);
}

TEST_F(AgentFileTest, AnotherDocumentIsNotWritten) {
  ASSERT_TRUE(Apply("{}", Sha256Of("{}"), File()));
  const Status refused = Apply("{\"a\":1}", Sha256Of("{\"a\":2}"), File());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kStorage);
  EXPECT_EQ(ReadFile(File(), 1 << 20).value(), "{}");
  EXPECT_FALSE(Apply("{}", Sha256Of("{}"), folder_.path() / "none" / "x.json"));
}

}  // namespace
}  // namespace rigcal::client
