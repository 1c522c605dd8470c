#include <malloc.h>

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <map>

#include "idl/dds.h"
#include "idl/reach.h"
#include "idl/security.h"
#include "idl_default_xml.h"
#include "server/base/log.h"

namespace rigcal::wire {
namespace {

constexpr int kDomainMax = 230;     // above it the UDP ports of DDSI run out
constexpr int kApart = 1000;        // added to the number that a domain has in this process, not on the network
constexpr int kApartSecured = 115;  // the same, round kDomainMax: permissions are for domains up to that
constexpr std::chrono::minutes kSameLineAfter{1};
constexpr std::size_t kLinesRemembered = 256;

// One Cyclone domain of this process; participants of the same id share it.
struct Domain {
  Entity entity;
  std::string tag;
  int network = 0;
};

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Cyclone refuses an interface that is named twice, and picks loopback itself where nothing else is up.
std::string Configuration(int number, const std::string& tag) {
  std::string text(kdefault_xml);
  text.erase(text.find_last_not_of(" \n") + 1);
  text += ",<CycloneDDS><Domain Id=\"any\"><General><Interfaces>";
  const bool only_here = IsOnlyHere();
  text += only_here ? "<NetworkInterface name=\"lo\"/>" : "<NetworkInterface autodetermine=\"true\"/>";
  if (!only_here && HasNetwork()) text += "<NetworkInterface name=\"lo\" presence_required=\"false\"/>";
  text += "</Interfaces></General><Discovery><Tag>" + tag + "</Tag>";
  text += "<ExternalDomainId>" + std::to_string(number) + "</ExternalDomainId></Discovery></Domain></CycloneDDS>";
  return text;
}

// Why DDS refused what this thread asked of it last.
thread_local std::string refused_because;

// Who is not let in tries again every second, for as long as it is there.
bool WasSaidJustNow(const std::string& text) {
  using Time = std::chrono::steady_clock::time_point;
  static std::mutex mutex;
  static std::map<std::string, Time> said;
  const std::lock_guard lock(mutex);
  const Time now = std::chrono::steady_clock::now();
  if (said.size() >= kLinesRemembered) said.clear();
  const auto [place, is_new] = said.emplace(text, now);
  if (!is_new && now - place->second < kSameLineAfter) return true;
  place->second = now;
  return false;
}

void LogLine(void*, const dds_log_data_t* data) {
  std::string text(data->message, data->size);
  text.erase(text.find_last_not_of(" \n") + 1);
  const bool is_warning = (data->priority & DDS_LC_WARNING) != 0;
  if (!is_warning) refused_because = text;
  const bool is_refusal = text.find("handshake") != std::string::npos;  // of somebody whose identity is no good
  if (!WasSaidJustNow(text)) Log(is_warning && !is_refusal ? LogLevel::kDebug : LogLevel::kWarn, "dds: " + text);
}

// Samples of 1 MiB come and go. By default glibc maps and unmaps each of them, and the page faults cost half of the
// throughput; so freed memory of that size is kept.
void KeepFreedSamples() {
  constexpr int kMapFrom_bytes = 16 << 20;
  constexpr int kTrimFrom_bytes = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kMapFrom_bytes);
  mallopt(M_TRIM_THRESHOLD, kTrimFrom_bytes);
}

Result<int> DomainNumber(const ParticipantOptions& options) {
  const std::string text = options.as_given ? "" : Variable("RIGCAL_DOMAIN");
  int number = options.domain;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  const bool bad = !text.empty() && (read.ptr != end || read.ec != std::errc());
  if (bad || number < 0 || number > kDomainMax)
    return Fail(ErrorCode::kInvalidInput,
                "DDS domain '" + (text.empty() ? std::to_string(number) : text) + "' is not in 0..230",
                "Set RIGCAL_DOMAIN (or --domain) to a whole number from 0 to 230, the same for server and clients");
  return number;
}

Result<std::string> DiscoveryTag(const ParticipantOptions& options) {
  const std::string variable = options.as_given ? "" : Variable("RIGCAL_DDS_TAG");
  std::string tag = options.tag.empty() ? variable : options.tag;
  if (!tag.empty()) RIGCAL_TRY(CheckName("DDS tag", tag));
  return tag;
}

// A domain on the network, and its number in this process.
struct DomainNumbers {
  int network = 0, here = 0;
};

// Null where CYCLONEDDS_URI rules: then Cyclone makes the domain itself.
Result<std::shared_ptr<Domain>> SharedDomain(const DomainNumbers& numbers, const std::string& tag) {
  static std::mutex mutex;
  static std::map<int, std::weak_ptr<Domain>> domains;
  if (IsRuledFromOutside()) return nullptr;
  const std::lock_guard lock(mutex);
  if (auto shared = domains[numbers.here].lock()) {
    if (shared->tag == tag && shared->network == numbers.network) return shared;
    if (shared->network != numbers.network)
      return Fail(ErrorCode::kConflict,
                  "DDS domains " + std::to_string(numbers.network) + " and " + std::to_string(shared->network) +
                      " cannot be apart in one process that has an identity",
                  "Take another number for one of them");
    return Fail(ErrorCode::kConflict,
                "DDS domain " + std::to_string(numbers.network) + " is open with tag '" + shared->tag + "'",
                "Use one tag per domain and process");
  }
  const std::string configuration = Configuration(numbers.network, tag);
  Entity entity(dds_create_domain(static_cast<dds_domainid_t>(numbers.here), configuration.c_str()));
  if (entity.get() < 0)
    return Fail(
        ErrorCode::kUnreachable, std::string("DDS could not start: ") + dds_strretcode(-entity.get()),
        "Run `rigcal doctor`: a network interface (loopback at least) must be up, and UDP ports from 7400 free");
  auto shared = std::make_shared<Domain>(Domain{std::move(entity), tag, numbers.network});
  domains[numbers.here] = shared;
  return shared;
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

int NumberHere(int network, bool apart, bool secured) {
  if (!apart || IsRuledFromOutside()) return network;
  return secured ? (network + kApartSecured) % (kDomainMax + 1) : network + kApart;
}

Error NoParticipant(dds_return_t code, const std::filesystem::path& identity) {
  if (identity.empty())
    return {ErrorCode::kUnreachable, std::string("DDS participant: ") + dds_strretcode(-code),
            "At most 120 DDS participants of one domain run on a machine (a server has two): stop some, or set "
            "RIGCAL_DOMAIN"};
  return {ErrorCode::kInvalidInput,
          "DDS does not take the identity in " + identity.string() + ": " +
              (refused_because.empty() ? dds_strretcode(-code) : refused_because),
          "Make a new one with `rigcal identity new`, by the authority that made the server's."};
}

Qos QosWith(const std::string& user_data) {
  Qos qos(dds_create_qos());
  if (!user_data.empty()) dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  return qos;
}

}  // namespace

std::string RobotPartition(const RobotId& robot) { return "robot/" + robot.str(); }

Entity::~Entity() {
  if (handle_ > 0) dds_delete(handle_);
}

Entity::Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}

