// Things by their name: a value of an enumeration by its spelling in documents, one of a list by its id, two sensors in
// a row of a document. For server/model/*.cc.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/base/text.h"

namespace rigcal {

// That of `all` whose NameOf it is; kInvalidInput for any other name. `what`: "sensor kind"; `cure`: which there are.
template <typename Value>
[[nodiscard]] Result<Value> ValueNamed(const std::string& name, std::initializer_list<Value> all,
                                       const std::string& what, const std::string& cure) {
  for (const Value value : all)
    if (NameOf(value) == name) return value;
  return Fail(ErrorCode::kInvalidInput, what + " " + Quoted(name) + " is not known", cure);
}

// Null: there is none of that id.
template <typename Thing, typename Id>
[[nodiscard]] const Thing* FindById(const std::vector<Thing>& things, const Id& id) {
  const auto found = std::find_if(things.begin(), things.end(), [&](const Thing& thing) { return thing.id == id; });
  return found == things.end() ? nullptr : &*found;
}

// Whether a pair under `list` names two different sensors for which `has` holds. `kind`, "a sensor of the model", and
// `cure` tell which those are.
template <typename Pair, typename Has>
[[nodiscard]] Status CheckPairIn(const std::string& list, const Pair& pair, const Has& has, const std::string& kind,
                                 const std::string& cure) {
  const std::string title = list + ": [" + pair.a.str() + ", " + pair.b.str() + "]: ";
  for (const auto& id : {pair.a, pair.b})
    if (!has(id)) return Fail(ErrorCode::kInvalidInput, title + Quoted(id.str()) + " is not " + kind, cure);
  if (pair.a != pair.b) return {};
  return Fail(ErrorCode::kInvalidInput, title + "a sensor is no pair with itself", "Name two different sensors.");
}

}  // namespace rigcal
