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

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// One sentence without a full stop; empty: all were compared.
std::string NotComparedText(const Comparison& comparison) {
  std::string text;
  for (const NotCompared& one : comparison.not_compared)
    text += (text.empty() ? "not compared: " : "; ") + one.sensor + " " + one.why;
  return text;
}

void WriteNames(formats::JsonWriter& out, const char* key, const std::vector<std::string>& names) {
  if (names.empty()) return;
  out.List(key, [&] {
    for (const std::string& name : names) out.Text(name);
  });
}

void WriteNotCompared(formats::JsonWriter& out, const Comparison& comparison) {
  std::vector<std::string> missing;
  for (const NotCompared& one : comparison.not_compared) missing.push_back(one.sensor);
  WriteNames(out, "missing", missing);
  if (!missing.empty()) out.Text("not_compared", NotComparedText(comparison));
  WriteNames(out, "without", comparison.waived);
  if (comparison.other_frames) out.Integer("other_frames", static_cast<std::int64_t>(*comparison.other_frames));
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
  const std::string not_compared = NotComparedText(comparison);
  if (!not_compared.empty())
    out << Plain(not_compared) << '.' << (comparison.cure.empty() ? "" : " " + comparison.cure) << '\n';
  if (!comparison.waived.empty()) out << "not compared, and need not be: " << Plain(Joined(comparison.waived)) << '\n';
  if (comparison.other_frames.value_or(0) > 0)
    out << "frames of " << Plain(comparison.other) << " that are no sensors: " << *comparison.other_frames << '\n';
}

std::string ComparisonJson(const Comparison& comparison) {
  return formats::WriteObject([&](formats::JsonWriter& out) {
    out.Text("robot", comparison.robot);
    out.Integer("revision", comparison.revision);
    out.Text("reference", comparison.reference);
    out.Text("with", comparison.other);
    WriteNotCompared(out, comparison);
    out.Number("rms_m", Rms(comparison.differences, 0));
    out.Number("rms_rad", Rms(comparison.differences, 3));
    out.Number("worst_sigmas", WorstSigmas(comparison));
    out.List("sensors", [&] {
      for (const PoseDifference& difference : comparison.differences) WriteDifference(out, difference);
    });
  });
}

// Where a sigma is not known, an axis may be off by any number of them; and so may a sensor that was not compared.
ExitCode JudgeComparison(const Comparison& comparison, double sigmas_max) {
  if (sigmas_max > 0 && WorstSigmas(comparison) > sigmas_max) return ExitCode::kVerdictFail;
  if (!comparison.not_compared.empty()) return ExitCode::kVerdictUnknown;
  if (!(sigmas_max > 0)) return ExitCode::kGood;
  const bool all_judged =
      std::all_of(comparison.differences.begin(), comparison.differences.end(),
                  [](const PoseDifference& difference) { return difference.WorstSigmas().has_value(); });
  return all_judged ? ExitCode::kGood : ExitCode::kVerdictUnknown;
}

}  // namespace rigcal::client
