#include <ifaddrs.h>
#include <malloc.h>
#include <net/if.h>
#include <netinet/in.h>

#include <charconv>
#include <cstdlib>
#include <map>

#include "idl/dds.h"
#include "idl/reach.h"
#include "idl_default_xml.h"
#include "server/base/log.h"

namespace rigcal::wire {
namespace {

constexpr int kDomainMax = 230;  // above it the UDP ports of DDSI run out
constexpr int kApart = 1000;     // added to the number that a domain has in this process, not on the network

// One Cyclone domain of this process; participants of the same id share it.
struct Domain {
  Entity entity;
  std::string tag;
};

std::string Variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool HasNetwork() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return false;
  bool found = false;
  for (const ifaddrs* one = list; one != nullptr && !found; one = one->ifa_next) {
    const bool ipv4 = one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET;
    found = ipv4 && (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_LOOPBACK) == 0;
  }
  freeifaddrs(list);
  return found;
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

void LogLine(void*, const dds_log_data_t* data) {
  std::string text(data->message, data->size);
  text.erase(text.find_last_not_of(" \n") + 1);
  Log((data->priority & DDS_LC_WARNING) != 0 ? LogLevel::kDebug : LogLevel::kWarn, "dds: " + text);
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
    if (shared->tag == tag) return shared;
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
  auto shared = std::make_shared<Domain>(Domain{std::move(entity), tag});
  domains[numbers.here] = shared;
  return shared;
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

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

Participant::Participant(std::shared_ptr<void> domain, Entity entity)
    : domain_(std::move(domain)), entity_(std::move(entity)) {}

Result<Participant> Participant::Open(const ParticipantOptions& options) {
  dds_set_log_sink(&LogLine, nullptr);
  KeepFreedSamples();
  RIGCAL_ASSIGN(const int number, DomainNumber(options));
  RIGCAL_ASSIGN(const std::string tag, DiscoveryTag(options));
  const int here = options.apart && !IsRuledFromOutside() ? number + kApart : number;
  RIGCAL_ASSIGN(std::shared_ptr<Domain> domain, SharedDomain({number, here}, tag));
  const Qos qos = QosWith(options.user_data);
  Entity entity(dds_create_participant(static_cast<dds_domainid_t>(here), qos.get(), nullptr));
  if (entity.get() < 0)
    return Fail(ErrorCode::kUnreachable, std::string("DDS participant: ") + dds_strretcode(-entity.get()),
                "At most 120 DDS participants of one domain run on a machine (a server has two): stop some, or set "
                "RIGCAL_DOMAIN");
  return Participant(std::move(domain), std::move(entity));
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
  if (topic < 0)
    return Fail(ErrorCode::kInternal, std::string("DDS topic ") + info.name + ": " + dds_strretcode(-topic),
                "Another program of this process may use the name with another type");
  topics_->by_name.emplace(info.name, topic);
  return topic;
}

}  // namespace rigcal::wire
