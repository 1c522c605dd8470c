// A board whose squares are measured wrong in session.yaml: lidars see how large it is.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <tuple>

#include "server/fleet/root_causes.h"
#include "server/fleet/wording.h"
#include "server/model/method.h"
#include "server/model/past.h"

namespace rigcal::fleet {
namespace {

// One pair's view of how large a board is.
struct Scale {
  const Edge* edge = nullptr;
  double ratio = 0.0, sigma_ratio = 0.0, square_m = 0.0;
};

std::optional<Scale> ScaleOf(const Edge& edge) {
  const auto figure = [&](const char* name) {
    const auto found = edge.figures.find(name);
    return found == edge.figures.end() ? 0.0 : found->second;
  };
  const Scale scale{&edge, figure("board_scale_ratio"), figure("board_scale_sigma_ratio"), figure("board_square_m")};
  return scale.sigma_ratio > 0 && scale.square_m > 0 ? std::optional(scale) : std::nullopt;
}

// Boards of one session and one given size that pairs cannot be told apart by.
using BoardKey = std::tuple<SessionId, std::vector<TargetId>, double>;

std::vector<const Target*> CandidatesOf(const CauseSearch& search, const Scale& scale) {
  std::vector<const Target*> boards = BoardsOf(search.headers, EndsOf(*scale.edge)[0]);
  std::erase_if(boards, [&](const Target* board) { return std::abs(board->square_m - scale.square_m) > 1e-9; });
  return boards;
}

std::map<BoardKey, std::vector<Scale>> ScalesOf(const CauseSearch& search) {
  std::map<BoardKey, std::vector<Scale>> scales;
  for (const Edge& edge : search.edges) {
    const auto scale = IsPast(edge) ? std::nullopt : ScaleOf(edge);
    if (!scale) continue;
    std::vector<TargetId> boards;
    for (const Target* board : CandidatesOf(search, *scale)) boards.push_back(board->id);
    scales[{edge.session, boards, scale->square_m}].push_back(*scale);
  }
  return scales;
}

// The size that all pairs agree on; nothing where they do not: then it is a lens or a lidar, and not the board.
std::optional<double> AgreedRatio(const std::vector<Scale>& scales) {
  constexpr double kSigmas = 4.0, kPart = 1.0 / 3;
  double sum = 0.0, weights = 0.0;
  for (const Scale& scale : scales) {
    const double weight = 1 / (scale.sigma_ratio * scale.sigma_ratio);
    sum += weight * scale.ratio;
    weights += weight;
  }
  const double mean = sum / weights;
  const bool agree = std::all_of(scales.begin(), scales.end(), [&](const Scale& scale) {
    return std::abs(scale.ratio - mean) <= std::max(kSigmas * scale.sigma_ratio, kPart * std::abs(mean));
  });
  return agree ? std::optional(mean) : std::nullopt;
}

bool IsSuspected(const Edge& edge) { return FailedFor(edge, {"board_size_suspected"}); }

// Failures that a wrong size makes of pairs that could not work it out themselves.
bool MayFollow(const CauseSearch& search, const Edge& edge, const BoardKey& key) {
  if (edge.session != std::get<0>(key) || edge.method != rigcal::NameOf(Method::kLidarCamera)) return false;
  if (!FailedFor(edge, {"high_residual", "range_bias_suspected"})) return false;
  const std::vector<TargetId>& boards = std::get<1>(key);
  const std::vector<const Target*> candidates = BoardsOf(search.headers, EndsOf(edge)[0]);
  return !candidates.empty() && std::all_of(candidates.begin(), candidates.end(), [&](const Target* board) {
    return std::find(boards.begin(), boards.end(), board->id) != boards.end();
  });
}

std::string SquareText(double square_m) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f mm", 1e3 * square_m);
  return text.data();
}

Finding WrongSize(const std::vector<const Target*>& boards, double square_m, double ratio, std::size_t pairs) {
  std::string names;
  for (const Target* board : boards) names += (names.empty() ? "" : " or ") + BoardName(*board);
  const bool tags = !boards.empty() && IsTagGrid(boards.front()->kind);
  const std::string seen = std::to_string(pairs) + (pairs == 1 ? " pair sees it " : " pairs see it ") +
                           TwoDigits(100 * std::abs(ratio), "%") + (ratio > 0 ? " larger" : " smaller");
  return {std::string("the ") + (tags ? "tags" : "squares") + " of " + (names.empty() ? "the board" : names) +
              " are probably " + SquareText(square_m * (1 + ratio)) + ", not " + SquareText(square_m) + " (" + seen +
              ")",
          "Measure one with a caliper and correct session.yaml"};
}

}  // namespace

void FindBoardSizes(CauseSearch& search) {
  for (const auto& [key, scales] : ScalesOf(search)) {
    const auto ratio = AgreedRatio(scales);
    if (!ratio) continue;
    const auto& of_key = scales;
    const auto of_board = [&](const Edge& edge) {
      return std::any_of(of_key.begin(), of_key.end(), [&](const Scale& scale) { return scale.edge == &edge; });
    };
    std::vector<const Edge*> edges = search.Take([&](const Edge& edge) { return IsSuspected(edge) && of_board(edge); });
    if (edges.empty()) continue;
    const auto& board_key = key;
    if (edges.size() > 1)
      for (const Edge* edge : search.Take([&](const Edge& one) { return MayFollow(search, one, board_key); }))
        edges.push_back(edge);
    RootCause cause{CauseKind::kBoardSize, {}, std::get<1>(key), {}, IdsOf(edges), {}, kPushAgain};
    cause.trait = *ratio > 0 ? "larger" : "smaller";
    cause.said = WrongSize(CandidatesOf(search, scales.front()), std::get<2>(key), *ratio, scales.size());
    search.causes.push_back(std::move(cause));
  }
}

}  // namespace rigcal::fleet
