#include "storage/revisions/decided_content.h"

#include <optional>
#include <string>

#include "server/base/digests/sha256.h"
#include "storage/audited_rows.h"
#include "storage/database/query.h"
#include "storage/revisions/revision_row.h"

namespace rigcal::storage {
namespace {

struct Content {
  std::optional<Digest> digest;    // as its row says; nothing: there is no such revision
  std::optional<Digest> document;  // of the document that there is; nothing: it cannot be read
  Digest poses;
};

std::optional<Digest> DigestOfDocument(const Query& row, int column) {
  const auto document = DocumentAt(row, column, "a document");
  return document ? std::optional(Sha256Of(*document)) : std::nullopt;
}

Content LoadContent(Store& store, const RevisionKey& key) {
  Query row(store, std::string("SELECT digest, ") + kDocumentColumns +
                       " FROM revision WHERE revision.robot_id = ? AND revision.number = ?");
  if (!row.Bind(key.robot, key.number).Step()) return {};
  return {row.IdAt<Digest>(0), DigestOfDocument(row, 1), HashOfPoses(store, key)};
}

// What a decision holds of its revision, and the audit row that holds the decision.
struct Held {
  std::optional<Digest> digest, poses;  // of a decision from before: nothing
  AuditFault about;
};

// "the document": the first thing that is another one; empty: all is as it was.
std::string WhatChanged(const Content& content, const Held& held) {
  const Digest& digest = held.digest ? *held.digest : *content.digest;
  if (content.document != digest) return "the document";
  if (*content.digest != digest) return "the digest";
  return held.poses && content.poses != *held.poses ? "a pose" : "";
}

void CheckDecision(const RevisionKey& key, const Content& content, Held held, AuditCheck& check) {
  if (!held.digest) ++check.without_digest;
  if (held.about.number == 0) return;  // no audit row holds it: that is a fault already
  const std::string name = "revision " + std::to_string(key.number) + " of robot " + key.robot.str();
  const std::string changed = content.digest ? WhatChanged(content, held) : "";
  if (content.digest && changed.empty()) return;
  held.about.kind = content.digest ? AuditFault::Kind::kRowChanged : AuditFault::Kind::kRowMissing;
  held.about.row = content.digest ? changed + " of " + name : name;
  AddRowFault(std::move(held.about), check);
}

// Columns 2 to 5 of the decisions.
Held HeldAt(const Query& row) {
  Held held;
  if (!row.IsNull(2)) held.digest = row.IdAt<Digest>(2);
  if (!row.IsNull(3)) held.poses = row.IdAt<Digest>(3);
  held.about.number = row.Int(4);
  if (!row.IsNull(5)) held.about.at = row.Time(5);
  return held;
}

}  // namespace

Digest HashOfPoses(Store& store, const RevisionKey& key) {
  Sha256 hash;
  Query pose(store,
             "SELECT sensor_id, is_reference, T_ref_sensor_x_m, T_ref_sensor_y_m, T_ref_sensor_z_m, T_ref_sensor_qx, "
             "T_ref_sensor_qy, T_ref_sensor_qz, T_ref_sensor_qw FROM revision_pose WHERE robot_id = ? AND "
             "revision_number = ? ORDER BY sensor_id");
  pose.Bind(key.robot, key.number);
  while (pose.Step()) {
    std::string lines = pose.Text(0) + "\n" + std::to_string(pose.Int(1)) + "\n";
    for (int column = 2; column < 9; ++column) lines += HeldNumber(pose.Real(column)) + "\n";
    hash.Add(lines);
  }
  Query covariance(
      store, "SELECT sensors, lower FROM revision_covariance WHERE robot_id = ? AND revision_number = ? ORDER BY idx");
  covariance.Bind(key.robot, key.number);
  while (covariance.Step()) hash.Add(covariance.Text(0) + "\n" + Sha256Of(covariance.Text(1)).str() + "\n");
  return hash.Finish();
}

void CheckDecidedContent(Store& store, AuditCheck& check) {
  Query decided(store,
                "SELECT d.robot_id, d.revision_number, d.digest, d.poses_hash, d.held_by, a.at_ns FROM (SELECT "
                "robot_id, revision_number, number, digest, poses_hash, coalesce((SELECT r.number FROM audit_row r "
                "WHERE r.kind = 'decision' AND r.row_number = decision.number), (SELECT min(b.number) FROM audit_row b "
                "WHERE b.kind = 'decision_before' AND decision.number <= b.row_number)) AS held_by FROM decision) d "
                "LEFT JOIN audit a ON a.number = d.held_by "
                "ORDER BY d.robot_id, d.revision_number, d.number");
  std::optional<RevisionKey> key;
  Content content;
  while (decided.Step()) {
    const RevisionKey next{decided.IdAt<RobotId>(0), static_cast<int>(decided.Int(1))};
    const bool is_loaded = key && key->robot == next.robot && key->number == next.number;
    if (!is_loaded) content = LoadContent(store, next);
    key = next;
    CheckDecision(next, content, HeldAt(decided), check);
  }
}

}  // namespace rigcal::storage
