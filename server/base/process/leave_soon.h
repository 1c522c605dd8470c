// The end of a process that works for longer than whoever stops it may wait.
#pragma once

namespace rigcal {

// All that counts is on disk, so a calibration that is under way after 20 s is left: the next start does it anew.
void LeaveSoon();

}  // namespace rigcal
