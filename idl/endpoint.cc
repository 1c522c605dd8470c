#include <algorithm>
#include <array>

#include "idl/dds.h"
#include "idl/discovery.h"

namespace rigcal::wire::internal {
namespace {

constexpr dds_duration_t kBlockingTime = DDS_MSECS(200);
constexpr std::size_t kOriginsMax = 4096;  // clients come and go; what is forgotten is asked again
constexpr std::size_t kMatchedMax = 1024;
constexpr int kTakeMax = 64;

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

struct EndpointDeleter {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const { dds_builtintopic_free_endpoint(endpoint); }
};
using EndpointData = std::unique_ptr<dds_builtintopic_endpoint_t, EndpointDeleter>;

Qos QosOf(const TopicInfo& info, const std::vector<std::string>& partitions) {
  Qos qos(dds_create_qos());
  std::vector<const char*> names;
  for (const std::string& partition : partitions) names.push_back(partition.c_str());
  if (!names.empty()) dds_qset_partition(qos.get(), static_cast<std::uint32_t>(names.size()), names.data());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kBlockingTime);
  dds_qset_durability(qos.get(), info.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), info.history_depth == 0 ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST,
                   info.history_depth);
  if (info.transient_local)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, info.history_depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  // A writer that goes away takes nothing back: what it wrote stays true.
  dds_qset_writer_data_lifecycle(qos.get(), false);
  return qos;
}

Error NotAllowed(const Participant& participant, const TopicInfo& info, const std::vector<std::string>& partitions,
                 const char* does) {
  const std::string who = participant.identity() == nullptr ? "this program" : TextOf(*participant.identity());
  const std::string where = partitions.empty() ? "" : " in partition " + partitions.front();
  return {ErrorCode::kInvalidInput, "the identity of " + who + " does not let it " + does + " " + info.name + where,
          "Use the robot's own identity or an operator's (RIGCAL_DDS_IDENTITY, --dds-identity)"};
}

// Of the statuses only the match wakes a wait set; data wakes it through read conditions (see WaitSet).
Result<Entity> Checked(dds_entity_t handle, const TopicInfo& info, std::uint32_t status_mask) {
  if (handle < 0)
    return Fail(ErrorCode::kInternal, std::string("DDS endpoint of ") + info.name + ": " + dds_strretcode(-handle),
                "Too little memory, or a fault in Rigcal: report it with the server's log");
  Entity entity(handle);
  dds_set_status_mask(handle, status_mask);
  return entity;
}

Status Written(dds_return_t code, const char* topic) {
  if (code == DDS_RETCODE_OK) return {};
  if (code == DDS_RETCODE_TIMEOUT)
    return Fail(ErrorCode::kBusy, std::string(topic) + ": a reader did not take in time", "Try again");
  return Fail(ErrorCode::kInternal, std::string(topic) + ": DDS could not write: " + dds_strretcode(-code),
              "A fault in Rigcal or too little memory: report it with the log");
}

}  // namespace

