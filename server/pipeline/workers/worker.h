// Work that computes and decodes, in a process of its own: what ends that process costs this work, and nobody else's.
//
// Over its standard input and output, a line each, fields by tabs. It is told one order at a time:
//   job NUMBER ROBOT SESSION SENSOR_A SENSOR_B ATTEMPTS | refine ROBOT | recompute NUMBER | publish ROBOT REVISION
//   WHY_NO_CLOUDS
// each with `leased OWNER TOKEN ROBOT` before it where the server shares its store with others (storage/work/leases.h),
// and says `begun`, then `done TEXT` or `failed CODE WHAT CURE`. In between it asks for memory to decode in: `take ID
// BYTES`, answered by `granted ID` when there is as much, and ended by `give ID`; and it tells what is counted
// (metrics/noted.h), `spent STAGE SECONDS done|failed` and `erred KIND`. It ends when its input does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "storage/revisions/revisions.h"
#include "storage/work/jobs.h"
#include "storage/work/leases.h"

namespace rigcal::pipeline {

// Lines as Work() takes them.
[[nodiscard]] std::string JobOrder(const storage::JobRow& job);
[[nodiscard]] std::string RefineOrder(const RobotId& robot);
[[nodiscard]] std::string RecomputeOrder(std::int64_t item_number);  // of a session in its run
[[nodiscard]] std::string PublishOrder(const storage::RevisionKey& key, const std::string& why_no_clouds);
// `order`, refused once another process has taken the robot.
[[nodiscard]] std::string LeasedOrder(const storage::Lease& lease, const std::string& order);

// Of a line.
[[nodiscard]] std::vector<std::string> WorkerFields(const std::string& line);

// The process's whole life: carries out orders on the store. The exit code.
[[nodiscard]] int Work(const storage::StorePlace& place, const Clock& clock);

}  // namespace rigcal::pipeline
