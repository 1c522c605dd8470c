#include "client/import/import.h"

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include "client/bags/open_bag.h"
#include "client/import/files/file_writer.h"
#include "client/import/files/session_folder.h"
#include "client/import/report.h"
#include "client/import/rig_map.h"
#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/formats/sessions/poses.h"

namespace rigcal::importing {
namespace {

constexpr std::int64_t kProgressEvery = 64;

bool MakesFiles(SensorKind kind) { return kind == SensorKind::kCamera || kind == SensorKind::kLidar; }

// A message that a sensor has a file of, and its capture.
struct Chosen {
  std::uint32_t ordinal = 0;
  std::size_t capture = 0;
};

class Importer {
 public:
  Importer(const ImportInput& input, RigMap map, const SessionFolder& folder)
      : input_(input), map_(std::move(map)), folder_(folder), writer_(folder) {}

  Result<ImportOutcome> Run(const Progress& progress) {
    RIGCAL_ASSIGN(intake_, TakeIn(input_.bag, map_, progress));
    RIGCAL_TRY(CheckStamps());
    RIGCAL_TRY(Plan(progress));
    RIGCAL_TRY(folder_.CheckRoom(MissingBytes()));
    RIGCAL_TRY(WriteFiles(progress));
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) RIGCAL_TRY(WritePoses(s));
    outcome_.captures = files_of_.size();
    outcome_.damage = intake_.damage;
    RIGCAL_TRY(folder_.Finish(SessionYaml(map_, intake_.first), OutcomeJson(outcome_, "")));
    outcome_.kept_files = writer_.kept();
    return std::move(outcome_);
  }

 private:
  // Stamps that stand still would make one capture of many.
  Status CheckStamps() const {
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) {
      std::vector<std::int64_t> different = intake_.sensors[s].stamps_ns;
      std::sort(different.begin(), different.end());
      different.erase(std::unique(different.begin(), different.end()), different.end());
      if (2 * different.size() >= intake_.sensors[s].stamps_ns.size()) continue;
      return Fail(ErrorCode::kInvalidInput,
                  "the headers of " + Quoted(map_.sensors[s].topic) + " have " + std::to_string(different.size()) +
                      " different stamps in " + std::to_string(intake_.sensors[s].stamps_ns.size()) + " messages",
                  "Its driver does not stamp them: set `stamp: log` for " + Quoted(map_.sensors[s].id.str()) +
                      " in rig.yaml, if the recorder's time will do.");
    }
    return {};
  }

  Status Plan(const Progress& progress) {
    std::optional<StillMoments> found;
    if (WantsStillMoments(map_, intake_)) {
      RIGCAL_ASSIGN(found, FindStillMoments(input_.bag, map_, intake_, progress));
      outcome_.shows_no_board = !found;
    }
    plan_ = found ? std::move(found->plan) : PlanOfStamps();
    ListSensors();
    if (found) TellMoments(*std::move(found));
    return {};
  }

