// HTTPS: what is spoken, which files are refused, who cannot stop it.
#include <gmock/gmock.h>

#include <list>

#include "server/http/public_address.h"
#include "server/http/tls/certificate.h"
#include "server/http/tls/tls_hello.h"
#include "tests/unit/http/made_certificate.h"

namespace rigcal::http {
namespace {

using ::testing::HasSubstr;

class TlsTest : public HttpFixture {
 protected:
  int StartSecurely() {
    const MadeCertificate made(root_, "first");
    auto loaded = Certificate::Load(made.certificate, made.key);
    EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().what);
    options_.certificate = loaded.value_or(nullptr);
    return Start();
  }
  Error Refused(const std::filesystem::path& certificate, const std::filesystem::path& key) {
    const auto loaded = Certificate::Load(certificate, key);
    EXPECT_FALSE(loaded);
    return loaded ? Error{} : loaded.error();
  }
};

TEST_F(TlsTest, AnswersOverTls13AndTls12) {
  const int port = StartSecurely();
  const SecureReply newest = GetSecurely(port, "/x");
  EXPECT_EQ(newest.version, "TLSv1.3");
  EXPECT_EQ(newest.name, "first");
  EXPECT_EQ(newest.reply.body, "path /x query ");
  const SecureReply older = GetSecurely(port, "/x", "", TLS1_2_VERSION);
  EXPECT_EQ(older.version, "TLSv1.2");
  EXPECT_THAT(older.cipher, HasSubstr("ECDHE"));
  EXPECT_EQ(older.reply.status, 200);
}

// By the name localhost every other server of this machine would be asked over TLS.
TEST_F(TlsTest, BrowsersKeepToIt) {
  const int port = StartSecurely();
  const auto told = [port](const std::string& host) {
    return AskSecurely(port, "GET /x HTTP/1.1\r\nHost: " + host + "\r\n\r\n", 0)
        .reply.headers.count("strict-transport-security");
  };
  EXPECT_EQ(told("127.0.0.1:" + std::to_string(port)), 1u);
  EXPECT_EQ(told("localhost"), 0u);
  EXPECT_EQ(told("localhost:" + std::to_string(port)), 0u);
}

TEST_F(TlsTest, OlderProtocolsAreRefused) {
  const int port = StartSecurely();
  for (const int version : {TLS1_1_VERSION, TLS1_VERSION}) EXPECT_EQ(GetSecurely(port, "/x", "", version).version, "");
  EXPECT_EQ(GetSecurely(port, "/x").reply.status, 200);
}

TEST_F(TlsTest, LargeFileComesWhole) {
  const std::string large(3'000'000, 'x');
  Write("reports/mapper-01/7/large.bin", large);
  const SecureReply got = GetSecurely(StartSecurely(), "/robots/mapper-01/revisions/7/large.bin");
  EXPECT_EQ(got.reply.status, 200);
  EXPECT_TRUE(got.reply.body == large);
}

TEST_F(TlsTest, PlainHttpIsToldWhatToDo) {
  const int port = StartSecurely();
  const Reply reply = Get(port, "/");
  EXPECT_EQ(reply.status, 400);
  EXPECT_THAT(reply.body, HasSubstr("https://"));
  const Socket nonsense(port);
  nonsense.Send("\x01\x02\x03");
  EXPECT_EQ(Parsed(nonsense.ReadAll()).status, 400);
}

// The files as they are left by whoever renews certificates.
TEST_F(TlsTest, ReloadShowsTheNewCertificateAndKeepsAGoodOne) {
  const int port = StartSecurely();
  const MadeCertificate next(root_, "next");
  std::filesystem::copy_file(next.certificate, root_ / "first.pem", std::filesystem::copy_options::overwrite_existing);
  const Status half = options_.certificate->Reload();
  ASSERT_FALSE(half);
  EXPECT_THAT(half.error().what, HasSubstr("is not the key of the certificate"));
  EXPECT_EQ(GetSecurely(port, "/").name, "first");
  std::filesystem::copy_file(next.key, root_ / "first.key", std::filesystem::copy_options::overwrite_existing);
  ASSERT_TRUE(options_.certificate->Reload());
  EXPECT_EQ(GetSecurely(port, "/").name, "next");
  EXPECT_EQ(GetSecurely(port, "/", "", TLS1_2_VERSION).reply.status, 200);
}

TEST_F(TlsTest, FilesThatWillNotDoAreNamed) {
  const MadeCertificate one(root_, "one"), other(root_, "other");
  Write("nonsense.pem", "nonsense");
  EXPECT_THAT(Refused(root_ / "none.pem", one.key).what, HasSubstr("none.pem cannot be read as a certificate"));
  EXPECT_THAT(Refused(root_ / "nonsense.pem", one.key).what, HasSubstr("nonsense.pem cannot be read as a certificate"));
  EXPECT_THAT(Refused(one.key, one.key).what, HasSubstr("one.key cannot be read as a certificate"));
  EXPECT_THAT(Refused(one.certificate, root_ / "none.key").what, HasSubstr("none.key cannot be read as a private key"));
  EXPECT_THAT(Refused(one.certificate, one.certificate).what, HasSubstr("one.pem cannot be read as a private key"));
  EXPECT_THAT(Refused(one.certificate, other.key).what, HasSubstr("other.key is not the key of the certificate in"));
}

TEST_F(TlsTest, KeyOfAnotherKindOrWithPassPhraseIsRefused) {
  const MadeCertificate one(root_, "one");
  EVP_PKEY* rsa = EVP_RSA_gen(2048);
  std::FILE* file = std::fopen((root_ / "rsa.key").c_str(), "w");
  PEM_write_PrivateKey(file, rsa, nullptr, nullptr, 0, nullptr, nullptr);
  std::fclose(file);
  file = std::fopen((root_ / "locked.key").c_str(), "w");
  PEM_write_PrivateKey(file, rsa, EVP_aes_128_cbc(), nullptr, 0, nullptr, const_cast<char*>("secret"));
  std::fclose(file);
  EVP_PKEY_free(rsa);
  EXPECT_THAT(Refused(one.certificate, root_ / "rsa.key").what, HasSubstr("is not the key of the certificate"));
  EXPECT_THAT(Refused(one.certificate, root_ / "locked.key").what, HasSubstr("without a pass phrase"));
}

TEST_F(TlsTest, CertificateOutOfDateIsServedWithAWarning) {
  const MadeCertificate old(root_, "old", 1);
  testing::internal::CaptureStderr();
  EXPECT_TRUE(Certificate::Load(old.certificate, old.key));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("old.pem is out of date"));
}

