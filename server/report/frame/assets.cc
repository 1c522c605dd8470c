#include "server/report/frame/assets.h"

#include "server/base/digests/sha256.h"
#include "web_bundles.h"

namespace rigcal::report {
namespace {

std::string NameOf(std::string_view bundle, std::string_view bytes) {
  const std::size_t dot = bundle.rfind('.');
  return std::string(bundle.substr(0, dot)) + "-" + Sha256Of(bytes).str().substr(0, 12) +
         std::string(bundle.substr(dot));
}

}  // namespace

const std::vector<Asset>& Assets() {
  static const std::vector<Asset> assets = [] {
    std::vector<Asset> named;
    for (const auto& [bundle, bytes] : embedded::kBuiltFiles) named.push_back({NameOf(bundle, bytes), bytes});
    return named;
  }();
  return assets;
}

std::string AssetPath(std::string_view bundle) {
  for (std::size_t i = 0; i < embedded::kBuiltFiles.size(); ++i)
    if (embedded::kBuiltFiles[i].first == bundle) return "assets/" + Assets()[i].name;
  return "";
}

}  // namespace rigcal::report
