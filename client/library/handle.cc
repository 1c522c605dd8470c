#include "client/library/handle.h"

#include <algorithm>
#include <cmath>

#include "client/verb.h"
#include "server/base/version.h"

namespace rigcal::client {
namespace {

static_assert(RIGCAL_INVALID_INPUT == static_cast<int>(ErrorCode::kInvalidInput) + 1);
static_assert(RIGCAL_UNREACHABLE == static_cast<int>(ErrorCode::kUnreachable) + 1);
static_assert(RIGCAL_INTERNAL == static_cast<int>(ErrorCode::kInternal) + 1);

Status OpenClient(rigcal_client& client) {
  RIGCAL_ASSIGN(client.participant, wire::Participant::Open(client.dds));
  RIGCAL_ASSIGN(client.connection, Connection::Open(*client.participant, client.dds));
  return {};
}

bool FillNumbers(const Document& list, std::size_t count, double* to) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = list[i].Number();
    if (!number) return false;
    to[i] = *number;
  }
  return true;
}

Status LookUp(rigcal_client& client, const std::vector<Field>& parameters, rigcal_pose& pose,
              rigcal_standing* standing) {
  RIGCAL_ASSIGN(client.text, client.connection->Ask("lookup", JsonObject(parameters), client.timeout));
  RIGCAL_ASSIGN(const Document told, Document::Parse(client.text, "the server's answer to 'lookup'"));
  pose = PoseOf(told["T_a_b"], told["covariance"]);
  if (standing != nullptr) *standing = StandingOf(client, told["verdict"]["level"], told);
  return {};
}

}  // namespace

int Conclude(rigcal_client& client, const Status& done) {
  if (done) return RIGCAL_GOOD;
  client.error = Sentence(done.error());
  return static_cast<int>(done.error().code) + 1;
}

std::chrono::milliseconds MillisecondsOf(double duration_s) {
  constexpr double kWeek_s = 604'800.0;
  return std::chrono::milliseconds(std::isnan(duration_s) ? 0
                                                          : std::llround(1e3 * std::clamp(duration_s, 0.0, kWeek_s)));
}

rigcal_pose PoseOf(const Document& T, const Document& covariance) {
  rigcal_pose pose{};
  bool whole = FillNumbers(T["p_m"], 3, pose.p_m) && FillNumbers(T["q_xyzw"], 4, pose.q_xyzw);
  for (std::size_t row = 0; row < 6; ++row) whole = whole && FillNumbers(covariance[row], 6, pose.covariance + 6 * row);
  pose.known = 1;
  return whole ? pose : rigcal_pose{};
}

rigcal_standing StandingOf(rigcal_client& client, const Document& level, const Document& told) {
  client.verdict = level.Text("unknown");
  client.drive_rule = DriveText(told);
  return {told["revision"].Integer().value_or(0), client.verdict.c_str(), client.drive_rule.c_str()};
}

}  // namespace rigcal::client

using namespace rigcal;          // NOLINT: the functions below are C's, in no namespace
using namespace rigcal::client;  // NOLINT

extern "C" {

const char* rigcal_version(void) {
  static const std::string version(Version());
  return version.c_str();
}

rigcal_client* rigcal_open(const rigcal_options* options) {
  auto* client = new rigcal_client{};
  client->dds.apart = true;  // the program may use Cyclone itself
  if (options != nullptr) {
    client->dds.domain = options->domain;
    client->dds.tag = TextOf(options->tag);
    if (options->timeout_s > 0.0) client->timeout = MillisecondsOf(options->timeout_s);
  }
  (void)Guarded(*client, [&] { return client->opened = OpenClient(*client); });
  return client;
}

void rigcal_close(rigcal_client* client) { delete client; }

const char* rigcal_error(const rigcal_client* client) { return client->error.c_str(); }

const char* rigcal_text(const rigcal_client* client) { return client->text.c_str(); }

int rigcal_ask(rigcal_client* client, const char* verb, const char* json) {
  return Guarded(*client, [&]() -> Status {
    RIGCAL_ASSIGN(client->text, client->connection->Ask(TextOf(verb), json == nullptr ? "{}" : json, client->timeout));
    return {};
  });
}

int rigcal_lookup(rigcal_client* client, const char* robot, const char* a, const char* b, int64_t revision,
                  rigcal_pose* T_a_b, rigcal_standing* standing) {
  return Guarded(*client, [&] {
    std::vector<Field> parameters = {{"robot", TextOf(robot)}, {"a", TextOf(a)}, {"b", TextOf(b)}};
    if (revision > 0) parameters.emplace_back("revision", std::int64_t{revision});
    return LookUp(*client, parameters, *T_a_b, standing);
  });
}

}  // extern "C"
