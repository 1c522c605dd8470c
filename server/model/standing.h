// Which of several sessions of the same pictures counts, which edges were retired, and who said so.
#pragma once

#include <cstdint>
#include <string>

#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal {

// Who says something, when and why. The texts are one printable line of at most 500 bytes; `reason` may be empty.
struct Word {
  Stamp at;
  std::string who, reason;
};

// The word by which a session is current, or was last, or by which an edge was retired.
struct Standing {
  std::int64_t number = 0;  // order of arrival among those of all robots
  std::string how;          // "pushed" (it came whole), "pushed_again", "restored", "retired"
  Word word;
};

// A closed session by which another is superseded.
struct Superseding {
  SessionId by;
  Stamp captured_at;
  std::string operator_name;
  Standing standing;  // of `by`: since when
};

}  // namespace rigcal
