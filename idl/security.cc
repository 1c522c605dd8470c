#include "idl/security.h"

#include <dlfcn.h>

#include <array>
#include <cstdlib>

#include "server/base/ids.h"

namespace rigcal::wire {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kOperatorPrefix = "operator/";

// A plugin as the specification names it in properties, the ending of Cyclone's file, and that of its two functions.
struct Plugin {
  const char *property, *file, *function;
};
constexpr std::array<Plugin, 3> kPlugins = {{
    {"auth", "auth", "authentication"},
    {"access", "ac", "access_control"},
    {"crypto", "crypto", "crypto"},
}};

// Debian keeps them in a folder beside Cyclone's library, other builds beside it.
Result<fs::path> FolderOfPlugins() {
  Dl_info library{};
  if (dladdr(reinterpret_cast<void*>(&dds_create_participant), &library) == 0 || library.dli_fname == nullptr)
    return Fail(ErrorCode::kInternal, "nobody knows where Cyclone's library is", "Report it with the log.");
  std::error_code error;
  const fs::path beside = fs::canonical(library.dli_fname, error).parent_path();
  for (const fs::path& folder : {beside / "libddsc0debian", beside})
    if (fs::exists(folder / "libdds_security_auth.so", error)) return folder;
  return Fail(ErrorCode::kUnsupported, "Cyclone DDS has no security plugins in " + beside.string(),
              "Install the package libddsc0debian whole, or give no identity.");
}

void Set(dds_qos_t* qos, const std::string& name, const std::string& value) {
  dds_qset_prop(qos, name.c_str(), value.c_str());
}

void NamePlugins(dds_qos_t* qos, const fs::path& folder) {
  for (const Plugin& plugin : kPlugins) {
    const std::string name = "dds.sec." + std::string(plugin.property) + ".library.";
    Set(qos, name + "path", (folder / ("libdds_security_" + std::string(plugin.file) + ".so")).string());
    Set(qos, name + "init", "init_" + std::string(plugin.function));
    Set(qos, name + "finalize", "finalize_" + std::string(plugin.function));
  }
}

void NameFiles(dds_qos_t* qos, const fs::path& folder) {
  using namespace identity_files;  // NOLINT: all of them
  const auto file = [&folder](const char* name) { return "file:" + (folder / name).string(); };
  Set(qos, "dds.sec.auth.identity_ca", file(kAuthority));
  Set(qos, "dds.sec.auth.identity_certificate", file(kCertificate));
  Set(qos, "dds.sec.auth.private_key", file(kKey));
  Set(qos, "dds.sec.access.permissions_ca", file(kPermissionsAuthority));
  Set(qos, "dds.sec.access.governance", file(kGovernance));
  Set(qos, "dds.sec.access.permissions", file(kPermissions));
  std::error_code error;
  if (fs::exists(folder / kRevoked, error)) Set(qos, "org.eclipse.cyclonedds.sec.auth.crl", file(kRevoked));
}

}  // namespace

std::string OperatorPartition(const Operator& who) {
  return std::string(kOperatorPrefix) + NameOf(who.role) + "/" + who.name;
}

std::optional<Operator> OperatorOfPartition(const std::string& partition) {
  if (partition.compare(0, kOperatorPrefix.size(), kOperatorPrefix) != 0) return std::nullopt;
  const std::string rest = partition.substr(kOperatorPrefix.size());
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) return std::nullopt;
  const auto role = RoleOf(rest.substr(0, slash));
  std::string name = rest.substr(slash + 1);
  if (!role || !CheckName("operator", name)) return std::nullopt;
  return Operator{std::move(name), *role};
}

fs::path IdentityFolder(const fs::path& given) {
  const char* const variable = std::getenv("RIGCAL_DDS_IDENTITY");
  const fs::path named = given.empty() && variable != nullptr ? fs::path(variable) : given;
  if (named.native().substr(0, 1) != "-") return named;
  const fs::path folder = named.native().substr(1);
  std::error_code error;
  // What is there and cannot be looked into is no reason to be open to all.
  return fs::symlink_status(folder, error).type() == fs::file_type::not_found ? fs::path() : folder;
}

Result<DdsIdentity> Secure(dds_qos_t* qos, const fs::path& folder) {
  std::error_code error;
  const fs::path whole = fs::absolute(folder, error);
  RIGCAL_ASSIGN(DdsIdentity identity, ReadIdentity(whole, SystemClock().Now()));
  RIGCAL_ASSIGN(const fs::path plugins, FolderOfPlugins());
  NamePlugins(qos, plugins);
  NameFiles(qos, whole);
  return identity;
}

}  // namespace rigcal::wire
