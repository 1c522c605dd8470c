#include "server/http/public_address.h"

#include <gtest/gtest.h>

namespace rigcal::http {
namespace {

Options At(const std::string& host) {
  Options options;
  options.host = host;
  return options;
}

TEST(PublicAddress, IsWhatWasGiven) {
  EXPECT_EQ(ReadPublicUrl("http://rigs.example.org:8420").value(), "http://rigs.example.org:8420");
  EXPECT_EQ(ReadPublicUrl("https://rigs.example.org/rigcal/").value(), "https://rigs.example.org/rigcal");
  EXPECT_EQ(ReadPublicUrl("http://[2001:db8::7]:8420/").value(), "http://[2001:db8::7]:8420");
}

TEST(PublicAddress, OfAnythingElseIsRefused) {
  for (const std::string given :
       {"", "rigs.example.org", "ftp://rigs", "http://", "https:///rigcal", "http://:8420", "http://a b",
        "http://rigs/?x=1", "http://me@rigs", "http://rigs/\"><script>", "http://rigs\x1b[2J", "HTTP://rigs"}) {
    const auto read = ReadPublicUrl(given);
    ASSERT_FALSE(read) << *read;
    EXPECT_EQ(read.error().code, ErrorCode::kInvalidInput) << given;
  }
  EXPECT_FALSE(ReadPublicUrl("http://" + std::string(2000, 'x')));
}

TEST(PublicAddress, OfAServerIsWhereItListens) {
  EXPECT_EQ(AddressOf(At("127.0.0.1"), 8420, "mars"), "http://127.0.0.1:8420");
  EXPECT_EQ(AddressOf(At("localhost"), 8420, "mars"), "http://localhost:8420");
  EXPECT_EQ(AddressOf(At("[::1]"), 8420, "mars"), "http://[::1]:8420");
  EXPECT_EQ(AddressOf(At("192.168.1.5"), 8420, "mars"), "http://192.168.1.5:8420");
}

TEST(PublicAddress, OfEveryAddressIsTheMachinesName) {
  for (const char* host : {"0.0.0.0", "[::]"}) {
    EXPECT_EQ(AddressOf(At(host), 8420, "mars"), "http://mars:8420") << host;
    EXPECT_EQ(AddressOf(At(host), 8420, ""), "http://127.0.0.1:8420") << host;
    EXPECT_EQ(AddressOf(At(host), 8420, "(none)"), "http://127.0.0.1:8420") << host;
  }
  EXPECT_NE(AddressOf(At("0.0.0.0"), 1, MachineName()), "http://0.0.0.0:1");
}

}  // namespace
}  // namespace rigcal::http
