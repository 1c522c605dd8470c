#include "client/push/await_result.h"

#include <algorithm>

#include "client/wire/transfer.h"

namespace rigcal::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kAskEvery(1000);
constexpr milliseconds kAnswerWithin(5000);
constexpr milliseconds kPublishWithin(30'000);

bool HoldsAll(const Document& revision, const std::set<std::string>& wanted) {
  std::set<std::string> missing = wanted;
  for (const Document& edge : revision["edges"].Items()) missing.erase(edge["id"].Text());
  return missing.empty();
}

}  // namespace

struct ResultWatch::State {
  AwaitPlace place;
  const AwaitHooks& hooks;
  Awaited result;
  std::set<std::string> seen = {};        // edges that were told
  std::set<std::int64_t> published = {};  // revisions, by event
  bool jobs_done = false, finished = false;
  bool ask_now = true;
  std::int64_t waiting = 0, total = 0;  // jobs of the session
  std::int64_t looked_at_revision = 0;  // it does not hold all the edges
  std::int64_t settled_revision = 0;    // likewise, and no edge waited for another when it was looked at
  std::size_t looked_for = 0;           // that many edges
};

ResultWatch::ResultWatch(Connection connection, wire::Reader<rigcal_wire_Event> events, wire::WaitSet waitset)
    : connection_(std::move(connection)), events_(std::move(events)), waitset_(std::move(waitset)) {}

Result<ResultWatch> ResultWatch::Open(const wire::Participant& participant, const wire::ParticipantOptions& dds,
                                      const RobotId& robot) {
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, dds));
  RIGCAL_ASSIGN(auto events, wire::Reader<rigcal_wire_Event>::Open(participant, {wire::RobotPartition(robot)}));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(events.get()));
  return ResultWatch(std::move(connection), std::move(events), std::move(waitset));
}

void ResultWatch::NoteEdge(const Document& edge, State& state) {
  const std::string id = edge["id"].Text();
  if (id.empty() || !state.seen.insert(id).second) return;
  state.place.edges.insert(id);
  ++(edge["state"].Text() == "failed" ? state.result.failed_pairs : state.result.good_pairs);
  if (state.hooks.on_edge) state.hooks.on_edge(edge);
}

void ResultWatch::TakeEvent(const rigcal_wire_Event& event, State& state) const {
  const std::string kind = event.kind;
  const auto data = Document::Parse(event.json ? event.json : "", "an event");
  if (!data) return;
  if (kind == "edge" && !state.place.session.empty()) {
    const Document edge = (*data)["edge"].IsNull() ? *data : (*data)["edge"];
    if (edge["session"].Text() != state.place.session.str()) return;
    state.waiting = (*data)["jobs_waiting"].Integer().value_or(state.waiting);
    state.total = (*data)["jobs_total"].Integer().value_or(state.total);
    NoteEdge(edge, state);
  }
  if (kind == "published") state.published.insert((*data)["revision"].Integer().value_or(0));
  if (kind == "revision") state.ask_now = true;
}

Status ResultWatch::TakeEvents(State& state, milliseconds timeout) {
  RIGCAL_TRY(waitset_.Wait(timeout));
  RIGCAL_TRY(
      events_.Take(1024, [&](const rigcal_wire_Event& event, const wire::SampleOrigin&) { TakeEvent(event, state); }));
  return {};
}

// The session's own list of edges: what an event did not tell is told by it.
Status ResultWatch::AskSession(State& state) {
  if (state.place.session.empty()) state.jobs_done = true;
  if (state.jobs_done) return {};
  RIGCAL_ASSIGN(const Document document,
                connection_.AskDocument("session", JsonObject({{"id", state.place.session.str()}}), kAnswerWithin));
  const Document session = document["session"];
  state.result.session = session;
  state.result.retired_sensors = document["retired_sensors"];
  state.place.standing = std::max(state.place.standing, session["standing"]["number"].Integer().value_or(0));
  state.waiting = session["jobs_waiting"].Integer().value_or(0);
  state.total = session["jobs_total"].Integer().value_or(0);
  for (const Document& edge : document["edges"].Items()) NoteEdge(edge, state);
  state.jobs_done = state.waiting == 0;
  return {};
}

