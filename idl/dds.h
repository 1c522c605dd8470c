// Typed RAII over Cyclone's C API: participant, readers, writers, waitset. Values out, Result on failure, no
// exceptions. Used by server/dds and client. T is a generated C struct (rigcal_wire_Chunk, ...). Threads: a Writer may
// be used from several threads; a Reader and a WaitSet from one.
#pragma once

#include <dds/dds.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rigcal.h"
#include "server/base/identity/dds_identity.h"
#include "server/base/ids.h"
#include "server/base/result.h"

namespace rigcal::wire {

// Partition names: "robot/<id>" and "operator".
[[nodiscard]] std::string RobotPartition(const RobotId& robot);
inline constexpr const char* kOperatorPartition = "operator";
inline constexpr const char* kAllRobotsPartition = "robot/*";

// Owns a DDS entity handle (participant, reader, ...): deleted once, movable.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  ~Entity();
  Entity(Entity&& other) noexcept;
  Entity& operator=(Entity&& other) noexcept;
  [[nodiscard]] dds_entity_t get() const { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

struct ParticipantOptions {
  int domain = 0;   // RIGCAL_DOMAIN overrides in Open if set
  std::string tag;  // Discovery/Tag: isolates tests; empty: RIGCAL_DDS_TAG
  // Sockets and threads of DDS that no other participant of the process has, unless that is apart too.
  bool apart = false;
  // Domain and tag are as they stand here, for traffic that is not Rigcal's own: RIGCAL_DOMAIN and RIGCAL_DDS_TAG do
  // not count.
  bool as_given = false;
  std::string user_data = {};  // what discovery tells all others of it (presence.h); empty: nothing
  // Folder of an identity: DDS Security is on (security.h). Empty: RIGCAL_DDS_IDENTITY, or nobody is verified.
  std::filesystem::path identity = {};
  // RIGCAL_DDS_LOCAL (not empty) keeps all traffic on the loopback interface.
  // CYCLONEDDS_URI in the environment replaces the built-in configuration (deploy/dds/default.xml, compiled in).
};

struct TopicInfo;

// One per process; tests open several. Those of one domain in one process share its configuration, so a second tag in
// the same domain is refused (kConflict) while a participant of the first lives. Thread-safe.
class Participant {
 public:
  [[nodiscard]] static Result<Participant> Open(const ParticipantOptions& options);
  [[nodiscard]] dds_entity_t get() const { return entity_.get(); }
  // Replaces its user data, and tells all others.
  [[nodiscard]] Status Tell(const std::string& user_data) const;
  // Who it is; null without DDS Security.
  [[nodiscard]] const DdsIdentity* identity() const { return identity_.get(); }
  // Where it asks the server: people in "operator", with identities an operator in "operator/<role>/<name>" and a robot
  // in "robot/<id>".
  [[nodiscard]] std::string AskPartition() const;
  // Created at the first call, then shared by all readers and writers of the type.
  [[nodiscard]] Result<dds_entity_t> Topic(const TopicInfo& info) const;

 private:
  struct Topics {
    std::mutex mutex;
    std::unordered_map<std::string, dds_entity_t> by_name;
  };
  Participant(std::shared_ptr<void> domain, Entity entity, std::shared_ptr<const DdsIdentity> identity);
  std::shared_ptr<void> domain_;  // outlives entity_
  Entity entity_;
  std::shared_ptr<const DdsIdentity> identity_;
  std::unique_ptr<Topics> topics_ = std::make_unique<Topics>();
};

// Topic name, descriptor and QoS of each type live in one table: idl/topics.cc.
struct TopicInfo {
  const char* name;
  const dds_topic_descriptor_t* descriptor;
  bool transient_local;    // late joiners get the newest sample of each key (Receipt, Calibration, RobotStatus)
  int history_depth;       // 0: keep all
  int reader_samples_max;  // a reader holds at most so many untaken samples (bounds memory); 0: no limit
};
template <typename T>
[[nodiscard]] const TopicInfo& InfoOf();  // specialised in topics.cc for every type of rigcal.idl

// What came with a sample.
struct SampleOrigin {
  dds_instance_handle_t publication = 0;
  std::vector<std::string> partitions;  // of the writer, from discovery (not from the sample): who it may speak for
  dds_instance_handle_t participant = 0;
};

namespace internal {
Result<Entity> OpenReader(const Participant&, const TopicInfo&, const std::vector<std::string>& partitions);
Result<Entity> OpenWriter(const Participant&, dds_entity_t parent, const TopicInfo&,
                          const std::vector<std::string>& partitions);
Result<Entity> OpenPublisher(const Participant&, const std::string& partition);
Status WriteSample(dds_entity_t writer, const void* sample, const char* topic);
// Takes up to `max` samples; calls body for each, also for what only says how its instance is (info.valid_data is
// false).
Result<int> TakeNews(dds_entity_t reader, int max, const std::function<void(const void*, const dds_sample_info_t&)>&);
// The same; calls body for each valid one.
Result<int> TakeSamples(dds_entity_t reader, int max,
                        const std::function<void(const void*, const dds_sample_info_t&)>&);
// Who writes to one reader. Asks discovery once per publication, then remembers it. A publication that is gone already
// has no partitions, so it may speak for nobody.
class Origins {
 public:
  [[nodiscard]] const SampleOrigin& Of(dds_entity_t reader, dds_instance_handle_t publication);

 private:
  std::unordered_map<dds_instance_handle_t, SampleOrigin> by_publication_;
};
Status WaitForAcks(dds_entity_t writer, std::chrono::milliseconds timeout);
Status WithdrawInstance(dds_entity_t writer, const void* sample, const char* topic);
Status ForgetInstance(dds_entity_t writer, const void* sample);
std::vector<dds_instance_handle_t> MatchedPublications(dds_entity_t reader);
bool HasReaderOf(dds_entity_t writer, dds_instance_handle_t participant);
bool HasReaderBeside(dds_entity_t writer, const std::set<dds_instance_handle_t>& others);
void ClearMatch(dds_entity_t endpoint);  // so that a wait set sleeps again
int MatchedCount(dds_entity_t endpoint, bool is_writer);
Status WaitForMatch(dds_entity_t endpoint, bool is_writer, std::chrono::milliseconds timeout);
}  // namespace internal

// Several writers of one partition. They count as one child of the participant, which may have 16,382.
class Publisher {
 public:
  [[nodiscard]] static Result<Publisher> Open(const Participant& participant, const std::string& partition) {
    RIGCAL_ASSIGN(Entity entity, internal::OpenPublisher(participant, partition));
    return Publisher(std::move(entity));
  }
  [[nodiscard]] dds_entity_t get() const { return entity_.get(); }

 private:
  explicit Publisher(Entity entity) : entity_(std::move(entity)) {}
  Entity entity_;
};

template <typename T>
class Writer {
 public:
  [[nodiscard]] static Result<Writer> Open(const Participant& participant, const std::vector<std::string>& partitions) {
    RIGCAL_ASSIGN(Entity entity, internal::OpenWriter(participant, participant.get(), InfoOf<T>(), partitions));
    return Writer(std::move(entity));
  }
  // In the default partition, under another topic than the type's own.
  [[nodiscard]] static Result<Writer> OpenCalled(const Participant& participant, const std::string& topic) {
    TopicInfo info = InfoOf<T>();
    info.name = topic.c_str();
    RIGCAL_ASSIGN(Entity entity, internal::OpenWriter(participant, participant.get(), info, {}));
    return Writer(std::move(entity));
  }
  // In the publisher's partition; the publisher outlives it.
  [[nodiscard]] static Result<Writer> Open(const Participant& participant, const Publisher& publisher) {
    RIGCAL_ASSIGN(Entity entity, internal::OpenWriter(participant, publisher.get(), InfoOf<T>(), {}));
    return Writer(std::move(entity));
  }
  // kBusy if a reader did not take within the writer's blocking time: nothing was written, try again.
  [[nodiscard]] Status Write(const T& sample) {
    return internal::WriteSample(entity_.get(), &sample, InfoOf<T>().name);
  }
  // Until every matched reader has what was written; kUnreachable after the timeout.
  [[nodiscard]] Status WaitForAcks(std::chrono::milliseconds timeout) const {
    return internal::WaitForAcks(entity_.get(), timeout);
  }
  [[nodiscard]] int MatchedReaders() const { return internal::MatchedCount(entity_.get(), true); }
  // Whether any reader matched that is none of `others` (NewReaders::OfMany).
  [[nodiscard]] bool HasReaderBeside(const std::set<dds_instance_handle_t>& others) const {
    return internal::HasReaderBeside(entity_.get(), others);
  }
  // Takes back what was told under the sample's key, by whatever writer: its instance is disposed of, and of a topic
  // that is kept for late joiners these are told so too. kBusy as of Write.
  [[nodiscard]] Status Withdraw(const T& sample) {
    return internal::WithdrawInstance(entity_.get(), &sample, InfoOf<T>().name);
  }
  // Drops what is kept for late joiners under the sample's key: they hear nothing of it.
  [[nodiscard]] Status Forget(const T& sample) { return internal::ForgetInstance(entity_.get(), &sample); }
  // True if a reader of that participant (SampleOrigin::participant) matched: what is written now reaches it.
  [[nodiscard]] bool HasReaderOf(dds_instance_handle_t participant) const {
    return internal::HasReaderOf(entity_.get(), participant);
  }
  // Waits for at least one matched reader; kUnreachable after the timeout.
  [[nodiscard]] Status WaitForReader(std::chrono::milliseconds timeout) const {
    return internal::WaitForMatch(entity_.get(), true, timeout);
  }
  [[nodiscard]] dds_entity_t get() const { return entity_.get(); }

 private:
  explicit Writer(Entity entity) : entity_(std::move(entity)) {}
  Entity entity_;
};

template <typename T>
class Reader {
 public:
  [[nodiscard]] static Result<Reader> Open(const Participant& participant, const std::vector<std::string>& partitions) {
    RIGCAL_ASSIGN(Entity entity, internal::OpenReader(participant, InfoOf<T>(), partitions));
    return Reader(std::move(entity));
  }
  // Takes up to `max` samples and calls body(const T&, const SampleOrigin&) for each valid one, while the loan is held.
  template <typename Body>
  [[nodiscard]] Result<int> Take(int max, Body&& body) {
    return internal::TakeSamples(entity_.get(), max, [&](const void* sample, const dds_sample_info_t& info) {
      body(*static_cast<const T*>(sample), origins_.Of(entity_.get(), info.publication_handle));
    });
  }
  // Takes up to `max` samples and drops them. Whether there was any: one that was written, or one that was withdrawn.
  [[nodiscard]] Result<bool> TakeHint(int max) {
    RIGCAL_ASSIGN(const int taken,
                  internal::TakeNews(entity_.get(), max, [](const void*, const dds_sample_info_t&) {}));
    return taken > 0;
  }
  // The writers that discovery knows to match.
  [[nodiscard]] std::vector<SampleOrigin> Matched() {
    std::vector<SampleOrigin> matched;
    for (const dds_instance_handle_t publication : internal::MatchedPublications(entity_.get()))
      matched.push_back(origins_.Of(entity_.get(), publication));
    return matched;
  }
  [[nodiscard]] int MatchedWriters() const { return internal::MatchedCount(entity_.get(), false); }
  [[nodiscard]] Status WaitForWriter(std::chrono::milliseconds timeout) const {
    return internal::WaitForMatch(entity_.get(), false, timeout);
  }
  [[nodiscard]] dds_entity_t get() const { return entity_.get(); }

 private:
  explicit Reader(Entity entity) : entity_(std::move(entity)) {}
  Entity entity_;
  internal::Origins origins_;
};

// Wakes when any attached reader has data, when a match changed, or when Wake() is called from any thread.
class WaitSet {
 public:
  [[nodiscard]] static Result<WaitSet> Open(const Participant& participant);
  [[nodiscard]] Status Attach(dds_entity_t reader_or_writer);
  // True: something to do. False: the timeout passed.
  [[nodiscard]] Result<bool> Wait(std::chrono::milliseconds timeout);
  void Wake();

 private:
  WaitSet(Entity guard, Entity waitset);
  Entity guard_;
  std::vector<Entity> conditions_;
  Entity waitset_;  // deleted before what is attached to it
};

}  // namespace rigcal::wire
