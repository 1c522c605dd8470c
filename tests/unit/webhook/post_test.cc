// What is signed, whom it goes to, and when it is tried again.
#include <gtest/gtest.h>

#include "server/base/digests/hmac.h"
#include "server/webhook/sender.h"

namespace rigcal::webhook {
namespace {

// RFC 4231, test cases 1 to 3 and 6.
TEST(Hmac, IsThatOfTheStandard) {
  EXPECT_EQ(HmacSha256(std::string(20, '\x0b'), "Hi There").str(),
            "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
  EXPECT_EQ(HmacSha256("Jefe", "what do ya want for nothing?").str(),
            "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
  EXPECT_EQ(HmacSha256(std::string(20, '\xaa'), std::string(50, '\xdd')).str(),
            "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe");
  EXPECT_EQ(HmacSha256(std::string(131, '\xaa'), "Test Using Larger Than Block-Size Key - Hash Key First").str(),
            "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
}

TEST(Post, SignsTimeAndBody) {
  EXPECT_EQ(SignatureOf("Jefe", 17, "{}"), "sha256=" + HmacSha256("Jefe", "17.{}").str());
  EXPECT_NE(SignatureOf("Jefe", 18, "{}"), SignatureOf("Jefe", 17, "{}"));
}

TEST(Post, GoesToAddressesOfHttpOnly) {
  const std::string secret(16, 's');
  EXPECT_TRUE(CheckReceiver({"http://127.0.0.1:80/x?y=a@b", secret}));
  EXPECT_TRUE(CheckReceiver({"https://alerts.example.org", secret}));
  for (const char* url : {"file:///etc/passwd", "ftp://x", "alerts.example.org", "http://user:word@host/", "http://a b",
                          "", "http://", "https://?a", "http://h:99999/", "http://h:port/", "http://word@host/"})
    EXPECT_FALSE(CheckReceiver({url, secret})) << url;
  EXPECT_FALSE(CheckReceiver({"http://127.0.0.1/", "short"}));
}

TEST(Post, TellsThatNobodyAnswers) {
  const std::atomic<bool> stopping = false;
  const auto answer = Post({"http://127.0.0.1:1/", std::string(16, 's')}, {}, {}, stopping);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().code, ErrorCode::kUnreachable);
}

TEST(Retry, IsTwiceAsLongEachTimeUpToADay) {
  EXPECT_EQ(RetryAfter_ns(1), 1'000'000'000);
  EXPECT_EQ(RetryAfter_ns(2), 2'000'000'000);
  EXPECT_EQ(RetryAfter_ns(11), 1'024'000'000'000);
  EXPECT_EQ(RetryAfter_ns(17), 65'536'000'000'000);
  EXPECT_EQ(RetryAfter_ns(18), 86'400'000'000'000);
  EXPECT_EQ(RetryAfter_ns(1'000'000), 86'400'000'000'000);
}

}  // namespace
}  // namespace rigcal::webhook
