// Where a revision is in its life, and which one its robot is to use, in words. Of a server of before: nothing.
#pragma once

#include <ostream>
#include <string>

#include "client/text/document.h"

namespace rigcal::client {

// "In use: revision 3 (approved by policy, 3 Nov 2026); this one is a candidate: `rigcal approve rig 4 --reason TEXT`",
// on a line of its own, where it is another one than that of `document`, which has `robot`, `revision`, `state`,
// `decision` and `in_use`.
void PrintApproval(const Document& document, std::ostream& out);
// Of a row of robots: "A candidate: revision 3 is in use."; empty where its revision is in use, or is not usable.
[[nodiscard]] std::string InUseText(const Document& row);
// What the robot runs instead: "It runs revision 3; revision 5 is in use: not applied yet."; empty where it runs what
// is in use, or never told. `document`: one that has `runs`.
[[nodiscard]] std::string RunsText(const Document& document);
// Of an answer to approve, reject, rollback: "Revision 4 of rig was approved by Ada: checked. It is in use now."
[[nodiscard]] std::string DecidedText(const Document& done);

}  // namespace rigcal::client
