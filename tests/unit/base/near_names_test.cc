#include "server/base/near_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "server/base/ids.h"

namespace rigcal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Names = std::vector<std::string>;

TEST(EditDistance, CountsEachKindOfEditOnce) {
  EXPECT_EQ(EditDistance("push", "push"), 0U);
  EXPECT_EQ(EditDistance("pusch", "push"), 1U);
  EXPECT_EQ(EditDistance("psh", "push"), 1U);
  EXPECT_EQ(EditDistance("posh", "push"), 1U);
  EXPECT_EQ(EditDistance("puhs", "push"), 1U);
  EXPECT_EQ(EditDistance("", "push"), 4U);
  EXPECT_EQ(EditDistance("push", ""), 4U);
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3U);
  EXPECT_EQ(EditDistance("ca", "abc"), 3U);  // what is swapped is not edited again
}

TEST(EditDistance, CaseAloneIsOneEdit) {
  EXPECT_EQ(EditDistance("MAPPER-01", "mapper-01"), 1U);
  EXPECT_EQ(EditDistance("Maper-01", "mapper-01"), 1U);
}

TEST(EditDistance, IsAMetricUpToCase) {
  std::mt19937 random(3);
  const auto draw = [&] {
    std::string name;
    for (std::size_t i = random() % 7; i-- > 0;) name += "ab-1"[random() % 4];
    return name;
  };
  for (int i = 0; i < 2000; ++i) {
    const std::string a = draw(), b = draw();
    const std::size_t distance = EditDistance(a, b);
    EXPECT_EQ(distance, EditDistance(b, a)) << a << " " << b;
    EXPECT_EQ(distance == 0, a == b) << a << " " << b;
    EXPECT_GE(distance, std::max(a.size(), b.size()) - std::min(a.size(), b.size())) << a << " " << b;
    EXPECT_LE(distance, std::max(a.size(), b.size())) << a << " " << b;
  }
}

TEST(IsSlip, LettersSeparatorsAndZeros) {
  for (const char* name : {"maper-01", "mappper-01", "mapqer-01", "mappre-01", "mapper01", "mapper--01", "mapper_01",
                           "mapper-1", "mapper-001", "Mapper-01", "MAPPER-01", "mapper-o1", "mapper-01-"})
    EXPECT_TRUE(IsSlip(name, "mapper-01")) << name;
}

TEST(IsSlip, NotAnotherLetterSerialOrRomanNumber) {
  const std::vector<std::pair<const char*, const char*>> others = {{"robotB", "robotA"},
                                                                   {"kitchenL", "kitchenR"},
                                                                   {"mapper-ii", "mapper-i"},
                                                                   {"rig-7bc", "rig-7ba"},
                                                                   {"unit-af3b", "unit-bf3b"}};
  for (const auto& [name, known] : others) EXPECT_FALSE(IsSlip(name, known)) << name;
  EXPECT_TRUE(IsSlip("robtA", "robotA"));
  EXPECT_TRUE(IsSlip("ROBOTB", "ROBOTC")) << "no word's last capital where all are capitals";
  EXPECT_TRUE(IsSlip("mappe-ii", "mapper-ii"));
  EXPECT_TRUE(IsSlip("unti-af3b", "unit-af3b"));
}

TEST(IsSlip, NotTheNextOfASeries) {
  for (const char* name : {"mapper-01", "mapper-02", "mapper-11", "mapper-010", "mapper-10", "mapper-0", "mapper-",
                           "mapper-012", "mapper-0-1", "mapper", "maper-02", "rover-01"})
    EXPECT_FALSE(IsSlip(name, "mapper-01")) << name;
  EXPECT_FALSE(IsSlip("arm-a", "arm-b"));
  EXPECT_FALSE(IsSlip("unit-A7", "unit-B7"));
  EXPECT_TRUE(IsSlip("unit-A7", "unit-a7"));
  EXPECT_TRUE(IsSlip("arm-left", "arm-lest"));
}

TEST(IsSlip, NotOfShortNames) {
  EXPECT_FALSE(IsSlip("rig", "ring"));
  EXPECT_FALSE(IsSlip("a", "b"));
  EXPECT_TRUE(IsSlip("ring", "rings"));
}

TEST(NearestNames, AreThoseWithTheFewestEdits) {
  const Names verbs = {"push", "push-edges", "robots", "sessions", "show", "status"};
  EXPECT_THAT(NearestNames("pusch", verbs), ElementsAre("push"));
  EXPECT_THAT(NearestNames("shwo", verbs), ElementsAre("show"));
  EXPECT_THAT(NearestNames("sesions", verbs), ElementsAre("sessions"));
  EXPECT_THAT(NearestNames("pushedges", verbs), ElementsAre("push-edges"));
  EXPECT_THAT(NearestNames("frobnicate", verbs), IsEmpty());
  EXPECT_THAT(NearestNames("shut", verbs), IsEmpty()) << "of four characters one edit is the limit";
  EXPECT_THAT(NearestNames("", verbs), IsEmpty());
  EXPECT_THAT(NearestNames("xy", Names({"xz"})), IsEmpty()) << "of two characters every edit makes another name";
}

TEST(NearestNames, SlipsGoBeforeNeighboursInASeries) {
  Names fleet;
  for (int i = 1; i < 100; ++i) fleet.push_back((i < 10 ? "mapper-0" : "mapper-") + std::to_string(i));
  EXPECT_THAT(NearestNames("mapper-1", fleet), ElementsAre("mapper-01"));
  EXPECT_THAT(NearestNames("maper-17", fleet), ElementsAre("mapper-17"));
  EXPECT_THAT(NearestNames("mapper-117", fleet), ElementsAre("mapper-11", "mapper-17"));
  EXPECT_THAT(NearestNames("mapper-x", fleet), IsEmpty()) << "as near to all of them";
}

TEST(Suggestion, IsTheEndOfASentence) {
  EXPECT_EQ(Suggestion(Names{}), "");
  EXPECT_EQ(Suggestion(Names{"mapper-01"}), ": did you mean mapper-01?");
  EXPECT_EQ(Suggestion(Names{"a", "b"}), ": did you mean a or b?");
  EXPECT_EQ(Suggestion(Names{"a", "b", "c"}), ": did you mean a, b or c?");
}

// The oracle is the distance: every name that it puts one edit away is listed, whatever the edit.
TEST(NamesOneEditAway, AreAllOfThem) {
  const std::string name = "mAp-01";
  const Names listed = NamesOneEditAway(name);
  const std::set<std::string> away(listed.begin(), listed.end());
  for (const std::string& one : away) EXPECT_LE(EditDistance(name, one), 1U) << one;
  std::mt19937 random(5);
  const std::string characters = "abmpAMP0123-_.";
  for (int i = 0; i < 20'000; ++i) {
    std::string other = name;
    const std::size_t at = random() % other.size();
    switch (random() % 4) {
      case 0:
        other.erase(at, 1);
        break;
      case 1:
        other[at] = characters[random() % characters.size()];
        break;
      case 2:
        other.insert(at, 1, characters[random() % characters.size()]);
        break;
      default:
        if (at + 1 < other.size()) std::swap(other[at], other[at + 1]);
    }
    EXPECT_TRUE(other == name || away.contains(other)) << other;
  }
  EXPECT_TRUE(away.contains("map-01") && away.contains("MAP-01"));
  EXPECT_LT(listed.size(), 131 * (name.size() + 1));
}

}  // namespace
}  // namespace rigcal