Result<Entity> OpenReader(const Participant& participant, const TopicInfo& info,
                          const std::vector<std::string>& partitions) {
  RIGCAL_ASSIGN(const dds_entity_t topic, participant.Topic(info));
  const Qos qos = QosOf(info, partitions);
  if (info.reader_samples_max > 0)
    dds_qset_resource_limits(qos.get(), info.reader_samples_max, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  const dds_entity_t handle = dds_create_reader(participant.get(), topic, qos.get(), nullptr);
  if (handle == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY) return Fail(NotAllowed(participant, info, partitions, "read"));
  return Checked(handle, info, DDS_SUBSCRIPTION_MATCHED_STATUS);
}

Result<Entity> OpenWriter(const Participant& participant, dds_entity_t parent, const TopicInfo& info,
                          const std::vector<std::string>& partitions) {
  RIGCAL_ASSIGN(const dds_entity_t topic, participant.Topic(info));
  const Qos qos = QosOf(info, partitions);
  const dds_entity_t handle = dds_create_writer(parent, topic, qos.get(), nullptr);
  if (handle == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY) return Fail(NotAllowed(participant, info, partitions, "write"));
  return Checked(handle, info, DDS_PUBLICATION_MATCHED_STATUS);
}

Result<Entity> OpenPublisher(const Participant& participant, const std::string& partition) {
  const Qos qos(dds_create_qos());
  const char* name = partition.c_str();
  dds_qset_partition(qos.get(), 1, &name);
  Entity entity(dds_create_publisher(participant.get(), qos.get(), nullptr));
  if (entity.get() < 0)
    return Fail(ErrorCode::kInternal, "DDS publisher in " + partition + ": " + dds_strretcode(-entity.get()),
                "Too little memory, or a fault in Rigcal: report it with the server's log");
  return entity;
}

Status WriteSample(dds_entity_t writer, const void* sample, const char* topic) {
  return Written(dds_write(writer, sample), topic);
}

Status WaitForAcks(dds_entity_t writer, std::chrono::milliseconds timeout) {
  if (dds_wait_for_acks(writer, DDS_MSECS(timeout.count())) == DDS_RETCODE_OK) return {};
  return Fail(ErrorCode::kUnreachable, "nobody took what was written within " + std::to_string(timeout.count()) + " ms",
              "Try again; `rigcal doctor` tells whether a server is there");
}

Status WithdrawInstance(dds_entity_t writer, const void* sample, const char* topic) {
  return Written(dds_dispose(writer, sample), topic);
}

Status ForgetInstance(dds_entity_t writer, const void* sample) {
  dds_dispose(writer, sample);
  const dds_return_t code = dds_unregister_instance(writer, sample);
  if (code == DDS_RETCODE_OK || code == DDS_RETCODE_PRECONDITION_NOT_MET) return {};
  return Fail(ErrorCode::kInternal, std::string("DDS could not forget a sample: ") + dds_strretcode(-code),
              "A fault in Rigcal or too little memory: report it with the log");
}

namespace {

// Samples that DDS lends, until this goes.
class Loan {
 public:
  Loan(dds_entity_t reader, void** samples, dds_return_t count) : reader_(reader), samples_(samples), count_(count) {}
  ~Loan() {
    if (count_ > 0) dds_return_loan(reader_, samples_, count_);
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;

 private:
  dds_entity_t reader_;
  void** samples_;
  dds_return_t count_;
};

}  // namespace

Result<int> TakeNews(dds_entity_t reader, int max,
                     const std::function<void(const void*, const dds_sample_info_t&)>& body) {
  std::array<void*, kTakeMax> samples{};
  std::array<dds_sample_info_t, kTakeMax> infos;
  int taken = 0;
  while (taken < max) {
    const int wanted = std::min(kTakeMax, max - taken);
    const dds_return_t count =
        dds_take(reader, samples.data(), infos.data(), samples.size(), static_cast<std::uint32_t>(wanted));
    if (count < 0)
      return Fail(ErrorCode::kInternal, std::string("DDS could not take: ") + dds_strretcode(-count),
                  "A fault in Rigcal or too little memory: report it with the log");
    const Loan loan(reader, samples.data(), count);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) body(samples[i], infos[i]);
    taken += count;
    if (count < wanted) break;
  }
  return taken;
}

Result<int> TakeSamples(dds_entity_t reader, int max,
                        const std::function<void(const void*, const dds_sample_info_t&)>& body) {
  return TakeNews(reader, max, [&](const void* sample, const dds_sample_info_t& info) {
    if (info.valid_data) body(sample, info);
  });
}

const SampleOrigin& Origins::Of(dds_entity_t reader, dds_instance_handle_t publication) {
  const auto known = by_publication_.find(publication);
  if (known != by_publication_.end()) return known->second;
  if (by_publication_.size() >= kOriginsMax) by_publication_.clear();
  SampleOrigin origin;
  origin.publication = publication;
  if (const EndpointData data(dds_get_matched_publication_data(reader, publication)); data != nullptr) {
    origin.participant = data->participant_instance_handle;
    origin.partitions = PartitionsOf(data->qos);
  }
  return by_publication_.emplace(publication, std::move(origin)).first->second;
}

std::vector<dds_instance_handle_t> MatchedPublications(dds_entity_t reader) {
  std::vector<dds_instance_handle_t> handles(static_cast<std::size_t>(MatchedCount(reader, false)));
  const dds_return_t count = dds_get_matched_publications(reader, handles.data(), handles.size());
  handles.resize(std::min(handles.size(), static_cast<std::size_t>(std::max(count, 0))));
  return handles;
}

bool HasReaderOf(dds_entity_t writer, dds_instance_handle_t participant) {
  std::array<dds_instance_handle_t, kMatchedMax> readers{};
  const dds_return_t count = dds_get_matched_subscriptions(writer, readers.data(), readers.size());
  const auto known = std::min<std::size_t>(readers.size(), static_cast<std::size_t>(std::max(count, 0)));
  for (std::size_t i = 0; i < known; ++i) {
    const EndpointData data(dds_get_matched_subscription_data(writer, readers[i]));
    if (data != nullptr && data->participant_instance_handle == participant) return true;
  }
  return false;
}

bool HasReaderBeside(dds_entity_t writer, const std::set<dds_instance_handle_t>& others) {
  std::vector<dds_instance_handle_t> readers(static_cast<std::size_t>(MatchedCount(writer, true)));
  if (readers.size() > others.size()) return true;
  const dds_return_t count = dds_get_matched_subscriptions(writer, readers.data(), readers.size());
  readers.resize(std::min(readers.size(), static_cast<std::size_t>(std::max(count, 0))));
  return std::any_of(readers.begin(), readers.end(), [&](dds_instance_handle_t one) { return others.count(one) == 0; });
}

// A mask that names a status of the other kind of endpoint is refused whole.
void ClearMatch(dds_entity_t endpoint) {
  std::uint32_t status = 0;
  if (dds_take_status(endpoint, &status, DDS_SUBSCRIPTION_MATCHED_STATUS) != DDS_RETCODE_OK)
    dds_take_status(endpoint, &status, DDS_PUBLICATION_MATCHED_STATUS);
}

int MatchedCount(dds_entity_t endpoint, bool is_writer) {
  const dds_return_t count = is_writer ? dds_get_matched_subscriptions(endpoint, nullptr, 0)
                                       : dds_get_matched_publications(endpoint, nullptr, 0);
  return std::max(count, 0);
}

Status WaitForMatch(dds_entity_t endpoint, bool is_writer, std::chrono::milliseconds timeout) {
  if (MatchedCount(endpoint, is_writer) > 0) return {};
  const Entity waitset(dds_create_waitset(dds_get_participant(endpoint)));
  dds_waitset_attach(waitset.get(), endpoint, 0);
  const dds_time_t deadline = dds_time() + DDS_MSECS(timeout.count());
  while (MatchedCount(endpoint, is_writer) == 0) {
    dds_attach_t woken = 0;
    if (dds_waitset_wait_until(waitset.get(), &woken, 1, deadline) <= 0)
      return Fail(ErrorCode::kUnreachable, "no rigcald answers on DDS",
                  "Check that rigcald runs with the same domain and tag; `rigcal doctor` shows what is reachable");
    ClearMatch(endpoint);
  }
  return {};
}

}  // namespace rigcal::wire::internal
