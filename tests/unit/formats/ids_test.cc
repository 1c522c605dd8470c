// The ids of docs/ids.md: tests/golden/ids.json was made by its recipe, without our code.
#include <nlohmann/json.hpp>

#include "server/base/digests/sha256.h"
#include "tests/unit/formats/samples.h"

namespace rigcal::formats {
namespace {

using nlohmann::json;

json Golden(const std::string& name) {
  return json::parse(samples::FileText(std::string(RIGCAL_SOURCE_DIR) + "/tests/golden/" + name));
}

// A file of edges tells when they were measured as people write it.
std::string FileOf(json edges) {
  for (json& edge : edges)
    if (edge.contains("measured_ns")) {
      edge["measured_at"] = ToIso(Stamp{edge["measured_ns"].get<std::int64_t>()});
      edge.erase("measured_ns");
    }
  return json{{"format", 1}, {"edges", std::move(edges)}}.dump();
}

TEST(Ids, AreThoseOfTheRecipe) {
  const json batches = Golden("ids.json");
  ASSERT_EQ(batches.size(), 3u);
  for (const json& batch : batches) {
    const RobotId robot(batch["robot"].get<std::string>());
    const auto edges = ReadEdgeFile(FileOf(batch["edges"]), robot);
    ASSERT_TRUE(edges) << Sentence(edges.error());
    ASSERT_EQ(edges->size(), batch["edge_ids"].size());
    for (std::size_t i = 0; i < edges->size(); ++i)
      EXPECT_EQ(edges->at(i).id.str(), batch["edge_ids"][i].get<std::string>());
    EXPECT_EQ(BatchIdOf(robot, *edges).str(), batch["batch_id"].get<std::string>());
  }
}

TEST(Ids, OfASessionIsThatOnThePage) {
  const std::string page = samples::FileText(std::string(RIGCAL_SOURCE_DIR) + "/docs/ids.md");
  EXPECT_NE(page.find("session_id  " + Sha256Of(WriteManifest(samples::SampleManifest())).str()), std::string::npos);
}

}  // namespace
}  // namespace rigcal::formats