// `show` may be megabytes: it is asked for only when there is a revision that was not looked at.
Status ResultWatch::AskRevision(State& state) {
  const std::string robot = state.place.robot.str();
  RIGCAL_ASSIGN(state.result.status, connection_.AskDocument("status", JsonObject({{"robot", robot}}), kAnswerWithin));
  const Document rows = state.result.status["robots"];
  RIGCAL_TRY(LookAt(rows.size() > 0 ? rows[0]["revision"].Integer().value_or(0) : 0, state));
  const std::string given_up = rows.size() > 0 ? rows[0]["given_up"].Text() : "";
  if (state.finished || given_up.empty()) return {};
  return Fail(ErrorCode::kInternal, "the result of robot '" + robot + "' could not be worked out",
              given_up + " What was sent is kept.");
}

// Whether the newest revision holds what is waited for, unless it was asked that before.
Status ResultWatch::LookAt(std::int64_t newest, State& state) {
  if (newest == 0 || (newest == state.looked_at_revision && state.looked_for == state.place.edges.size())) return {};
  const std::string robot = state.place.robot.str();
  RIGCAL_ASSIGN(state.result.show_text,
                connection_.Ask("show", JsonObject({{"robot", robot}, {"revision", newest}}), kAnswerWithin));
  RIGCAL_ASSIGN(state.result.show, Document::Parse(state.result.show_text, "the server's answer to 'show'"));
  state.looked_at_revision = newest;
  state.looked_for = state.place.edges.size();
  const Document revision = state.result.show["document"];
  // What is old stands in a merged edge, and what failed in it nowhere: then the newest revision has all, once no edge
  // waits for another. It is the newest if it still is at the next look.
  const bool settled = !state.result.show["calculating"].Flag(), again = settled && state.settled_revision == newest;
  state.settled_revision = settled ? newest : 0;
  state.result.has_revision = state.finished =
      (again || HoldsAll(revision, state.place.edges)) &&
      state.result.show["standing"].Integer().value_or(0) >= state.place.standing &&
      revision["policy"]["versions"]["robot"].Integer().value_or(0) >= state.place.policy;
  if (settled && !state.finished) state.looked_at_revision = 0;
  return {};
}

Status ResultWatch::AskAll(State& state) {
  state.ask_now = false;
  RIGCAL_TRY(AskSession(state));
  if (!state.jobs_done) return {};
  if (!state.place.session.empty() && state.place.edges.empty()) {
    state.finished = true;
    return {};
  }
  return AskRevision(state);
}

// The report's files follow the revision. The event comes after the answer that says they are not there yet.
Status ResultWatch::AwaitPublished(State& state) {
  if (!state.result.has_revision || state.result.show["published"].Flag(true)) return {};
  const std::int64_t until_ns = SteadyNow_ns() + std::chrono::nanoseconds(kPublishWithin).count();
  while (state.published.count(state.looked_at_revision) == 0 && SteadyNow_ns() < until_ns)
    RIGCAL_TRY(TakeEvents(state, milliseconds(200)));
  state.result.report_is_drawn = state.published.contains(state.looked_at_revision);
  return {};
}

Result<Awaited> ResultWatch::Await(AwaitPlace place, const AwaitHooks& hooks) {
  State state{std::move(place), hooks, {}};
  std::int64_t answered_ns = SteadyNow_ns();
  std::int64_t asked_ns = 0;
  while (!state.finished) {
    const std::int64_t now_ns = SteadyNow_ns();
    if (state.ask_now || now_ns - asked_ns >= std::chrono::nanoseconds(kAskEvery).count()) {
      asked_ns = now_ns;
      const Status asked = AskAll(state);
      RIGCAL_TRY(connection_.CheckOneServer());
      if (asked) answered_ns = SteadyNow_ns();
      if (!asked && asked.error().code != ErrorCode::kUnreachable) return Fail(asked.error());
      if (!asked && SteadyNow_ns() - answered_ns >= state.place.give_up_ns)
        return Fail(UnreachableError(state.place.where, milliseconds(state.place.give_up_ns / 1'000'000)));
      if (!asked && hooks.say)
        hooks.say("No rigcald answers on " + state.place.where + ". Still trying; nothing is lost.");
    }
    if (state.total > 0 && hooks.on_pairs) hooks.on_pairs(state.total - state.waiting, state.total);
    if (!state.finished) RIGCAL_TRY(TakeEvents(state, milliseconds(200)));
  }
  RIGCAL_TRY(AwaitPublished(state));
  return std::move(state.result);
}

}  // namespace rigcal::client
