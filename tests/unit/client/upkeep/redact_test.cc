#include "client/upkeep/support/redact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/text/document.h"

namespace rigcal::client {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Redacted, TakesEverySecretOut) {
  const char* const texts[] = {
      "RIGCAL_STORE=postgresql://rigcal:S3cretWord@db.example.org/rigcal",
      "connecting to postgresql://rigcal:p:S3cretWord@db:5432/rigcal failed",
      "PGPASSWORD=S3cretWord",
      "  password: S3cretWord",
      "\"admin_password\": \"S3cretWord with more\"",
      "webhook_secret = 'S3cretWord'",
      "Authorization: Bearer S3cretWord",
      "authorization: basic S3cretWord==",
      "sent bearer S3cretWord",
      "Cookie: __Host-rigcal=S3cretWord; other=1",
      "api-key=S3cretWord&x=1",
      "host=db user=rigcal password=S3cretWord",
      "host=db password S3cretWord",
      R"(webhook=["https://x/w?sig=S3cretWord"])",
      R"(webhook=["https://x/S3cretWord"])",
      "https://hooks.slack.com/services/T0/B0/S3cretWord",
      "asked https://x/w?sig=S3cretWord twice",
      "PGPASSWORD=Tr0ub&dor3,S3cretWord",
      "password = p@ss S3cretWord",
      R"("token": "a\"S3cretWord")",
      R"({"a":1,"token":"a\"S3cretWord","b":2})",
      "AWS_SECRET_ACCESS_KEY=S3cretWord",
      "env AWS_SECRET_ACCESS_KEY=a,S3cretWord",
      "CYCLONEDDS_URI=<Security><Password>S3cretWord</Password></Security>",
      "postgresql://u:it's-S3cretWord@h",
      "-----BEGIN PRIVATE KEY-----\nS3cretWord\n-----END PRIVATE KEY-----\nafter",
      "-----BEGIN EC PRIVATE KEY-----\nS3cretWord",
      "-----BEGIN CERTIFICATE-----\nx\n-----END CERTIFICATE-----\n-----BEGIN PRIVATE KEY-----\nS3cretWord\n",
  };
  for (const char* text : texts) {
    EXPECT_THAT(Redacted(text), Not(HasSubstr("S3cretWord"))) << text;
    EXPECT_THAT(Redacted(text), HasSubstr(kRedacted)) << text;
  }
}

TEST(Redacted, AValueOfSeveralLinesIsTakenOutWhole) {
  const char* const texts[] = {
      "webhook-secret = \"first\nS3cretWord\nlast\"\nhttp = kept",
      "token = \"\"\"\nS3cretWord\n\nS3cretWord\n\"\"\"\nhttp = kept",
      "webhook = [\n  \"https://x/S3cretWord\",\n  \"https://y/S3cretWord\"\n]\nhttp = kept",
      "RIGCAL_TOKEN=first\\\n S3cretWord\\\nS3cretWord\nhttp = kept",
      "export PGPASSWORD='first\nS3cretWord'\nhttp = kept",
      "secret: |-\n  S3cretWord\n\n  S3cretWord\nhttp: kept",
      "webhooks:\n- https://x/S3cretWord\n- https://y/S3cretWord\nhttp: kept",
      "  webhook:\n    https://x.example/\n    S3cretWord\n  http: kept",
      "webhook = https://x.example/a\\\nS3cretWord\nhttp = kept",
      "<Security>\n<Password>\nS3cretWord\n</Password>\nkept",
      "webhook = [\r\n\"https://x/S3cretWord\"]\r\nhttp = kept",
      "secret = {\n  a: {x: 1},\n  b: S3cretWord\n}\nhttp = kept",
      "secret = {a: {x: 1},\nb: S3cretWord\n}\nhttp = kept",
      "secret = [\n\"a]\",\n\"S3cretWord\"\n]\nhttp = kept",
      "token = \"ab\\\"cd\nS3cretWord\"\nhttp = kept",
      "token = \"ab\ncd\\\"\nS3cretWord\"\nhttp = kept",
      "secret: |  # vault\n  S3cretWord\nhttp: kept",
      "secret: >-  # vault\n  S3cretWord\nhttp: kept",
      "secret: first\n  S3cretWord\nhttp: kept",
      "  token: first\n    S3cretWord\n  http: kept",
      "secret: 'it''s\n S3cretWord'\nhttp: kept",
      "webhooks:  # ours\n- https://x/S3cretWord\nhttp: kept",
  };
  for (const char* text : texts) {
    EXPECT_THAT(Redacted(text), Not(HasSubstr("S3cretWord"))) << text;
    EXPECT_THAT(Redacted(text), testing::EndsWith("kept")) << text;
  }
}

TEST(Redacted, LeavesWhatIsNone) {
  for (const std::string text :
       {"2026-01-01 info receipt of session 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n",
        "--http-key /etc/rigcal/rigs.key\n", "http://127.0.0.1:8420/robots/a/\n", "two\n\nlines", "",
        "webhook-secret-file = /etc/rigcal/webhook\n", "webhook-secret-file = \\\n/etc/rigcal/webhook\nhttp = x\n",
        "12:00 token:\n12:01 next\n", "RIGCAL_TOKEN_FILE=/etc/rigcal/token\n",
        "-----BEGIN CERTIFICATE-----\nabc\n-----END CERTIFICATE-----\n"})
    EXPECT_EQ(Redacted(text), text);
  EXPECT_THAT(Redacted("postgresql://rigcal:x@db.example.org/rigcal"), HasSubstr("rigcal:[redacted]@db.example.org"));
  EXPECT_THAT(Redacted("-----BEGIN PRIVATE KEY-----\nx\n-----END PRIVATE KEY-----\nafter"), HasSubstr("after"));
}

TEST(Redacted, LongLinesAreCut) {
  const std::string cut = Redacted(std::string(1 << 20, 'a') + "\nnext");
  EXPECT_LT(cut.size(), 10'000U);
  EXPECT_THAT(cut, HasSubstr("next"));
}

TEST(RedactedJson, StaysJsonHoweverLong) {
  std::string rows;
  for (int i = 0; i < 2000; ++i) rows += R"({"robot":"rig","dims":[]},)";
  const std::string kept = RedactedJson(R"({"rows":[)" + rows + R"({"robot":"last"}],"admin_token":"a\"S3cretWord",)" +
                                        R"("webhooks":[{"url":"https://x/S3cretWord"}],"pin_secret":[12345],)" +
                                        R"("why":"of postgresql://u:S3cretWord@h \"quoted\""})");
  const auto document = Document::Parse(kept, "kept");
  ASSERT_TRUE(document) << kept;
  EXPECT_EQ((*document)["rows"].size(), 2001U);
  EXPECT_EQ((*document)["rows"][2000]["robot"].Text(), "last");
  EXPECT_EQ((*document)["admin_token"].Text(), kRedacted);
  EXPECT_THAT((*document)["why"].Text(), HasSubstr("@h \"quoted\""));
  EXPECT_THAT(kept, Not(HasSubstr("S3cretWord")));
  EXPECT_THAT(kept, Not(HasSubstr("12345")));
  EXPECT_THAT(RedactedJson("no JSON, password=S3cretWord"), Not(HasSubstr("S3cretWord")));
}

}  // namespace
}  // namespace rigcal::client
