#include "client/import/files/file_writer.h"

#include "client/bags/cursor.h"
#include "server/base/process/parallel_for.h"
#include "server/base/text.h"

namespace rigcal::importing {
namespace {

using bags::MessageKind;

FileWriter::Fate Refused(const Error& error) { return {false, Sentence(error)}; }

}  // namespace

Result<FileWriter::Fate> FileWriter::Take(const std::string& stem, const std::string& type,
                                          const bags::Value& message) {
  switch (bags::KindOf(type)) {
    case MessageKind::kImage: {
      const auto image = bags::ReadImage(message);
      if (!image) return Refused(image.error());
      if (folder_.Has(stem + ".png")) {
        ++kept_;
        return Fate{true, {}};
      }
      waiting_.push_back({stem + ".png", CopyOf(*image)});
      waiting_bytes_ += image->data.size();
      if (waiting_bytes_ >= kWaitingBytesMax) RIGCAL_TRY(Flush());
      return Fate{true, {}};
    }
    case MessageKind::kCompressedImage: {
      const auto image = bags::ReadCompressedImage(message);
      if (!image) return Refused(image.error());
      RIGCAL_TRY(WriteUnlessThere(stem + "." + image->suffix, std::string(bags::TextOf(image->data))));
      return Fate{true, {}};
    }
    case MessageKind::kCloud: {
      const auto cloud = bags::ReadPointCloud(message);
      if (!cloud) return Refused(cloud.error());
      RIGCAL_TRY(WriteUnlessThere(stem + ".pcd", PcdOf(*cloud)));
      return Fate{true, {}};
    }
    case MessageKind::kScan: {
      const auto scan = bags::ReadLaserScan(message);
      if (!scan) return Refused(scan.error());
      RIGCAL_TRY(WriteUnlessThere(stem + ".pcd", PcdOf(*scan)));
      return Fate{true, {}};
    }
    default:
      return Fate{false, "messages of type " + Quoted(type) + " are neither pictures nor clouds"};
  }
}

Status FileWriter::WriteUnlessThere(const std::string& file, const std::string& bytes) {
  if (!folder_.Has(file)) return folder_.Write(file, bytes);
  ++kept_;
  return {};
}

Status FileWriter::Flush() {
  std::vector<Status> results(waiting_.size());
  ParallelFor(waiting_.size(), [&](std::size_t i) {
    const auto png = PngOf(waiting_[i].pixels.image);
    results[i] = png ? folder_.Write(waiting_[i].file, *png) : Status(Fail(png.error()));
  });
  waiting_.clear();
  waiting_bytes_ = 0;
  for (const Status& result : results) RIGCAL_TRY(Status(result));
  return {};
}

}  // namespace rigcal::importing
