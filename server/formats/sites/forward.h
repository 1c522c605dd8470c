// What the server of a site and its centre tell each other (docs/api.md, forward).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/ids.h"
#include "server/base/result.h"
#include "server/base/stamp.h"
#include "server/model/edges/edge.h"
#include "server/model/robots/forward_state.h"

namespace rigcal::formats {

inline constexpr std::size_t kEdgeSliceBytesMax = 32u << 20;

// Some edges of a batch, each with its place in it.
struct EdgeSlice {
  RobotId robot;
  std::int64_t count = 0;  // of the whole batch
  std::vector<std::pair<std::int64_t, Edge>> items;
};
// The numbers are read back bit for bit, but -0.0 as 0.0.
[[nodiscard]] std::string WriteEdgeSlice(const EdgeSlice& slice);
// Bounded; the edges are validated one by one, their ids are not looked at.
[[nodiscard]] Result<EdgeSlice> ReadEdgeSlice(std::string_view text);

// What of a session or a batch the centre has on its disk.
struct ForwardReceipt {
  bool is_whole = false;
  std::vector<Digest> missing = {};  // of a session that is not: contents that are still to be sent
};
[[nodiscard]] std::string WriteForwardReceipt(const ForwardReceipt& receipt);
[[nodiscard]] Result<ForwardReceipt> ReadForwardReceipt(std::string_view text);

// By which sessions one is superseded at the site, as what follows its address: "?superseded_by=<id>,<id>", or nothing.
[[nodiscard]] std::string WriteSupersededBy(const std::vector<SessionId>& by);
// Of what follows the '?'. A centre that knows nothing of it passes it over, as this does with anything else.
[[nodiscard]] Result<std::vector<SessionId>> ReadSupersededBy(std::string_view query);

// Which robots a site asks about: {"robots": [ids]}. Bounded.
inline constexpr std::size_t kRobotsAskedMax = 10'000, kRobotsAskedBytesMax = 1u << 20;
[[nodiscard]] std::string WriteRobotsAsked(const std::vector<RobotId>& robots);
[[nodiscard]] Result<std::vector<RobotId>> ReadRobotsAsked(std::string_view text);

// A word that was said at the centre.
struct WordAtCentre {
  RobotId robot;
  Digest digest;  // of the revision's document
  Stamp at;
  std::string who, reason;
  std::string how = "approved";  // as Decision::how
};
// By which words calibrations are in use at the centre, and by which they are rejected there.
struct WordsAtCentre {
  std::vector<WordAtCentre> in_use, rejected = {};
};
[[nodiscard]] std::string WriteWordsAtCentre(const WordsAtCentre& words);
// What a centre of before does not tell: `how`, which is "approved" then, and what is rejected.
[[nodiscard]] Result<WordsAtCentre> ReadWordsAtCentre(std::string_view text);

// What a site's server says of it; of one that is no site's every member but the counts is null.
[[nodiscard]] std::string WriteForwardState(const std::optional<ForwardState>& state);

// The error that a server answered with, as {"error": {code, what, cure}}; nothing else is one: kUnreachable says so.
[[nodiscard]] Error ReadErrorDocument(std::string_view text);

}  // namespace rigcal::formats
