// One client that speaks for many robots nobody has: it asks in the name of each and begins a session, then goes. Tells
// how many writers the others on this domain keep for robots: before, right after, and when none is left or so much
// time has passed. Prints one JSON object.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "idl/convert.h"
#include "idl/dds.h"

namespace {

using rigcal::RobotId;
using Time = std::chrono::steady_clock::time_point;
namespace wire = rigcal::wire;

struct Options {
  wire::ParticipantOptions participant;
  int count = 1000;
  int wait_s = 60;
};

bool IsOfRobot(const dds_builtintopic_endpoint_t& writer) {
  std::uint32_t count = 0;
  char** names = nullptr;
  bool found = false;
  if (!dds_qget_partition(writer.qos, &count, &names)) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    found |= std::strncmp(names[i], "robot/", 6) == 0;
    dds_free(names[i]);
  }
  dds_free(names);
  return found;
}

// Writers of other participants in partitions of robots.
int CountWriters(const wire::Participant& participant, dds_entity_t publications) {
  constexpr std::uint32_t kMax = 1 << 17;
  static std::vector<void*> samples(kMax, nullptr);
  static std::vector<dds_sample_info_t> infos(kMax);
  const dds_instance_handle_t own = [&] {
    dds_instance_handle_t handle = 0;
    dds_get_instance_handle(participant.get(), &handle);
    return handle;
  }();
  const dds_return_t count = dds_read_mask(publications, samples.data(), infos.data(), kMax, kMax,
                                           DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE);
  int writers = 0;
  for (int i = 0; i < count; ++i) {
    const auto& writer = *static_cast<const dds_builtintopic_endpoint_t*>(samples[static_cast<std::size_t>(i)]);
    if (infos[static_cast<std::size_t>(i)].valid_data && writer.participant_instance_handle != own && IsOfRobot(writer))
      ++writers;
  }
  if (count > 0) dds_return_loan(publications, samples.data(), count);
  return writers;
}

struct Said {
  bool answered = false, received = false;
};

// A question in the robot's own partition, and the head of a session.
rigcal::Result<Said> SpeakFor(const wire::Participant& participant, const RobotId& robot) {
  const std::vector<std::string> partition = {wire::RobotPartition(robot)};
  RIGCAL_ASSIGN(auto replies, wire::Reader<rigcal_wire_Reply>::Open(participant, partition));
  RIGCAL_ASSIGN(auto receipts, wire::Reader<rigcal_wire_Receipt>::Open(participant, partition));
  RIGCAL_ASSIGN(auto requests, wire::Writer<rigcal_wire_Request>::Open(participant, partition));
  RIGCAL_ASSIGN(auto headers, wire::Writer<rigcal_wire_SessionHeader>::Open(participant, partition));
  RIGCAL_TRY(requests.WaitForReader(std::chrono::seconds(10)));
  RIGCAL_TRY(headers.WaitForReader(std::chrono::seconds(10)));
  const std::string json = "{\"robot\":\"" + robot.str() + "\"}", verb = "show", id(64, 'a');
  rigcal_wire_Request request{};
  RIGCAL_TRY(wire::CopyText("1", request.id, sizeof request.id, "id"));
  RIGCAL_TRY(wire::CopyText(verb, request.verb, sizeof request.verb, "verb"));
  request.json = const_cast<char*>(json.c_str());
  RIGCAL_TRY(requests.Write(request));
  rigcal_wire_SessionHeader header{};
  RIGCAL_TRY(wire::CopyText(robot.str(), header.robot_id, sizeof header.robot_id, "robot_id"));
  RIGCAL_TRY(wire::CopyText(id, header.session_id, sizeof header.session_id, "session_id"));
  header.protocol = 1;
  RIGCAL_TRY(headers.Write(header));
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(replies.get()));
  RIGCAL_TRY(waitset.Attach(receipts.get()));
  Said said;
  const Time until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!(said.answered && said.received) && std::chrono::steady_clock::now() < until) {
    RIGCAL_TRY(waitset.Wait(std::chrono::milliseconds(500)));
    RIGCAL_TRY(replies.Take(16, [&](const auto&, const auto&) { said.answered = true; }));
    RIGCAL_TRY(receipts.Take(16, [&](const auto&, const auto&) { said.received = true; }));
  }
  return said;
}

rigcal::Status Run(const Options& options) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(options.participant));
  const wire::Entity publications(
      dds_create_reader(participant.get(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr));
  RIGCAL_ASSIGN(auto way_there, wire::Writer<rigcal_wire_Request>::Open(participant, {wire::kOperatorPartition}));
  RIGCAL_TRY(way_there.WaitForReader(std::chrono::seconds(10)));
  const int before = CountWriters(participant, publications.get());
  int answered = 0, received = 0;
  for (int i = 0; i < options.count; ++i) {
    RIGCAL_ASSIGN(const Said said, SpeakFor(participant, RobotId("misspelt-" + std::to_string(i))));
    answered += said.answered;
    received += said.received;
  }
  const int meanwhile = CountWriters(participant, publications.get());
  RIGCAL_ASSIGN(auto waitset, wire::WaitSet::Open(participant));
  RIGCAL_TRY(waitset.Attach(publications.get()));
  const Time until = std::chrono::steady_clock::now() + std::chrono::seconds(options.wait_s);
  while (CountWriters(participant, publications.get()) > 0 && std::chrono::steady_clock::now() < until)
    RIGCAL_TRY(
        waitset.Wait(std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now())));
  std::printf(
      "{\"count\": %d, \"answered\": %d, \"received\": %d, \"writers_before\": %d, \"writers_meanwhile\": %d, "
      "\"writers_after\": %d}\n",
      options.count, answered, received, before, meanwhile, CountWriters(participant, publications.get()));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("One client speaks for robots that nobody has");
  app.add_option("--tag", options.participant.tag);
  app.add_option("--count", options.count)->check(CLI::Range(1, 10000));
  app.add_option("--wait-s", options.wait_s)->check(CLI::Range(0, 600));
  CLI11_PARSE(app, argc, argv);
  const rigcal::Status done = Run(options);
  if (done) return 0;
  std::fprintf(stderr, "%s\n", rigcal::Sentence(done.error()).c_str());
  return 1;
}
