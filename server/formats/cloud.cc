#include "server/formats/cloud.h"

#include <new>

#include "server/base/text.h"
#include "server/formats/cloud_decoders.h"
#include "server/formats/cloud_oddities.h"
#include "server/formats/cloud_table.h"

namespace rigcal::formats {
namespace {

Result<Cloud> Decode(std::string_view bytes, std::string_view suffix, const std::string& name,
                     const std::optional<CloudLayout>& layout) {
  if (bytes.empty()) return RefuseCloud(name, "is empty", "Copy or record it again.");
  if (suffix == "pcd") return ReadPcd(bytes, name);
  if (suffix == "ply") return ReadPly(bytes, name);
  if (suffix == "bin") return ReadBin(bytes, layout, name);
  return RefuseCloud(name, "clouds of the suffix " + Quoted(suffix) + " are not known",
                     "Save the cloud as .pcd, .ply or .bin.");
}

}  // namespace

Result<Cloud> ReadCloud(std::span<const std::byte> bytes, std::string_view suffix, const std::string& name,
                        const std::optional<CloudLayout>& layout) {
  try {
    RIGCAL_ASSIGN(Cloud cloud,
                  Decode({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, suffix, name, layout));
    RIGCAL_TRY(CheckUseful(cloud, name));
    return cloud;
  } catch (const std::bad_alloc&) {
    return RefuseCloud(name, "the cloud does not fit into memory", "Thin the cloud out.");
  }
}

}  // namespace rigcal::formats
