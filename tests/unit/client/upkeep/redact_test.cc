#include "client/upkeep/support/redact.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
      "-----BEGIN PRIVATE KEY-----\nS3cretWord\n-----END PRIVATE KEY-----\nafter",
      "-----BEGIN EC PRIVATE KEY-----\nS3cretWord",
      "-----BEGIN CERTIFICATE-----\nx\n-----END CERTIFICATE-----\n-----BEGIN PRIVATE KEY-----\nS3cretWord\n",
  };
  for (const char* text : texts) {
    EXPECT_THAT(Redacted(text), Not(HasSubstr("S3cretWord"))) << text;
    EXPECT_THAT(Redacted(text), HasSubstr(kRedacted)) << text;
  }
}

TEST(Redacted, LeavesWhatIsNone) {
  for (const std::string text :
       {"2026-01-01 info receipt of session 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n",
        "--http-key /etc/rigcal/rigs.key\n", "http://127.0.0.1:8420/robots/a/\n", "two\n\nlines", "",
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

}  // namespace
}  // namespace rigcal::client
