#include "storage/sessions/detections.h"

#include <numeric>

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string Subject(const Digest& image) { return "what was found in " + image.str(); }

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

Blob BlobOfIndices(const std::vector<int>& indices) {
  const std::vector<double> values(indices.begin(), indices.end());
  return BlobOf(values.data(), values.size());
}

std::vector<int> IndicesOf(const std::vector<double>& values) { return {values.begin(), values.end()}; }

std::vector<int> AllOf(std::size_t count) {
  std::vector<int> indices(count);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

StoredView ViewOf(const Query& query) {
  StoredView stored;
  stored.view.found = query.Int(0) != 0;
  stored.view.why_not = query.Text(1);
  stored.view.target = query.IdAt<TargetId>(2);
  stored.view.image_width_px = static_cast<int>(query.Int(3));
  stored.view.image_height_px = static_cast<int>(query.Int(4));
  stored.view.corners_px = CornersOf(query.Doubles(5));
  stored.view.corner_idx = query.IsNull(7) ? AllOf(stored.view.corners_px.size()) : IndicesOf(query.Doubles(7));
  if (!query.IsNull(6)) stored.picture = query.IdAt<Digest>(6);
  return stored;
}

constexpr std::size_t kSummaryCount = 10;  // centre, normal, extent, rms, score

Blob SummaryOf(const PlanePatch& patch) {
  Eigen::Matrix<double, kSummaryCount, 1> summary;
  summary << patch.centre_m, patch.normal, patch.extent_m, patch.rms_m, patch.score;
  return BlobOf(summary.data(), kSummaryCount);
}

Blob BlobOfPoints(const std::vector<Eigen::Vector3f>& points_m) {
  std::vector<double> values;
  values.reserve(3 * points_m.size());
  for (const Eigen::Vector3f& p : points_m) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return BlobOf(values.data(), values.size());
}

PlanePatch PatchOf(const std::vector<double>& summary, const std::vector<double>& points) {
  PlanePatch patch;
  patch.centre_m = Eigen::Map<const Eigen::Vector3d>(summary.data());
  patch.normal = Eigen::Map<const Eigen::Vector3d>(summary.data() + 3);
  patch.extent_m = Eigen::Map<const Eigen::Vector2d>(summary.data() + 6);
  patch.rms_m = summary[8];
  patch.score = summary[9];
  for (std::size_t i = 0; i + 2 < points.size(); i += 3)
    patch.points_m.emplace_back(Eigen::Map<const Eigen::Vector3d>(points.data() + i).cast<float>());
  return patch;
}

}  // namespace

Result<std::optional<StoredView>> LoadView(Store& store, const Digest& image, const std::string& detector) {
  return Load<std::optional<StoredView>>(store, Subject(image), [&]() -> Result<std::optional<StoredView>> {
    Query query(store,
                "SELECT found, why_not, target_id, width_px, height_px, corners_px, picture_digest, corner_idx "
                "FROM detected_view WHERE image_digest = ? AND detector = ?");
    if (!query.Bind(image, detector).Step()) return std::nullopt;
    return ViewOf(query);
  });
}

Result<std::optional<bool>> WasFound(Store& store, const Digest& image, const std::string& detector,
                                     const TargetId& target) {
  using Found = std::optional<bool>;
  return Load<Found>(store, Subject(image), [&]() -> Result<Found> {
    Query query(store,
                "SELECT max(found) FROM detected_view WHERE image_digest = ? AND (detector = ? OR target_id = ?)");
    if (!query.Bind(image, detector, target).Step() || query.IsNull(0)) return Found();
    return Found(query.Int(0) != 0);
  });
}

Status AppendView(Store& store, const Digest& image, const std::string& detector, const StoredView& stored) {
  return store.connection().Append(Subject(image), [&]() -> Status {
    const BoardView& view = stored.view;
    Query(store, "INSERT INTO detected_view VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING")
        .Bind(image, detector, view.found, view.why_not, view.target, view.image_width_px, view.image_height_px,
              BlobOfCorners(view.corners_px), NullIfEmpty(stored.picture), BlobOfIndices(view.corner_idx))
        .Run();
    return {};
  });
}

Result<std::optional<StoredCloud>> LoadCloud(Store& store, const Digest& cloud, const std::string& detector) {
  return Load<std::optional<StoredCloud>>(store, Subject(cloud), [&]() -> Result<std::optional<StoredCloud>> {
    Query query(store,
                "SELECT why_not, target_id, points, picture_digest, note FROM detected_cloud "
                "WHERE cloud_digest = ? AND detector = ?");
    if (!query.Bind(cloud, detector).Step()) return std::nullopt;
    StoredCloud stored;
    stored.view.why_not = query.Text(0);
    stored.view.target = query.IdAt<TargetId>(1);
    stored.view.points = static_cast<std::size_t>(query.Int(2));
    if (!query.IsNull(3)) stored.picture = query.IdAt<Digest>(3);
    stored.view.note = query.Text(4);
    Query patches(store,
                  "SELECT summary, points_m FROM detected_patch WHERE cloud_digest = ? AND detector = ? "
                  "ORDER BY patch_idx");
    patches.Bind(cloud, detector);
    while (patches.Step()) stored.view.candidates.push_back(PatchOf(patches.Doubles(0), patches.Doubles(1)));
    stored.view.found = !stored.view.candidates.empty();
    return stored;
  });
}

Status AppendCloud(Store& store, const Digest& cloud, const std::string& detector, const StoredCloud& stored) {
  return store.connection().Append(Subject(cloud), [&]() -> Status {
    const CloudView& view = stored.view;
    const int added =
        Query(store, "INSERT INTO detected_cloud VALUES (?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING")
            .Bind(cloud, detector, view.why_not, view.target, view.points, NullIfEmpty(stored.picture), view.note)
            .Run();
    if (added == 0) return {};
    for (std::size_t i = 0; i < view.candidates.size(); ++i)
      Query(store, "INSERT INTO detected_patch VALUES (?, ?, ?, ?, ?)")
          .Bind(cloud, detector, i, SummaryOf(view.candidates[i]), BlobOfPoints(view.candidates[i].points_m))
          .Run();
    return {};
  });
}

}  // namespace rigcal::storage
