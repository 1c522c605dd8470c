// What supersedes what where robots pushed it. A centre numbers sessions as they come, and a site may send one late
// that was corrected since: the correction, which came first, is to stay current.
#pragma once

#include <vector>

#include "server/base/ids.h"
#include "storage/store.h"

namespace rigcal::storage {

inline constexpr std::size_t kSupersedingMax = 16;

// At the site: which sessions supersede this one, whole ones alone; of many the kSupersedingMax that came last.
[[nodiscard]] Result<std::vector<SessionId>> LoadSuperseding(Store& store, const SessionId& session);

// At the centre, of a session that is stored and not whole: all that supersedes it at the site, whatever was noted
// before. CloseSession lets those of them that are whole by then stay current (KeepSuperseding, sessions/standing.h).
// Those of the same robot that share a file with it repeat it, however few those files are.
[[nodiscard]] Status NoteSuperseding(Store& store, const SessionId& session, const std::vector<SessionId>& by);
// Whether anything was noted of a session; it is no longer.
[[nodiscard]] Result<bool> TakeSupersedingNoted(Store& store, const SessionId& session);

}  // namespace rigcal::storage
