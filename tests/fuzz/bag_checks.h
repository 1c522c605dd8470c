// What must hold of a bag whatever is in its file.
#pragma once

#include <memory>

#include "client/bags/bag.h"
#include "client/bags/messages/definition.h"
#include "client/bags/messages/header.h"
#include "tests/fuzz/fuzz.h"

namespace rigcal::fuzz {

constexpr std::size_t kDecodedMax = 64;  // messages of one input

// Reads it to its end, decodes the first messages, and judges what it says of its damage.
inline void CheckBag(const Result<std::unique_ptr<bags::Bag>>& opened) {
  if (!RequireGoodError(opened)) return;
  bags::Bag& bag = **opened;
  std::size_t count = 0;
  for (bags::Message message; bag.Next(message); ++count) {
    Require(message.topic != nullptr, "a message has a topic");
    if (count >= kDecodedMax) continue;
    const auto definition = bags::DefinitionOf(*message.topic);
    if (!RequireGoodError(definition)) continue;
    RequireGoodError(bags::Decode(*message.topic, **definition, message.bytes));
    RequireGoodError(bags::ReadHeader(*message.topic, **definition, message.bytes));
  }
  bags::Message none;
  Require(!bag.Next(none), "the end stays the end");
  for (const Error& error : bag.Unread().All()) RequireError(error);
}

}  // namespace rigcal::fuzz