  void TellMoments(StillMoments found) {
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) {
      if (found.unreadable[s] > 0 && outcome_.sensors[s].refused == 0)
        outcome_.sensors[s].first_refusal = found.first_trouble[s];
      outcome_.sensors[s].refused += found.unreadable[s];
    }
    AddCondition("chosen_moments", MomentsText(found.told), map_);
    if (const std::string clocks = ClocksText(found.told); !clocks.empty()) AddCondition("camera_clocks", clocks, map_);
    outcome_.moments = std::move(found.told);
  }

  [[nodiscard]] CapturePlan PlanOfStamps() const {
    std::vector<SensorStamps> stamps;
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) {
      const bool is_stream = map_.sensors[s].kind == SensorKind::kPoseStream;
      stamps.push_back(
          {is_stream ? std::vector<std::int64_t>() : intake_.sensors[s].stamps_ns, MakesFiles(map_.sensors[s].kind)});
    }
    return PlanCaptures(stamps, map_.tolerance_ns, map_.every_ns);
  }

  void ListSensors() {
    outcome_.tolerance_ns = map_.tolerance_ns;
    chosen_.resize(map_.sensors.size());
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) {
      const SensorIntake& taken = intake_.sensors[s];
      outcome_.sensors.push_back({map_.sensors[s].id.str(), map_.sensors[s].topic, taken.messages, 0, taken.refused,
                                  taken.first_refusal, plan_.uses[s], 0, taken.camera_change});
      for (std::size_t k = 0; MakesFiles(map_.sensors[s].kind) && k < plan_.captures.size(); ++k)
        if (const auto& message = plan_.captures[k].message[s]) chosen_[s].push_back({taken.ordinals[*message], k});
      std::sort(chosen_[s].begin(), chosen_[s].end(),
                [](const Chosen& a, const Chosen& b) { return a.ordinal < b.ordinal; });
    }
  }

  // Of the files that are not there yet, as large as they can be.
  std::uint64_t MissingBytes() const {
    double bytes = 0;
    for (std::size_t s = 0; s < map_.sensors.size(); ++s) {
      const SensorIntake& taken = intake_.sensors[s];
      for (const PlannedCapture& capture : plan_.captures) {
        if (!MakesFiles(map_.sensors[s].kind) || !capture.message[s]) continue;
        const std::string stem = map_.sensors[s].id.str() + "/" + capture.name;
        const bool is_there = folder_.Has(stem + ".png") || folder_.Has(stem + ".jpg") || folder_.Has(stem + ".pcd");
        if (!is_there) bytes += taken.file_ratio * taken.message_bytes[*capture.message[s]];
      }
    }
    return static_cast<std::uint64_t>(bytes);
  }

  Status WriteFiles(const Progress& progress) {
    std::map<std::string, std::vector<std::size_t>> by_topic;
    for (std::size_t s = 0; s < map_.sensors.size(); ++s)
      if (!chosen_[s].empty()) by_topic[map_.sensors[s].topic].push_back(s);
    if (by_topic.empty()) return {};
    RIGCAL_ASSIGN(const std::unique_ptr<bags::Bag> bag, bags::OpenBag(input_.bag));
    std::map<std::string, std::uint32_t> ordinals;
    std::vector<std::size_t> next(map_.sensors.size(), 0);
    bags::Message message;
    for (std::int64_t count = 1; bag->Next(message); ++count) {
      if (count % kProgressEvery == 0 && progress) progress(bag->bytes_done(), bag->bytes_total());
      const auto sensors = by_topic.find(message.topic->name);
      if (sensors == by_topic.end()) continue;
      const std::uint32_t ordinal = ordinals[message.topic->name]++;
      for (const std::size_t s : sensors->second)
        if (next[s] < chosen_[s].size() && chosen_[s][next[s]].ordinal == ordinal)
          RIGCAL_TRY(WriteFile(s, chosen_[s][next[s]++], message));
    }
    return writer_.Flush();
  }

  Status WriteFile(std::size_t s, const Chosen& chosen, const bags::Message& message) {
    SensorOutcome& outcome = outcome_.sensors[s];
    const auto refuse = [&](const std::string& why) {
      if (outcome.refused++ == 0) outcome.first_refusal = why;
      return Status();
    };
    auto& definition = definitions_[message.topic];
    if (!definition) {
      auto read = bags::DefinitionOf(*message.topic);
      if (!read) return refuse(Sentence(read.error()));
      definition = *read;
    }
    const auto value = bags::Decode(*message.topic, *definition, message.bytes);
    if (!value) return refuse(Sentence(value.error()));
    const std::string stem = map_.sensors[s].id.str() + "/" + plan_.captures[chosen.capture].name;
    RIGCAL_ASSIGN(const FileWriter::Fate fate, writer_.Take(stem, message.topic->type, *value));
    if (!fate.written) return refuse(fate.refusal);
    files_of_.insert(chosen.capture);
    ++outcome.written;
    return {};
  }

  Status WritePoses(std::size_t s) {
    const MappedSensor& sensor = map_.sensors[s];
    if (MakesFiles(sensor.kind)) return {};
    std::string text(formats::PoseHeader(sensor.kind));
    if (text.empty() || text.back() != '\n') text += '\n';
    text += sensor.kind == SensorKind::kTracker ? TrackerRows(s) : StreamRows(s);
    SensorOutcome& outcome = outcome_.sensors[s];
    if (outcome.written == 0) return {};  // a table without rows would be refused; that there is none is told
    if (static_cast<std::size_t>(outcome.written) > limits::kPoseTableRowsMax)
      return Fail(ErrorCode::kInvalidInput,
                  "the poses of " + Quoted(sensor.id.str()) + " are " + std::to_string(outcome.written) +
                      "; a session takes " + std::to_string(limits::kPoseTableRowsMax),
                  "Split the bag.");
    return folder_.Write(sensor.id.str() + "/poses.csv", text);
  }

  // Of captures that have a file: a session refuses others.
  std::string TrackerRows(std::size_t s) {
    const SensorIntake& taken = intake_.sensors[s];
    std::string rows;
    for (const std::size_t k : files_of_) {
      const auto& message = plan_.captures[k].message[s];
      if (!message || taken.stamps_ns[*message] < 0) continue;
      rows += plan_.captures[k].name + "," + PoseColumns(taken.stamps_ns[*message], taken.poses[*message]);
      ++outcome_.sensors[s].written;
    }
    return rows;
  }

  std::string StreamRows(std::size_t s) {
    const SensorIntake& taken = intake_.sensors[s];
    std::vector<std::size_t> order(taken.stamps_ns.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return taken.stamps_ns[a] < taken.stamps_ns[b]; });
    std::string rows;
    std::int64_t last_ns = -1;
    for (const std::size_t i : order) {
      if (taken.stamps_ns[i] <= last_ns) {
        ++outcome_.sensors[s].repeated_stamps;
        continue;
      }
      last_ns = taken.stamps_ns[i];
      rows += PoseColumns(last_ns, taken.poses[i]);
      ++outcome_.sensors[s].written;
    }
    return rows;
  }

  const ImportInput& input_;
  RigMap map_;
  const SessionFolder folder_;
  FileWriter writer_;
  Intake intake_;
  CapturePlan plan_;
  std::vector<std::vector<Chosen>> chosen_;  // of each sensor, by ordinal
  std::set<std::size_t> files_of_;           // captures that have a file
  std::map<std::shared_ptr<const bags::Topic>, std::shared_ptr<const bags::Definition>> definitions_;
  ImportOutcome outcome_;
};

