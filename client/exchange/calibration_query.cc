#include "client/exchange/calibration_query.h"

#include "client/exchange/may_leave.h"
#include "server/formats/documents.h"
#include "server/formats/rig_files/assumed_edges.h"

namespace rigcal::client {
namespace {

class CalibrationAsker {
 public:
  CalibrationAsker(Connection& connection, const CalibrationQuery& query, std::chrono::milliseconds timeout)
      : connection_(connection), timeout_(timeout), query_(query) {}

  Result<AskedCalibration> Ask() {
    RIGCAL_ASSIGN(const Document shown, AskRevisionToTake());
    RIGCAL_ASSIGN(const Leave leave, MayLeave(shown, query_.even_if_not_approved, query_.may_be_overruled));
    RIGCAL_ASSIGN(const formats::RevisionInput revision, formats::ReadRevisionDocument(shown["document"].Dump()));
    const std::int64_t number = shown["revision"].Integer().value_or(0);
    RIGCAL_ASSIGN(const auto facts, AskSensorFacts(number));
    RIGCAL_ASSIGN(exports::Calibration calibration, exports::CalibrationOf(revision, facts));
    calibration.revision = static_cast<int>(number);
    calibration.standing = leave.standing;
    if (const auto at = ParseIso(shown["calibrated_at"].Text())) calibration.calibrated_at = *at;
    if (query_.root) {
      RIGCAL_ASSIGN(calibration, InRoot(std::move(calibration), *query_.root));
    }
    RIGCAL_TRY(exports::RenameFrames(calibration, query_.frames));
    return AskedCalibration{std::move(calibration), leave.doubt, shown["digest"].Text()};
  }

 private:
  Result<Document> AskToShow(std::int64_t revision) {
    std::vector<Field> parameters = {{"robot", query_.robot}};
    if (revision > 0) parameters.emplace_back("revision", revision);
    return connection_.AskDocument("show", JsonObject(parameters), timeout_);
  }

  // Where none is in use the newest, of which MayLeave says why.
  Result<Document> AskRevisionToTake() {
    RIGCAL_ASSIGN(Document shown, AskToShow(query_.revision));
    const auto in_use = RevisionInUse(shown);
    if (query_.revision > 0 || !in_use || in_use == shown["revision"].Integer()) return shown;
    return AskToShow(*in_use);
  }

  // Nothing of a server that does not know the question.
  Result<std::optional<formats::SensorFactsOfRevision>> AskSensorFacts(std::int64_t revision) {
    const auto text =
        connection_.Ask("sensors", JsonObject({{"robot", query_.robot}, {"revision", revision}}), timeout_);
    if (!text && text.error().code == ErrorCode::kInvalidInput) return std::nullopt;
    if (!text) return Fail(text.error());
    RIGCAL_ASSIGN(auto facts, formats::ReadSensorFacts(*text));
    return facts;
  }

  Result<exports::Calibration> InRoot(exports::Calibration calibration, const SensorId& root) {
    std::map<SensorId, Matrix6d> relative;
    if (root != calibration.root && calibration.Find(root) != nullptr)
      for (const exports::ExportedSensor& sensor : calibration.sensors) {
        if (sensor.sensor == root || sensor.sensor == calibration.root) continue;
        RIGCAL_ASSIGN(const auto covariance, AskRelativeCovariance(root, sensor.sensor, calibration.revision));
        if (covariance) relative.emplace(sensor.sensor, *covariance);
      }
    return exports::Rebased(std::move(calibration), root, relative);
  }

  // Of the pose of b in a; nothing where a direction of it was not measured.
  Result<std::optional<Matrix6d>> AskRelativeCovariance(const SensorId& a, const SensorId& b, int revision) {
    const std::string parameters =
        JsonObject({{"robot", query_.robot}, {"a", a.str()}, {"b", b.str()}, {"revision", std::int64_t{revision}}});
    RIGCAL_ASSIGN(const Document answer, connection_.AskDocument("lookup", parameters, timeout_));
    Matrix6d covariance;
    for (std::size_t row = 0; row < 6; ++row)
      for (std::size_t column = 0; column < 6; ++column) {
        const auto value = answer["covariance"][row][column].Number();
        if (!value) return std::nullopt;
        covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = *value;
      }
    return covariance;
  }

  Connection& connection_;
  std::chrono::milliseconds timeout_;
  const CalibrationQuery& query_;
};

}  // namespace

Result<AskedCalibration> AskCalibration(const Context& context, const CalibrationQuery& query) {
  RIGCAL_ASSIGN(const auto participant, wire::Participant::Open(context.dds));
  RIGCAL_ASSIGN(auto connection, Connection::Open(participant, context.dds));
  return AskCalibration(connection, query, context.timeout);
}

Result<AskedCalibration> AskCalibration(Connection& connection, const CalibrationQuery& query,
                                        std::chrono::milliseconds timeout) {
  return CalibrationAsker(connection, query, timeout).Ask();
}

Result<std::map<SensorId, std::string>> FramesOf(const std::vector<std::string>& options) {
  std::map<SensorId, std::string> frames;
  for (const std::string& option : options) {
    RIGCAL_ASSIGN(const rig_files::SensorFrame named, rig_files::ParseSensorFrame(option));
    if (!frames.emplace(named.sensor, named.frame).second)
      return Fail(ErrorCode::kInvalidInput, "sensor '" + named.sensor.str() + "' has two frames",
                  "Give --frame once for each sensor.");
  }
  return frames;
}

}  // namespace rigcal::client