Entity& Entity::operator=(Entity&& other) noexcept {
  std::swap(handle_, other.handle_);
  return *this;
}

Participant::Participant(std::shared_ptr<void> domain, Entity entity, std::shared_ptr<const DdsIdentity> identity)
    : domain_(std::move(domain)), entity_(std::move(entity)), identity_(std::move(identity)) {}

Result<Participant> Participant::Open(const ParticipantOptions& options) {
  dds_set_log_sink(&LogLine, nullptr);
  KeepFreedSamples();
  RIGCAL_ASSIGN(const int number, DomainNumber(options));
  RIGCAL_ASSIGN(const std::string tag, DiscoveryTag(options));
  const std::filesystem::path folder = options.as_given ? options.identity : IdentityFolder(options.identity);
  const int here = NumberHere(number, options.apart, !folder.empty());
  const Qos qos = QosWith(options.user_data);
  std::shared_ptr<const DdsIdentity> identity;
  if (!folder.empty()) {
    RIGCAL_ASSIGN(DdsIdentity read, Secure(qos.get(), folder));
    identity = std::make_shared<DdsIdentity>(std::move(read));
  }
  RIGCAL_ASSIGN(std::shared_ptr<Domain> domain, SharedDomain({number, here}, tag));
  refused_because.clear();
  Entity entity(dds_create_participant(static_cast<dds_domainid_t>(here), qos.get(), nullptr));
  if (entity.get() < 0) return Fail(NoParticipant(entity.get(), folder));
  return Participant(std::move(domain), std::move(entity), std::move(identity));
}

std::string Participant::AskPartition() const {
  if (!identity_) return kOperatorPartition;
  if (identity_->holder == IdentityHolder::kRobot) return RobotPartition(RobotId(identity_->name));
  return OperatorPartition({identity_->name, identity_->role});
}

Status Participant::Tell(const std::string& user_data) const {
  const dds_return_t code = dds_set_qos(entity_.get(), QosWith(user_data).get());
  if (code == DDS_RETCODE_OK) return {};
  return Fail(ErrorCode::kInternal, std::string("DDS participant: ") + dds_strretcode(-code),
              "Too little memory, or a fault in Rigcal: report it with the log");
}

Result<dds_entity_t> Participant::Topic(const TopicInfo& info) const {
  const std::lock_guard lock(topics_->mutex);
  const auto known = topics_->by_name.find(info.name);
  if (known != topics_->by_name.end()) return known->second;
  const dds_entity_t topic = dds_create_topic(entity_.get(), info.descriptor, info.name, nullptr, nullptr);
  if (topic == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY && identity_)
    return Fail(ErrorCode::kInvalidInput,
                "the identity of " + TextOf(*identity_) + " has nothing to do with " + info.name,
                "Use an operator's identity (RIGCAL_DDS_IDENTITY, --dds-identity)");
  if (topic < 0)
    return Fail(ErrorCode::kInternal, std::string("DDS topic ") + info.name + ": " + dds_strretcode(-topic),
                "Another program of this process may use the name with another type");
  topics_->by_name.emplace(info.name, topic);
  return topic;
}

}  // namespace rigcal::wire
