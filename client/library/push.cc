#include <algorithm>
#include <future>
#include <span>
#include <sstream>

#include "client/library/handle.h"
#include "client/push/push_batch.h"
#include "client/push/push_folder.h"
#include "server/base/process/thread_rank.h"
#include "server/formats/documents.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::client {
namespace {

constexpr double kGiveUpMax_s = 1e7;  // that of --timeout-total

struct Wishes {
  bool no_wait = false, new_robot = false;
  double give_up_s = 60.0;
  std::vector<std::string> remounted = {};
};

std::vector<std::string> NamesIn(const std::string& text) {
  std::vector<std::string> names;
  std::istringstream rest(text);
  for (std::string name; std::getline(rest, name, ',');) names.push_back(name);
  return names;
}

Wishes WishesOf(const rigcal_push_options* options) {
  if (options == nullptr) return {};
  Wishes wishes{.no_wait = options->no_wait != 0, .new_robot = options->new_robot != 0};
  if (options->give_up_s > 0.0) wishes.give_up_s = std::min(options->give_up_s, kGiveUpMax_s);
  wishes.remounted = NamesIn(TextOf(options->remounted));
  return wishes;
}

Status Tell(rigcal_client& client, rigcal_push_result& result) {
  RIGCAL_ASSIGN(const Document told, Document::Parse(client.text, "what became of the push"));
  const Document shown = told["show"];
  client.id = told["id"].Text();
  result.id = client.id.c_str();
  result.items = told["items"].Integer().value_or(0);
  result.total = told["total"].Integer().value_or(0);
  result.held_before = told["held_before"].Integer().value_or(0);
  result.standing = StandingOf(client, shown["document"]["verdict"]["level"], shown);
  result.remarks = client.remarks.c_str();
  return {};
}

// `push` is one of the verbs' own, told to print its document. A push lowers the rank of its thread for good: the
// caller's stays.
template <typename Push>
Status PushApart(rigcal_client& client, rigcal_push_result& result, const Push& push) {
  std::ostringstream out, err;
  Context context{.out = out, .err = err, .json = true, .timeout = client.timeout, .dds = client.dds};
  const Status done = std::async(std::launch::async, [&] {
                        SetThreadRank(ThreadRank::kWorks);
                        return push(context);
                      }).get();
  RIGCAL_TRY(done);
  client.text = out.str();
  while (client.text.ends_with('\n')) client.text.pop_back();
  client.remarks = err.str();
  return Tell(client, result);
}

Status PushDocument(rigcal_client& client, const std::string& robot_id, const std::string& json, const Wishes& wishes,
                    rigcal_push_result& result) {
  RIGCAL_ASSIGN(const RobotId robot, RobotId::Parse(robot_id));
  RIGCAL_ASSIGN(std::vector<Edge> edges, formats::ReadEdgeFile(json, robot));
  const EdgesToPush batch = EdgesOf(robot, std::move(edges), std::nullopt);
  return PushApart(client, result, [&](Context& context) {
    return PushBatch(context, {"the document", wishes.give_up_s, wishes.no_wait, wishes.new_robot}, batch);
  });
}

void WriteMatrix(formats::JsonWriter& out, std::string_view key, const double* values) {
  out.List(key, [&] {
    for (int row = 0; row < 6; ++row)
      out.List([&] {
        for (int column = 0; column < 6; ++column) out.Number(values[6 * row + column]);
      });
  });
}

void WriteGivenEdge(formats::JsonWriter& out, const rigcal_edge& edge) {
  out.Object([&] {
    out.Text("frame_a", TextOf(edge.frame_a));
    out.Text("frame_b", TextOf(edge.frame_b));
    out.Object("T_a_b", [&] {
      out.List("p_m", [&] {
        for (const double value : edge.p_m) out.Number(value);
      });
      out.List("q_xyzw", [&] {
        for (const double value : edge.q_xyzw) out.Number(value);
      });
    });
    for (const auto& [key, values] :
         {std::pair{"covariance", edge.covariance}, std::pair{"information", edge.information}})
      if (std::any_of(values, values + 36, [](double value) { return value != 0.0; })) WriteMatrix(out, key, values);
    out.Integer("dof", edge.dof);
    if (edge.method != nullptr) out.Text("method", edge.method);
    if (edge.measured_at != nullptr) out.Text("measured_at", edge.measured_at);
  });
}

std::string EdgeDocument(std::span<const rigcal_edge> edges) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Integer("format", 1);
    out.List("edges", [&] {
      for (const rigcal_edge& edge : edges) WriteGivenEdge(out, edge);
    });
  });
}

}  // namespace
}  // namespace rigcal::client

using namespace rigcal;          // NOLINT: the functions below are C's, in no namespace
using namespace rigcal::client;  // NOLINT

extern "C" {

int rigcal_push_session(rigcal_client* client, const char* folder, const rigcal_push_options* options,
                        rigcal_push_result* result) {
  return Guarded(*client, [&] {
    const Wishes wishes = WishesOf(options);
    const PushOptions push{.folder = TextOf(folder),
                           .bag = {},
                           .give_up_s = wishes.give_up_s,
                           .shuffle_seed = {},
                           .no_wait = wishes.no_wait,
                           .new_robot = wishes.new_robot,
                           .remounted = wishes.remounted};
    return PushApart(*client, *result, [&](Context& context) { return PushFolder(context, push); });
  });
}

int rigcal_push_edges(rigcal_client* client, const char* robot, const rigcal_edge* edges, size_t count,
                      const rigcal_push_options* options, rigcal_push_result* result) {
  return Guarded(*client, [&] {
    return PushDocument(*client, TextOf(robot), EdgeDocument({edges, count}), WishesOf(options), *result);
  });
}

int rigcal_push_edge_document(rigcal_client* client, const char* robot, const char* json,
                              const rigcal_push_options* options, rigcal_push_result* result) {
  return Guarded(*client,
                 [&] { return PushDocument(*client, TextOf(robot), TextOf(json), WishesOf(options), *result); });
}

}  // extern "C"
