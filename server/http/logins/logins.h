// What the server asks about people and programs: as long as nobody may log in, nobody needs to.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/base/result.h"
#include "server/base/role.h"

namespace rigcal::http {

struct Person {
  std::string name;
  Role role = Role::kViewer;
  // Of the server of a site: which robots it may send on (base/site_robots.h). It may do nothing else, whatever `role`
  // says.
  std::string robots = {};
  [[nodiscard]] bool is_site() const { return !robots.empty(); }
};

// Called from server threads, several at once. Empty ones: there are no logins.
struct Logins {
  // Whether pages and answers need one.
  std::function<Result<bool>()> are_needed = {};
  // Whose session, or which program's token, this secret is; nothing: nobody's.
  std::function<Result<std::optional<Person>>(const std::string&secret)> of_session = {}, of_token = {};
  // The secret of a new session; nothing where there is no such name with this password. kBusy: ask again soon.
  std::function<Result<std::optional<std::string>>(const std::string& name, const std::string& password)> begin = {};
  std::function<Status(const std::string& secret)> end = {};  // of a session
};

// What people and programs ask to be changed, likewise. Empty ones: there are no orders.
struct Orders {
  // Who may give it; nothing: there is no such order.
  std::function<std::optional<Role>(const std::string& verb)> role_of = {};
  // The document that answers it, once what it asks for is on disk; under the name of `person`.
  std::function<Result<std::string>(const std::string& verb, const std::string& json, const Person& person)> give = {};
};

// What the server of a site asks, below /api/v1/forward/: it sends on what robots pushed there.
struct SiteRequest {
  Person site;
  std::string method;           // GET, HEAD, POST or PUT
  std::string path;             // behind /api/v1/forward, "" or from its slash on
  std::int64_t body_bytes = 0;  // as the head says
  // The next bytes of the body, up to so many; none at its end. An error where they do not come.
  std::function<Result<std::string>(std::size_t bytes_max)> read = {};
  std::string query = {};  // behind the '?'
};
// The document that answers it. Called from server threads, several at once. An empty one: there is no such thing here.
using AnswerSite = std::function<Result<std::string>(const SiteRequest& request)>;

}  // namespace rigcal::http
