// What a request's path means, and text as addresses and forms carry it. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal::http {

enum class Plus { kIsPlus, kIsSpace };  // in a path; in application/x-www-form-urlencoded

// Nothing where an escape is broken: civetweb's own decoding would leave it as it is.
[[nodiscard]] std::optional<std::string> PercentDecoded(std::string_view raw, Plus plus);

// Percent-decoded, repeated slashes joined. Refuses what does not start with '/', bad escapes, control characters,
// backslashes, and any segment that starts with '.': so there is neither a parent folder nor a hidden file.
[[nodiscard]] Result<std::string> NormalPath(std::string_view raw);

// "/robots/<robot>/revisions/<number>/<file>" -> "<robot>/<number>/<file>" below the published folder ("index.html" for
// a path that ends in '/'); nothing for every other path ("latest" is no number), and for the certificate, whose copy
// there is as of when it was drawn.
[[nodiscard]] std::optional<std::string> PublishedFile(const std::string& path);

// Where a page's address lacks its last slash, without which relative links lead astray: the right address.
[[nodiscard]] std::optional<std::string> WithSlash(const std::string& path);

// The robot whose pages `path` is below, but not its own page; "" if none.
[[nodiscard]] std::string RobotAbove(const std::string& path);

// Whether programs ask there: errors are JSON and not a page.
[[nodiscard]] bool IsApi(const std::string& path);

}  // namespace rigcal::http
