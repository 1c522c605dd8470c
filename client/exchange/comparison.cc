#include "client/exchange/comparison.h"

#include <algorithm>
#include <cmath>

#include "client/text/pose_text.h"
#include "client/text/table.h"
#include "server/formats/json/json_values.h"

namespace rigcal::client {
namespace {

// Root mean square over the sensors of the length of one half of e.
double Rms(const std::vector<PoseDifference>& differences, int start) {
  double sum = 0;
  for (const PoseDifference& difference : differences) sum += difference.e.segment<3>(start).squaredNorm();
  return std::sqrt(sum / static_cast<double>(differences.size()));
}

double WorstSigmas(const Comparison& comparison) {
  double worst = 0;
  for (const PoseDifference& difference : comparison.differences)
    worst = std::max(worst, difference.WorstSigmas().value_or(0.0));
  return worst;
}

// Of the least certain axis, as on the page.
std::optional<double> Largest(const std::optional<Vector6d>& sigma, int start) {
  if (!sigma) return std::nullopt;
  return sigma->segment<3>(start).maxCoeff();
}

void WriteDifference(formats::JsonWriter& out, const PoseDifference& difference) {
  out.Object([&] {
    out.Text("id", difference.sensor);
    formats::WriteVector(out, "e", difference.e);
    if (difference.sigma)
      formats::WriteVector(out, "sigma", *difference.sigma);
    else
      out.Null("sigma");
    if (const auto worst = difference.WorstSigmas())
      out.Number("worst_sigmas", *worst);
    else
      out.Null("worst_sigmas");
  });
}

}  // namespace

void PrintComparison(const Comparison& comparison, std::ostream& out) {
  out << Plain(comparison.robot) << ", revision " << comparison.revision << ", against " << Plain(comparison.other)
      << ", in " << Plain(comparison.reference) << '\n';
  Table table({{"SENSOR"},
               {"moved mm", Align::kRight},
               {"sigma mm", Align::kRight},
               {"turned deg", Align::kRight},
               {"sigma deg", Align::kRight},
               {"worst axis", Align::kRight}});
  for (const PoseDifference& difference : comparison.differences) {
    const auto worst = difference.WorstSigmas();
    table.Add({difference.sensor, Scaled(difference.e.head<3>().norm(), kMmPerM, 3),
               Scaled(Largest(difference.sigma, 0), kMmPerM, 3), Scaled(difference.e.tail<3>().norm(), kDegPerRad, 4),
               Scaled(Largest(difference.sigma, 3), kDegPerRad, 4), worst ? Fixed(worst, 1) + " sigma" : "-"});
  }
  table.Print(out);
  out << "rms " << Fixed(Rms(comparison.differences, 0) * kMmPerM, 3) << " mm, "
      << Fixed(Rms(comparison.differences, 3) * kDegPerRad, 4) << " deg\n";
  for (const std::string& sensor : comparison.missing)
    out << "not in " << Plain(comparison.other) << ": " << Plain(sensor) << '\n';
}

std::string ComparisonJson(const Comparison& comparison) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("robot", comparison.robot);
    out.Integer("revision", comparison.revision);
    out.Text("reference", comparison.reference);
    out.Text("with", comparison.other);
    if (!comparison.missing.empty())
      out.List("missing", [&] {
        for (const std::string& sensor : comparison.missing) out.Text(sensor);
      });
    out.Number("rms_m", Rms(comparison.differences, 0));
    out.Number("rms_rad", Rms(comparison.differences, 3));
    out.Number("worst_sigmas", WorstSigmas(comparison));
    out.List("sensors", [&] {
      for (const PoseDifference& difference : comparison.differences) WriteDifference(out, difference);
    });
  });
}

// Where a sigma is not known, an axis may be off by any number of them.
ExitCode JudgeSigmas(const Comparison& comparison, double sigmas_max) {
  if (WorstSigmas(comparison) > sigmas_max) return ExitCode::kVerdictFail;
  const bool all_judged =
      std::all_of(comparison.differences.begin(), comparison.differences.end(),
                  [](const PoseDifference& difference) { return difference.WorstSigmas().has_value(); });
  return all_judged ? ExitCode::kGood : ExitCode::kVerdictUnknown;
}

}  // namespace rigcal::client
