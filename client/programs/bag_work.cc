#include "client/programs/bag_work.h"

namespace rigcal::client {
namespace {

bool IsWhole(const importing::ImportOutcome& outcome) {
  for (const importing::SensorOutcome& sensor : outcome.sensors)
    if (sensor.written == 0 || sensor.refused > 0) return false;
  return true;
}

}  // namespace

ExitCode TellDamage(const std::vector<Error>& damage, const Context& context) {
  for (const Error& error : damage) Report(error, context.err);
  return damage.empty() ? ExitCode::kGood : ExitCode::kVerdictWarn;
}

ExitCode TellMissing(const importing::ImportOutcome& outcome, const Context& context) {
  const ExitCode code = TellDamage(outcome.damage, context);
  return code == ExitCode::kGood && !IsWhole(outcome) ? ExitCode::kVerdictWarn : code;
}

}  // namespace rigcal::client