// Half of them stop before the first byte, half within the first record, and then those that stop after it: these have
// the threads for a second at most.
TEST_F(TlsTest, HalfHandshakesDoNotStopIt) {
  const int port = StartSecurely();
  const std::string hello("\x16\x03\x01\x00\x04", 5);
  std::list<Socket> held;
  for (int i = 0; i < 150; ++i) held.emplace_back(port).Send(i % 2 == 0 ? "" : hello);
  EXPECT_EQ(GetSecurely(port, "/").reply.status, 200);
  const std::string half_hello("\x16\x03\x01\x00\x05\x01\x00\x02\x00\x03", 10);
  for (int i = 0; i < 100; ++i) held.emplace_back(port).Send(half_hello);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(GetSecurely(port, "/").reply.status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(6));
}

TEST(TlsHello, IsWholeWithItsRecord) {
  EXPECT_EQ(JudgeHello(""), Hello::kPartial);
  EXPECT_EQ(JudgeHello("\x16"), Hello::kPartial);
  EXPECT_EQ(JudgeHello(std::string("\x16\x03\x01\x00\x02", 5)), Hello::kPartial);
  EXPECT_EQ(JudgeHello(std::string("\x16\x03\x01\x00\x02\x01", 6)), Hello::kPartial);
  EXPECT_EQ(JudgeHello(std::string("\x16\x03\x01\x00\x02\x01\x02", 7)), Hello::kHello);
  EXPECT_EQ(JudgeHello("\x16\x02"), Hello::kPlain);
  EXPECT_EQ(JudgeHello("G"), Hello::kPlain);
}

TEST_F(TlsTest, AddressSaysHttps) {
  StartSecurely();
  EXPECT_EQ(AddressOf(options_, 8420, "rigs"), "https://127.0.0.1:8420");
}

}  // namespace
}  // namespace rigcal::http
