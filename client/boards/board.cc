#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <memory>

#include "client/boards/options.h"
#include "client/boards/text.h"
#include "client/change/order.h"
#include "client/elsewhere.h"
#include "client/verbs.h"

namespace rigcal::client {
namespace {

// The shortest digits that read back as the same number of metres.
std::string MetresOf(double length_mm) {
  std::array<char, 400> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), length_mm / 1000).ptr;
  return {text.data(), end};
}

void AddLength(const char* name, const std::optional<double>& length_mm, std::vector<Field>& fields) {
  if (length_mm) fields.emplace_back(name, MetresOf(*length_mm));
}

void AddWords(const char* name, const std::string& words, std::vector<Field>& fields) {
  if (!words.empty()) fields.emplace_back(name, words);
}

Result<std::vector<Field>> MeasureFields(const BoardOptions& options) {
  std::vector<Field> fields = {{"serial", options.serial}, {"who", WhoAsks(options.who)}};
  if (!options.type.empty()) {
    RIGCAL_ASSIGN(const TargetKind kind, BoardTypeOf(options.type));
    fields.emplace_back("type", NameOf(kind));
  }
  if (options.cols) fields.emplace_back("cols", std::int64_t{*options.cols});
  if (options.rows) fields.emplace_back("rows", std::int64_t{*options.rows});
  AddLength("square_m", options.square_mm, fields);
  AddLength("measured_x_m", options.ruler_x_mm, fields);
  AddLength("measured_y_m", options.ruler_y_mm, fields);
  if (!options.nominal_mm.empty()) {
    AddLength("length_x_m", options.nominal_mm.front(), fields);
    AddLength("length_y_m", options.nominal_mm.back(), fields);
  }
  AddLength("sigma_m", options.sigma_mm, fields);
  AddLength("flatness_m", options.flatness_mm, fields);
  AddWords("next_check", options.next_check, fields);
  AddWords("reason", options.reason, fields);
  if (options.redefine) fields.push_back(Field::Raw("redefine", "true"));
  return fields;
}

ExitCode RunMeasure(const Context& context, const BoardOptions& options) {
  if (!options.ruler_x_mm) throw CLI::RequiredError("--ruler-x-mm");
  if (!options.ruler_y_mm) throw CLI::RequiredError("--ruler-y-mm");
  const auto fields = MeasureFields(options);
  if (!fields) return Report(fields.error(), context);
  return Answer(context, {"measure_board", JsonObject(*fields), PrintBoardMeasured, {}});
}

ExitCode RunList(const Context& context, const BoardOptions& options) {
  std::vector<Field> fields;
  AddWords("after", options.after, fields);
  return Answer(context, {"boards", JsonObject(fields), PrintBoardList, {}});
}

ExitCode RunBoard(Context& context, const BoardOptions& options) {
  if (options.action == "print") return Report(StartElsewhere(context, "board"), context);
  if (options.action == "list") return RunList(context, options);
  if (options.serial.empty()) throw CLI::RequiredError("SERIAL");
  if (options.action == "measure") return RunMeasure(context, options);
  const std::string serial = JsonObject({{"serial", options.serial}});
  if (options.action == "trace") return Answer(context, {"board_trace", serial, PrintBoardTrace, {}});
  return Answer(context, {"board", serial, PrintBoard, {}});
}

}  // namespace

void AddBoard(CLI::App& app, Context& context) {
  auto options = std::make_shared<BoardOptions>();
  AddBoardVerb(app, *options)->callback([&context, options] { context.exit_code = RunBoard(context, *options); });
}

}  // namespace rigcal::client
