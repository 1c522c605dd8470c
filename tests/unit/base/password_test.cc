// Passwords as they are kept, secrets, roles.
#include "server/base/digests/password.h"

#include <gtest/gtest.h>

#include <set>

#include "server/base/digests/secret.h"
#include "server/base/role.h"

namespace rigcal {
namespace {

// Computed with hashlib.scrypt of Python 3.11: n=2**15, r=8, p=1, salt b"0123456789abcdef", dklen=32.
constexpr const char* kKnown = "scrypt$15$8$1$MDEyMzQ1Njc4OWFiY2RlZg==$xxaWgqTSKTdh7WrfWLps/DMbPoovZsowrLVRbAkJkjA=";

TEST(Password, HashOfAnotherProgramIsRead) {
  EXPECT_TRUE(IsPassword("correct horse battery", kKnown));
  EXPECT_FALSE(IsPassword("correct horse batterx", kKnown));
}

TEST(Password, IsItselfAndNoOther) {
  const std::string hash = HashOfPassword("correct horse battery");
  EXPECT_TRUE(IsPassword("correct horse battery", hash));
  EXPECT_FALSE(IsPassword("correct horse battery ", hash));
  EXPECT_FALSE(IsPassword("", hash));
  EXPECT_NE(hash, HashOfPassword("correct horse battery"));  // another salt
  EXPECT_EQ(hash.find("horse"), std::string::npos);
}

TEST(Password, WhatIsNoHashIsNobodys) {
  for (const std::string hash :
       {"", "scrypt", "scrypt$15$8$1$$", "md5$15$8$1$MDEy$MDEy", "scrypt$0$8$1$MDEy$MDEy", "scrypt$20$32$1$MDEy$MDEy",
        "scrypt$15$8$1$?$?", "scrypt$15$8$1$MDEy$MDEy$MDEy", "scrypt$-1$8$1$MDEy$MDEy"})
    EXPECT_FALSE(IsPassword("", hash)) << hash;
}

TEST(Password, ShortOnesAndControlCharactersAreRefused) {
  EXPECT_TRUE(CheckPassword("twelve chars"));
  EXPECT_TRUE(
      CheckPassword("Stra\xc3\x9f"
                    "enbahn 7"));
  EXPECT_FALSE(CheckPassword("eleven char"));
  EXPECT_FALSE(CheckPassword("twelve\tchars"));
  EXPECT_FALSE(CheckPassword(std::string(kPasswordBytesMax + 1, 'a')));
}

TEST(Secret, IsNewEachTime) {
  std::set<std::string> secrets;
  for (int i = 0; i < 100; ++i) secrets.insert(NewSecret());
  EXPECT_EQ(secrets.size(), 100U);
  for (const std::string& one : secrets) EXPECT_EQ(one.size(), 64U);
  EXPECT_TRUE(IsSameSecret("abc", "abc"));
  EXPECT_FALSE(IsSameSecret("abc", "abd"));
  EXPECT_FALSE(IsSameSecret("abc", "abcd"));
}

TEST(Role, MayDoWhatThoseBeforeItMay) {
  for (const Role has : kRoles)
    for (const Role wanted : kRoles)
      EXPECT_EQ(MayActAs(has, wanted), static_cast<int>(has) >= static_cast<int>(wanted));
  for (const Role role : kRoles) EXPECT_EQ(RoleOf(NameOf(role)).value(), role);
  EXPECT_EQ(NameOf(Role::kApprover), "approver");
  EXPECT_FALSE(RoleOf("root"));
  EXPECT_FALSE(RoleOf(""));
}

}  // namespace
}  // namespace rigcal
