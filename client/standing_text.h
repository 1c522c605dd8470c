// Which of several sessions of the same pictures counts, for people.
#pragma once

#include <ostream>
#include <string>

#include "client/document.h"

namespace rigcal::client {

// `session`: a row of docs/api.md, sessions.
[[nodiscard]] bool IsSuperseded(const Document& session);
// "Session A does not count: session B supersedes it ..." or "Session A is current ..."; how to take it back.
[[nodiscard]] std::string StandingText(const Document& session);
// The same, unless the session neither supersedes nor is superseded.
void SayStanding(const Document& session, std::ostream& out);

}  // namespace rigcal::client
