#include "idl/presence.h"

#include <gtest/gtest.h>

#include <random>

namespace rigcal::wire {
namespace {

ServerName Sample() {
  return {
      "0123456789abcdef", ServerState::kWaits, {1'700'000'000'000'000'001}, "bench-pc", 4711, "/srv/my rigcal=1", "5"};
}

ParticipantOptions Alone() {
  static const std::string tag = "presence-" + std::to_string(std::random_device()());
  ParticipantOptions options;
  options.tag = tag;
  return options;
}

// Until discovery lists so many servers; what it lists then.
std::vector<ServerName> AwaitServers(ServerList& list, std::size_t count) {
  std::vector<ServerName> servers;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  do servers = list.Load().value();
  while (servers.size() != count && std::chrono::steady_clock::now() < deadline);
  return servers;
}

TEST(Presence, ANameComesBack) {
  const auto name = ReadServerName(WriteServerName(Sample()));
  ASSERT_TRUE(name);
  EXPECT_EQ(name->id, Sample().id);
  EXPECT_EQ(name->state, ServerState::kWaits);
  EXPECT_EQ(name->since.ns, Sample().since.ns);
  EXPECT_EQ(name->host, "bench-pc");
  EXPECT_EQ(name->pid, 4711);
  EXPECT_EQ(name->folder, "/srv/my rigcal=1");
  EXPECT_EQ(name->store, "5");
  EXPECT_EQ(TextOf(*name), "rigcald on bench-pc (process 4711, data in /srv/my rigcal=1)");
}

TEST(Presence, WhatANewerServerTellsBesidesIsPassedOver) {
  const auto name = ReadServerName(WriteServerName(Sample()) + "moon=full\nnonsense\n");
  ASSERT_TRUE(name);
  EXPECT_EQ(name->host, "bench-pc");
}

TEST(Presence, AnyOtherUserDataIsNoServer) {
  const std::string good = WriteServerName(Sample());
  for (const std::string& text :
       {std::string(), std::string("rigcald"), std::string("rigcald 1\n"), std::string("rigcald 2\nid=1\n"),
        std::string(200'000, 'x'), good + std::string(200'000, '\n')})
    EXPECT_FALSE(ReadServerName(text)) << text.substr(0, 40);
  for (std::size_t length = 0; length < good.size(); ++length)
    static_cast<void>(ReadServerName(good.substr(0, length)));
}

TEST(Presence, ControlCharactersReachNobody) {
  ServerName name = Sample();
  name.folder = "/srv/\x1b[31m\nstate=serves";
  const auto read = ReadServerName(WriteServerName(name));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->folder, "");
  EXPECT_EQ(read->state, ServerState::kWaits);
}

TEST(Presence, ServersAreListedOnceWithTheirNewestState) {
  const auto client = Participant::Open(Alone()).value();
  ServerList list = ServerList::Open(client).value();
  EXPECT_TRUE(list.Load().value().empty());
  ServerName name = Sample();
  ParticipantOptions options = Alone();
  options.user_data = WriteServerName(name);
  auto first = std::make_unique<Participant>(Participant::Open(options).value());
  const auto second = Participant::Open(options).value();  // a server has several
  ASSERT_EQ(AwaitServers(list, 1).size(), 1u);
  EXPECT_EQ(list.Load().value()[0].state, ServerState::kWaits);
  name.state = ServerState::kServes;
  ASSERT_TRUE(first->Tell(WriteServerName(name)));
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (list.Load().value()[0].state != ServerState::kServes && std::chrono::steady_clock::now() < deadline) {
  }
  ASSERT_EQ(list.Load().value().size(), 1u);
  EXPECT_EQ(list.Load().value()[0].state, ServerState::kServes);
}

TEST(Presence, AServerThatTellsNoNameIsKnownByWhatItReads) {
  const auto client = Participant::Open(Alone()).value();
  ServerList list = ServerList::Open(client).value();
  ASSERT_TRUE(AwaitServers(list, 0).empty());
  {
    const auto older = Participant::Open(Alone()).value();
    const auto reader = Reader<rigcal_wire_Request>::Open(older, {kOperatorPartition}).value();
    const auto servers = AwaitServers(list, 1);
    ASSERT_EQ(servers.size(), 1u);
    EXPECT_EQ(servers[0].host, "");
    EXPECT_EQ(servers[0].state, ServerState::kServes);
  }
  EXPECT_TRUE(AwaitServers(list, 0).empty());
}

TEST(Presence, AReaderOfANamedServerIsNoSecondOne) {
  const auto client = Participant::Open(Alone()).value();
  ServerList list = ServerList::Open(client).value();
  ParticipantOptions options = Alone();
  options.user_data = WriteServerName(Sample());
  const auto server = Participant::Open(options).value();
  const auto reader = Reader<rigcal_wire_Request>::Open(server, {kOperatorPartition}).value();
  const auto requests = Writer<rigcal_wire_Request>::Open(client, {kOperatorPartition}).value();
  ASSERT_TRUE(requests.WaitForReader(std::chrono::seconds(30)));
  ASSERT_EQ(list.Load().value().size(), 1u);
  EXPECT_EQ(list.Load().value()[0].host, "bench-pc");
}

}  // namespace
}  // namespace rigcal::wire