// As the run told it that came to its end here; an older version kept nothing of it.
Result<ImportOutcome> OutcomeOf(const SessionFolder& folder) {
  ImportOutcome outcome;
  RIGCAL_ASSIGN(const std::string kept, folder.LoadOutcome());
  if (!kept.empty()) {
    RIGCAL_ASSIGN(outcome, ReadOutcome(kept));
  }
  outcome.was_complete = true;
  return outcome;
}

// What is there of another copy of the bag, which may have been damaged, is neither gone on with nor told as this
// one's.
Status BeginAnew(const ImportInput& input, const std::string& identity, const Progress& progress,
                 SessionFolder& folder) {
  if (!input.replaces_other_import)
    return Fail(ErrorCode::kConflict,
                input.out.string() +
                    " holds the import of this bag as it was: name, size and ends are the same, and other bytes "
                    "between them",
                "Give the path of a new folder, or remove that one.");
  RIGCAL_TRY(SessionFolder::Remove(input.out));
  RIGCAL_ASSIGN(folder, SessionFolder::Begin(input.out, identity));
  RIGCAL_TRY(folder.TakeBag(input.bag, progress));
  return {};
}

}  // namespace

Result<ImportOutcome> Import(const ImportInput& input, const Progress& progress) {
  RIGCAL_ASSIGN(const std::string text, ReadFile(input.rig, limits::kSessionYamlBytesMax));
  RIGCAL_ASSIGN(RigMap map, ReadRigMap(text, input.rig.filename().string()));
  map.tolerance_ns = input.tolerance_ns.value_or(map.tolerance_ns);
  map.every_ns = input.every_ns.value_or(map.every_ns);
  RIGCAL_TRY(bags::OpenBag(input.bag));  // before a folder is made for it
  RIGCAL_ASSIGN(const std::string identity, IdentityOf(input.bag, text, map.tolerance_ns, map.every_ns));
  if (input.replaces_other_import) RIGCAL_TRY(SessionFolder::RemoveOther(input.out, identity));
  RIGCAL_ASSIGN(SessionFolder folder, SessionFolder::Begin(input.out, identity));
  RIGCAL_ASSIGN(const bool is_of_this_copy, folder.TakeBag(input.bag, progress));
  if (!is_of_this_copy) RIGCAL_TRY(BeginAnew(input, identity, progress, folder));
  if (folder.complete()) return OutcomeOf(folder);
  return Importer(input, std::move(map), folder).Run(progress);
}

}  // namespace rigcal::importing
