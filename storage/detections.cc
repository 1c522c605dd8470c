#include "storage/detections.h"

#include "storage/query.h"

namespace rigcal::storage {
namespace {

std::string Subject(const Digest& image) { return "what was found in picture " + image.str(); }

Blob BlobOfCorners(const std::vector<Eigen::Vector2d>& corners_px) {
  std::vector<double> values;
  values.reserve(2 * corners_px.size());
  for (const Eigen::Vector2d& corner_px : corners_px) values.insert(values.end(), {corner_px.x(), corner_px.y()});
  return BlobOf(values.data(), values.size());
}

std::vector<Eigen::Vector2d> CornersOf(const std::vector<double>& values) {
  std::vector<Eigen::Vector2d> corners_px;
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) corners_px.emplace_back(values[i], values[i + 1]);
  return corners_px;
}

StoredView ViewOf(const Query& query) {
  StoredView stored;
  stored.view.found = query.Int(0) != 0;
  stored.view.why_not = query.Text(1);
  stored.view.target = query.IdAt<TargetId>(2);
  stored.view.image_width_px = static_cast<int>(query.Int(3));
  stored.view.image_height_px = static_cast<int>(query.Int(4));
  stored.view.corners_px = CornersOf(query.Doubles(5));
  if (!query.IsNull(6)) stored.picture = query.IdAt<Digest>(6);
  return stored;
}

}  // namespace

Result<std::optional<StoredView>> LoadView(Store& store, const Digest& image, const std::string& detector) {
  return Load<std::optional<StoredView>>(store, Subject(image), [&]() -> Result<std::optional<StoredView>> {
    Query query(store,
                "SELECT found, why_not, target_id, width_px, height_px, corners_px, picture_digest "
                "FROM detected_view WHERE image_digest = ? AND detector = ?");
    if (!query.Bind(image, detector).Step()) return std::nullopt;
    return ViewOf(query);
  });
}

Status AppendView(Store& store, const Digest& image, const std::string& detector, const StoredView& stored) {
  return store.connection().Append(Subject(image), [&]() -> Status {
    const BoardView& view = stored.view;
    Query(store, "INSERT INTO detected_view VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING")
        .Bind(image, detector, view.found, view.why_not, view.target, view.image_width_px, view.image_height_px,
              BlobOfCorners(view.corners_px), NullIfEmpty(stored.picture))
        .Run();
    return {};
  });
}

}  // namespace rigcal::storage
