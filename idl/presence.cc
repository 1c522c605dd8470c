#include "idl/presence.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <map>
#include <set>
#include <utility>

#include "idl/discovery.h"
#include "server/base/text.h"

namespace rigcal::wire {
namespace {

constexpr std::string_view kHead = "rigcald 1\n";
constexpr std::size_t kUserDataBytesMax = 4096;
// Participants, and readers, of one domain and tag: so many are read at first, and at most.
constexpr std::uint32_t kReadFirst = 512, kReadMax = 1 << 16;
constexpr std::array<std::pair<ServerState, std::string_view>, 3> kStates = {{
    {ServerState::kClaims, "claims"},
    {ServerState::kServes, "serves"},
    {ServerState::kWaits, "waits"},
}};

std::string_view NameOfState(ServerState state) {
  for (const auto& [one, name] : kStates)
    if (one == state) return name;
  return "serves";
}

template <typename Number>
void ReadNumber(std::string_view text, Number& number) {
  std::from_chars(text.data(), text.data() + text.size(), number);
}

void TakeMember(std::string_view key, std::string_view value, ServerName& name) {
  if (!IsPrintableUtf8(value)) return;
  if (key == "id") name.id = value;
  if (key == "host") name.host = value;
  if (key == "folder") name.folder = value;
  if (key == "store") name.store = value;
  if (key == "pid") ReadNumber(value, name.pid);
  if (key == "since_ns") ReadNumber(value, name.since.ns);
  if (key != "state") return;
  for (const auto& [state, text] : kStates)
    if (text == value) name.state = state;
}

// One line, whatever a folder is called.
std::string Line(std::string_view key, std::string value) {
  std::replace(value.begin(), value.end(), '\n', ' ');
  return std::string(key) + "=" + value.substr(0, kUserDataBytesMax / 4) + "\n";
}

std::string UserDataOf(const dds_qos_t* qos) {
  void* bytes = nullptr;
  std::size_t size = 0;
  if (qos == nullptr || !dds_qget_userdata(qos, &bytes, &size)) return "";
  std::string text(static_cast<const char*>(bytes), bytes == nullptr ? 0 : size);
  dds_free(bytes);
  return text;
}

using Guid = std::array<std::uint8_t, 16>;
Guid GuidOf(const dds_guid_t& key) {
  Guid guid{};
  std::memcpy(guid.data(), key.v, guid.size());
  return guid;
}

std::string HexOf(const Guid& guid) {
  std::string text;
  for (const std::uint8_t byte : guid) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

// What is gone is kept by a reader until it is taken: a few kilobytes for every client that ever came.
void DropGone(dds_entity_t reader) {
  std::vector<void*> samples(kReadFirst, nullptr);
  std::vector<dds_sample_info_t> infos(kReadFirst);
  dds_return_t count = static_cast<dds_return_t>(kReadFirst);
  while (count == static_cast<dds_return_t>(kReadFirst)) {
    std::fill(samples.begin(), samples.end(), nullptr);
    count = dds_take_mask(reader, samples.data(), infos.data(), kReadFirst, kReadFirst,
                          DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE |
                              DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE);
    if (count > 0) dds_return_loan(reader, samples.data(), count);
  }
}

// Calls body(const Sample&) for each that is alive.
template <typename Sample, typename Body>
Status ForEachAlive(dds_entity_t reader, const Body& body, std::uint32_t max = kReadFirst) {
  std::vector<void*> samples(max, nullptr);
  std::vector<dds_sample_info_t> infos(max);
  const dds_return_t count = dds_read_mask(reader, samples.data(), infos.data(), max, max,
                                           DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
  if (count < 0)
    return Fail(ErrorCode::kInternal, std::string("DDS could not list who is there: ") + dds_strretcode(-count),
                "A fault in Rigcal or too little memory: report it with the log");
  const bool are_more = static_cast<std::uint32_t>(count) == max && max < kReadMax;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count) && !are_more; ++i)
    if (infos[i].valid_data) body(*static_cast<const Sample*>(samples[i]));
  if (count > 0) dds_return_loan(reader, samples.data(), count);
  return are_more ? ForEachAlive<Sample>(reader, body, 4 * max) : Status();
}

}  // namespace

std::string WriteServerName(const ServerName& name) {
  return std::string(kHead) + Line("id", name.id) + Line("state", std::string(NameOfState(name.state))) +
         Line("since_ns", std::to_string(name.since.ns)) + Line("host", name.host) +
         Line("pid", std::to_string(name.pid)) + Line("folder", name.folder) +
         (name.store.empty() ? "" : Line("store", name.store));
}

std::optional<ServerName> ReadServerName(std::string_view user_data) {
  if (user_data.size() > kUserDataBytesMax || user_data.substr(0, kHead.size()) != kHead) return std::nullopt;
  ServerName name;
  for (std::string_view rest = user_data.substr(kHead.size()); !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    const std::size_t equals = line.find('=');
    if (equals != std::string_view::npos) TakeMember(line.substr(0, equals), line.substr(equals + 1), name);
  }
  if (name.id.empty()) return std::nullopt;
  return name;
}

std::string TextOf(const ServerName& name) {
  if (name.host.empty() && name.since.ns != 0) return "a rigcald with an identity (server " + name.id + ")";
  if (name.host.empty()) return "an older rigcald, which does not tell where it runs";
  return "rigcald on " + name.host + " (process " + std::to_string(name.pid) + ", data in " + name.folder + ")";
}

namespace {

// Participants whose writer DDS let this reader meet.
std::set<Guid> WritersOf(const Reader<rigcal_wire_Event>& reader) {
  std::set<Guid> participants;
  for (const dds_instance_handle_t one : internal::MatchedPublications(reader.get())) {
    const std::unique_ptr<dds_builtintopic_endpoint_t, decltype(&dds_builtintopic_free_endpoint)> writer(
        dds_get_matched_publication_data(reader.get(), one), dds_builtintopic_free_endpoint);
    if (writer) participants.insert(GuidOf(writer->participant_key));
  }
  return participants;
}

std::vector<ServerName> ListOf(std::map<std::string, ServerName> servers) {
  std::vector<ServerName> list;
  for (auto& [id, name] : servers) list.push_back(std::move(name));
  return list;
}

}  // namespace

Result<ServerList> ServerList::Open(const Participant& participant) {
  RIGCAL_ASSIGN(Entity participants, OpenBuiltin(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT));
  RIGCAL_ASSIGN(Entity subscriptions, OpenBuiltin(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION));
  std::optional<Reader<rigcal_wire_Event>> proof;
  if (participant.identity() != nullptr) {
    RIGCAL_ASSIGN(proof, Reader<rigcal_wire_Event>::Open(participant, {kServersPartition}));
  }
  return ServerList(std::move(participants), std::move(subscriptions), std::move(proof));
}

Result<std::optional<Writer<rigcal_wire_Event>>> ProveServer(const Participant& participant) {
  if (participant.identity() == nullptr) return std::nullopt;
  return Writer<rigcal_wire_Event>::Open(participant, {kServersPartition});
}

Result<std::vector<ServerName>> ServerList::Load() {
  std::set<Guid> named;
  std::map<std::string, ServerName> servers;
  const std::set<Guid> proven = proof_ ? WritersOf(*proof_) : std::set<Guid>();
  for (const Entity* reader : {&participants_, &subscriptions_}) DropGone(reader->get());
  RIGCAL_TRY(ForEachAlive<dds_builtintopic_participant_t>(participants_.get(), [&](const auto& participant) {
    auto name = ReadServerName(UserDataOf(participant.qos));
    if (!name || (proof_ && proven.count(GuidOf(participant.key)) == 0)) return;
    named.insert(GuidOf(participant.key));
    // It has several participants: that it serves was said by all of them or by the newest.
    const auto [place, is_new] = servers.emplace(name->id, *name);
    if (!is_new && name->state == ServerState::kServes) place->second = std::move(*name);
  }));
  if (proof_) return ListOf(std::move(servers));
  // Older ones are known by what only a server reads.
  const std::string requests = InfoOf<rigcal_wire_Request>().name;
  RIGCAL_TRY(ForEachAlive<dds_builtintopic_endpoint_t>(subscriptions_.get(), [&](const auto& reader) {
    const Guid guid = GuidOf(reader.participant_key);
    if (reader.topic_name == nullptr || requests != reader.topic_name || named.count(guid) > 0) return;
    ServerName older;
    older.id = HexOf(guid);
    servers.emplace(older.id, std::move(older));
  }));
  return ListOf(std::move(servers));
}

}  // namespace rigcal::wire
