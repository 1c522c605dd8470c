#include <curl/curl.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <memory>
#include <vector>

#include "client/ask/zip_file.h"
#include "client/text/table.h"
#include "client/upkeep/options.h"
#include "client/upkeep/own_store.h"
#include "client/upkeep/support/machine.h"
#include "client/upkeep/support/redact.h"
#include "client/upkeep/support/server_pages.h"
#include "client/verbs.h"
#include "idl/security.h"
#include "server/base/files/durable_file.h"
#include "server/base/files/private_files.h"
#include "server/base/process/thread_rank.h"
#include "server/base/version.h"
#include "storage/migrate.h"
#include "storage/upkeep/fsck.h"
#include "storage/upkeep/open_unchanged.h"
#include "storage/upkeep/store_figures.h"

namespace rigcal::client {
namespace {

namespace fs = std::filesystem;

struct BundleWords {
  std::string out, data = DefaultDataFolder(), settings = "/etc/rigcal", log, url = "http://127.0.0.1:8420", token_file;
  bool leaves_fsck_out = false;
};

// One file of the bundle; or why it is not there.
struct BundlePart {
  std::string name;
  Result<std::string> text;
  bool is_numbers = false;  // under names of ours: no secret is in it
};
using Parts = std::vector<BundlePart>;

constexpr std::size_t kSettingsBytesMax = 1 << 20;

std::string AboutText(Stamp now) {
  return "rigcal " + std::string(Version()) + ", newest schema " + std::to_string(storage::NewestSchemaVersion()) +
         "\nmade at " + ToIso(now) + "\n";
}

// These and no others: keys and certificates lie beside them.
void AddSettings(const fs::path& folder, Parts& parts) {
  for (const char* name : {"rigcald.conf", "rigcald.env", "worker.env", "limits.yaml"})
    parts.push_back({"settings/" + std::string(name), ReadFile(folder / name, kSettingsBytesMax)});
}

Result<std::string> IdentityText(const fs::path& settings) {
  const fs::path folder = wire::IdentityFolder("-" + (settings / "dds").string());
  if (folder.empty()) return "no identity in " + (settings / "dds").string() + "\n";
  RIGCAL_ASSIGN(const DdsIdentity identity, ReadIdentity(folder, SystemClock().Now()));
  RIGCAL_ASSIGN(const std::string list, ReadFile(folder / identity_files::kRevoked, 4 << 20));
  RIGCAL_ASSIGN(const auto revoked, ReadRevoked(list, identity_files::kRevoked));
  return TextOf(identity) + ", serial " + identity.serial + ", good until " + ToIso(identity.not_after) + "; " +
         std::to_string(revoked.size()) + " certificates are revoked\n";
}

void AddServer(const Context& context, const BundleWords& words, Parts& parts) {
  for (const char* verb : {"health", "status"})
    parts.push_back({"server/" + std::string(verb) + ".json", AskOnce(context, verb, "{}")});
  Result<std::string> token = words.token_file.empty() ? Result<std::string>("") : ReadFile(words.token_file, 4096);
  if (token) token->erase(token->find_last_not_of(" \r\n") + 1);
  for (const char* page : {"healthz", "readyz", "metrics"})
    parts.push_back(
        {"server/" + std::string(page) + ".txt", token ? PageText(words.url, "/" + std::string(page), *token) : token});
}

Result<std::string> FiguresText(const std::string& data) {
  RIGCAL_TRY(CheckOwner(data));
  RIGCAL_ASSIGN(storage::Store store, storage::OpenUnchanged(data));
  RIGCAL_ASSIGN(const storage::StoreFigures figures, storage::LoadFigures(store));
  std::vector<Field> rows, queues;
  for (const auto& [table, count] : figures.rows) {
    rows.emplace_back(table, count);
    if (table.rfind("waiting", 0) == 0) queues.emplace_back(table, count);
  }
  return JsonObject({{"schema_version", std::int64_t{figures.schema_version}},
                     Field::Raw("queues", JsonObject(queues)),
                     Field::Raw("rows", JsonObject(rows))}) +
         "\n";
}

Result<std::string> FsckText(const Context& context, const BundleWords& words) {
  if (words.leaves_fsck_out) return "left out (--no-fsck)\n";
  RIGCAL_TRY(CheckOwner(words.data));
  Result<storage::FsckDone> done = Fail(ErrorCode::kInternal, "nothing was looked at", "Report this.");
  WithBar(context, "Checking", [&](const auto& progress) {
    done = storage::Fsck({std::filesystem::path(words.data), false, progress}, SystemClock());
  });
  if (!done) return Fail(done.error());
  std::string text = std::to_string(done->unmended()) + " things are damaged; " + std::to_string(done->lost()) +
                     " files are lost until they are pushed again; " + std::to_string(done->pages) + " pages (" +
                     std::to_string(done->pages_unknown) + " without a sum), " + std::to_string(done->blobs) +
                     " files of " + std::to_string(done->blob_bytes) + " bytes\n";
  for (const storage::Finding& one : done->findings)
    text += NameOf(one.kind) + ": " + one.what + ". " + one.cure + "\n";
  return text;
}

Parts Collected(const Context& context, const BundleWords& words) {
  Parts parts;
  parts.push_back({"about.txt", AboutText(SystemClock().Now())});
  parts.push_back({"machine.txt", MachineText(words.data)});
  AddSettings(words.settings, parts);
  parts.push_back({"settings/identity.txt", IdentityText(words.settings)});
  parts.push_back({"log.txt", LastLog(words.log)});
  AddServer(context, words, parts);
  parts.push_back({"store.json", FiguresText(words.data), true});
  parts.push_back({"fsck.txt", FsckText(context, words)});
  return parts;
}

std::string SafeText(const BundlePart& part) {
  if (part.is_numbers) return *part.text;
  return part.name.ends_with(".json") ? RedactedJson(*part.text) : Redacted(*part.text);
}

// What is not there is told in its place: that is a finding, too.
Status WriteBundle(const Parts& parts, const fs::path& file) {
  RIGCAL_ASSIGN(ZipFile zip, ZipFile::Open(file));
  for (const BundlePart& part : parts)
    RIGCAL_TRY(part.text ? zip.Add(part.name, SafeText(part))
                         : zip.Add(part.name + ".missing", Redacted(Sentence(part.text.error())) + "\n"));
  return zip.Close();
}

std::string NameNow() {
  std::string name = "rigcal-support-" + ToIso(SystemClock().Now()) + ".zip";
  std::erase(name, ':');
  return name;
}

void PrintDone(const Context& context, const Parts& parts, const std::string& file) {
  std::string list;
  for (const BundlePart& part : parts) {
    const std::string missing = part.text ? "" : Redacted(Sentence(part.text.error()));
    list += (list.empty() ? "" : ",") + JsonObject({{"name", part.name}, {"missing", missing}});
    if (!context.json && !part.text) context.err << part.name << " is not in it: " << Plain(missing) << "\n";
  }
  if (context.json)
    context.out << JsonObject({{"file", file}, Field::Raw("parts", "[" + list + "]")}) << std::endl;
  else
    context.out << file
                << ": look through it before you give it away. Passwords, tokens and keys were taken out; names "
                << "of robots, people and folders are in it." << std::endl;
}

Status MakeBundle(const Context& context, const BundleWords& words) {
  SetThreadRank(ThreadRank::kWorks);
  MakePrivateFiles();
  curl_global_init(CURL_GLOBAL_DEFAULT);
  const Parts parts = Collected(context, words);
  const std::string file = words.out.empty() ? NameNow() : words.out;
  RIGCAL_TRY(WriteBundle(parts, file));
  PrintDone(context, parts, file);
  return {};
}

void AddBundleOptions(CLI::App& verb, BundleWords& words) {
  verb.add_option("--out", words.out, "The zip to write (default: rigcal-support-TIME.zip here)")->type_name("FILE");
  verb.add_option("--data", words.data, "Data folder of the rigcald")->type_name("DIR")->capture_default_str();
  verb.add_option("--settings", words.settings, "Folder of its settings")->type_name("DIR")->capture_default_str();
  verb.add_option("--log", words.log, "Its log (default: what journald has of the service rigcald)")->type_name("FILE");
  verb.add_option("--url", words.url, "Where its reports are")->type_name("URL")->capture_default_str();
  verb.add_option("--token-file", words.token_file, "File with a token, where /metrics needs a login")
      ->type_name("FILE");
  verb.add_flag("--no-fsck", words.leaves_fsck_out, "Do not read the whole store");
}

}  // namespace

void AddSupportBundle(CLI::App& app, Context& context) {
  CLI::App* const verb = app.add_subcommand(kSupportBundleVerb.name, kSupportBundleVerb.description);
  const auto words = std::make_shared<BundleWords>();
  AddBundleOptions(*verb, *words);
  verb->footer(
      "One zip with versions, settings, the last of the log, readiness, metrics, the sizes of tables and queues, what "
      "fsck\n"
      "says, and the machine's system, disk and memory. The server may be down: what cannot be had is named in it. "
      "Passwords,\n"
      "tokens and keys are taken out. As the user whose data folder it is.\n"
      "Exit code: 0 written, 4 it cannot be written.\n"
      "Examples:\n"
      "  sudo -u rigcal rigcal support-bundle --data /var/lib/rigcal --out support.zip\n"
      "  rigcal support-bundle --no-fsck --log rigcald.log\n"
      "  rigcal support-bundle --url https://127.0.0.1:8420 --token-file prometheus.token --json\n");
  verb->callback([&context, words] {
    const Status done = MakeBundle(context, *words);
    if (!done) context.exit_code = Report(done.error(), context);
  });
}

}  // namespace rigcal::client
