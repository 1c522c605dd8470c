// A board whose squares are measured wrong in session.yaml: lidars see how large it is, and how far a camera moved
// before it is known by a tracker.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"
#include "server/model/edges/method.h"
#include "server/model/edges/past.h"
#include "server/model/sensors/unfound_boards.h"

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

// Boards that its camera may have looked at.
std::vector<const Target*> BoardsBefore(const CauseSearch& search, const Edge& edge) {
  const std::array<EdgeEnd, 2> ends = EndsOf(edge);
  const bool is_b = KindOf(search.headers, edge, ends[1].sensor) == SensorKind::kCamera;
  return BoardsOf(search.headers, ends[is_b ? 1 : 0]);
}

std::vector<const Target*> CandidatesOf(const CauseSearch& search, const Scale& scale) {
  std::vector<const Target*> boards = BoardsBefore(search, *scale.edge);
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

constexpr double kSizeSigmas = 4.0;

// Of all of them, weighted by what they are known to.
struct MeanRatio {
  double ratio = 0.0, sigma_ratio = 0.0;
};
MeanRatio MeanOf(const std::vector<Scale>& scales) {
  double sum = 0.0, weights = 0.0;
  for (const Scale& scale : scales) {
    const double weight = 1 / (scale.sigma_ratio * scale.sigma_ratio);
    sum += weight * scale.ratio;
    weights += weight;
  }
  return {sum / weights, 1 / std::sqrt(weights)};
}

// The size that all pairs agree on; nothing where they do not: then it is a lens or a lidar, and not the board.
std::optional<double> AgreedRatio(const std::vector<Scale>& scales) {
  constexpr double kPart = 1.0 / 3;
  const double mean = MeanOf(scales).ratio;
  const bool agree = std::all_of(scales.begin(), scales.end(), [&](const Scale& scale) {
    return std::abs(scale.ratio - mean) <= std::max(kSizeSigmas * scale.sigma_ratio, kPart * std::abs(mean));
  });
  return agree ? std::optional(mean) : std::nullopt;
}

bool IsBy(const Edge& edge, Method method) { return edge.method == rigcal::NameOf(method); }

// By the pairs of one method alone.
struct Witness {
  std::vector<Scale> scales;
  std::optional<double> ratio;
};

Witness WitnessOf(const std::vector<Scale>& scales, Method method) {
  Witness witness;
  for (const Scale& scale : scales)
    if (IsBy(*scale.edge, method)) witness.scales.push_back(scale);
  if (!witness.scales.empty()) witness.ratio = AgreedRatio(witness.scales);
  return witness;
}

bool IsSuspected(const Edge& edge) { return FailedFor(edge, {"board_size_suspected"}); }

// Failures that a wrong size makes of pairs that could not work it out themselves.
bool MayFollow(const CauseSearch& search, const Edge& edge, const BoardKey& key) {
  if (edge.session != std::get<0>(key) || !(IsBy(edge, Method::kLidarCamera) || IsBy(edge, Method::kTrackerCamera)))
    return false;
  if (!FailedFor(edge, {"high_residual", "range_bias_suspected", "contradicting_motion"})) return false;
  const std::vector<TargetId>& boards = std::get<1>(key);
  const std::vector<const Target*> candidates = BoardsBefore(search, edge);
  return !candidates.empty() && std::all_of(candidates.begin(), candidates.end(), [&](const Target* board) {
    return std::find(boards.begin(), boards.end(), board->id) != boards.end();
  });
}

std::string SquareText(double square_m) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f mm", 1e3 * square_m);
  return text.data();
}

TargetKind PatternKindOf(const std::vector<const Target*>& boards) {
  return boards.empty() ? TargetKind::kCheckerboard : boards.front()->kind;
}

std::string SquaresOf(const std::string& names, TargetKind kind) {
  const char* const parts = IsTagGrid(kind) ? "tags" : IsCircleGrid(kind) ? "spacings" : "squares";
  return std::string("the ") + parts + " of " + (names.empty() ? "the board" : names);
}

// Of boards that pairs cannot be told apart by.
std::string SquaresOf(const std::vector<const Target*>& boards) {
  std::string names;
  for (const Target* board : boards) names += (names.empty() ? "" : " or ") + BoardName(*board);
  return SquaresOf(names, PatternKindOf(boards));
}

// As session.yaml has it.
std::string SizeEntry(TargetKind kind, double square_m) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), square_m < 0.05 ? "%.5f" : "%.4f", square_m);
  return std::string("`") + SizeFieldOf(kind) + ": " + text.data() + "`";
}

std::string PairsText(std::size_t pairs) { return std::to_string(pairs) + (pairs == 1 ? " pair" : " pairs"); }

std::string ShareText(double ratio) {
  return TwoDigits(100 * std::abs(ratio), "%") + (ratio > 0 ? " larger" : " smaller");
}

// Boards of one given size.
struct WrongBoards {
  std::vector<const Target*> boards;
  double square_m = 0.0, ratio = 0.0;
  [[nodiscard]] double IsProbably_m() const { return square_m * (1 + ratio); }
  [[nodiscard]] std::string Sizes() const { return SquareText(IsProbably_m()) + ", not " + SquareText(square_m); }
};

Finding WrongSize(const WrongBoards& wrong, std::size_t pairs) {
  const std::string seen = PairsText(pairs) + (pairs == 1 ? " sees it " : " see it ") + ShareText(wrong.ratio);
  return {SquaresOf(wrong.boards) + " are probably " + wrong.Sizes() + " (" + seen + ")",
          "Measure one with a caliper and correct session.yaml, probably to " +
              SizeEntry(PatternKindOf(wrong.boards), wrong.IsProbably_m())};
}

// Printed at one wrong scale: what is done about each is the same. Each name and each size once.
Finding WrongPrint(const std::vector<WrongBoards>& all, double ratio, std::size_t pairs) {
  std::vector<std::string> names, sizes, entries;
  const auto add = [](const std::string& text, std::vector<std::string>& texts) {
    if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
  };
  TargetKind kind = PatternKindOf(all.front().boards);
  for (const WrongBoards& wrong : all) {
    for (const Target* board : wrong.boards) add(BoardName(*board), names);
    add(SquareText(wrong.IsProbably_m()) + " instead of " + SquareText(wrong.square_m), sizes);
    add(SizeEntry(PatternKindOf(wrong.boards), wrong.IsProbably_m()), entries);
    if (PatternKindOf(wrong.boards) != kind) kind = TargetKind::kCheckerboard;  // boards of several kinds
  }
  const std::string seen = PairsText(pairs) + " see them " + ShareText(ratio);
  return {SquaresOf(List(names), kind) + " are probably " + (sizes.size() > 1 ? List(sizes) : all.front().Sizes()) +
              " (" + seen + ")",
          "Measure one of each with a caliper and correct session.yaml, probably to " + List(entries)};
}

Finding DisputedSize(const std::vector<const Target*>& boards, double square_m, const Witness& lidars,
                     const Witness& trackers) {
  const auto said = [&](const Witness& witness) {
    return SquareText(square_m * (1 + *witness.ratio)) + " (" + PairsText(witness.scales.size()) + ")";
  };
  return {SquaresOf(boards) + " are " + said(lidars) + " by lidars and " + said(trackers) +
              " by trackers, which do not agree; they are given as " + SquareText(square_m),
          "Measure one with a caliper and correct session.yaml, or the scale of what differs from it"};
}

std::vector<const Edge*> TakeSuspected(CauseSearch& search, const std::vector<Scale>& scales) {
  return search.Take([&](const Edge& edge) {
    return IsSuspected(edge) &&
           std::any_of(scales.begin(), scales.end(), [&](const Scale& scale) { return scale.edge == &edge; });
  });
}

bool ShowsOneOf(const CauseSearch& search, const EdgeEnd& end, const std::vector<TargetId>& boards) {
  if (KindOf(search.headers, *end.edge, end.sensor) != SensorKind::kCamera) return false;
  const std::vector<const Target*> seen = BoardsOf(search.headers, end);
  return std::any_of(seen.begin(), seen.end(), [&](const Target* board) {
    return std::find(boards.begin(), boards.end(), board->id) != boards.end();
  });
}

bool IsByCameras(const CauseSearch& search, const Edge& edge) {
  return KindOf(search.headers, edge, edge.frame_a) == SensorKind::kCamera &&
         KindOf(search.headers, edge, edge.frame_b) == SensorKind::kCamera;
}

// Boards that pairs agree to be larger or smaller than given, with the failures that say so.
struct SizedBoards {
  BoardKey key;
  std::vector<Scale> scales;
  std::vector<const Edge*> edges;
};

// Pairs that found nothing wrong, as cameras have no other measure than the board: their poses are as wrong as it is.
void DoubtPoses(const CauseSearch& search, const std::vector<BoardKey>& keys, const std::optional<double>& ratio,
                RootCause& cause) {
  const SensorPose* reference = ReferenceOf(search.solution);
  std::set<SensorId> doubted;
  bool between_cameras = false;
  for (const Edge& edge : search.edges) {
    const std::array<EdgeEnd, 2> ends = EndsOf(edge);
    const auto shows = [&](const BoardKey& key) {
      return edge.session == std::get<0>(key) && std::any_of(ends.begin(), ends.end(), [&](const EdgeEnd& end) {
               return ShowsOneOf(search, end, std::get<1>(key));
             });
    };
    if (edge.state != EdgeState::kGood || std::none_of(keys.begin(), keys.end(), shows)) continue;
    doubted.insert({edge.frame_a, edge.frame_b});
    between_cameras |= IsByCameras(search, edge);
  }
  if (reference != nullptr) doubted.erase(reference->sensor);
  cause.doubted.assign(doubted.begin(), doubted.end());
  if (doubted.empty() || !between_cameras || !ratio) return;
  const double longer_ratio = 1 / (1 + *ratio) - 1;
  cause.effect = "distances between cameras are " + TwoDigits(100 * std::abs(longer_ratio), "%") +
                 (longer_ratio > 0 ? " too long" : " too short");
}

// Too little to fail a pair, and surely more than nothing: poses are off by as much of each distance. Trackers alone
// know a size to a tenth of a percent. Pairs share captures: all together know it no better than the best of them.
bool IsSurelyOff(const std::vector<Scale>& scales) {
  constexpr double kFrom_ratio = 0.002, kSigmas = 5.0;
  const Witness trackers = WitnessOf(scales, Method::kTrackerCamera);
  if (!trackers.ratio || std::abs(*trackers.ratio) < kFrom_ratio) return false;
  return std::any_of(trackers.scales.begin(), trackers.scales.end(),
                     [&](const Scale& scale) { return std::abs(*trackers.ratio) > kSigmas * scale.sigma_ratio; });
}

// Lidars that agree with each other, and trackers likewise, but not both together.
void AddDisputed(CauseSearch& search, const BoardKey& key, const std::vector<Scale>& scales) {
  const Witness lidars = WitnessOf(scales, Method::kLidarCamera), trackers = WitnessOf(scales, Method::kTrackerCamera);
  if (!lidars.ratio || !trackers.ratio) return;
  const std::vector<const Edge*> edges = TakeSuspected(search, scales);
  if (edges.empty()) return;
  RootCause cause{CauseKind::kBoardSize, {}, std::get<1>(key), {}, IdsOf(edges), {}, kPushAgain};
  cause.trait = "disputed";
  DoubtPoses(search, {key}, std::nullopt, cause);
  cause.said = DisputedSize(CandidatesOf(search, scales.front()), std::get<2>(key), lidars, trackers);
  search.causes.push_back(std::move(cause));
}

// Sizes that are wrong by one ratio: of boards of one print.
bool IsOnePrint(const SizedBoards& a, const SizedBoards& b) {
  constexpr double kPart = 0.1, kSigmas = 2;
  const MeanRatio of_a = MeanOf(a.scales), of_b = MeanOf(b.scales);
  if ((of_a.ratio > 0) != (of_b.ratio > 0)) return false;
  return std::abs(of_a.ratio - of_b.ratio) <= std::max(kSigmas * std::hypot(of_a.sigma_ratio, of_b.sigma_ratio),
                                                       kPart * std::min(std::abs(of_a.ratio), std::abs(of_b.ratio)));
}

using OnePrint = std::vector<SizedBoards>;

std::vector<OnePrint> PrintsOf(const std::vector<SizedBoards>& sized) {
  std::vector<OnePrint> prints;
  for (const SizedBoards& one : sized) {
    const auto print = std::find_if(prints.begin(), prints.end(), [&](const OnePrint& all) {
      return std::all_of(all.begin(), all.end(), [&](const SizedBoards& other) { return IsOnePrint(one, other); });
    });
    if (print == prints.end())
      prints.push_back({one});
    else
      print->push_back(one);
  }
  return prints;
}

RootCause CauseOf(CauseSearch& search, const OnePrint& print) {
  std::vector<Scale> scales;
  std::vector<const Edge*> edges;
  std::vector<BoardKey> keys;
  std::set<TargetId> boards;
  for (const SizedBoards& one : print) {
    scales.insert(scales.end(), one.scales.begin(), one.scales.end());
    edges.insert(edges.end(), one.edges.begin(), one.edges.end());
    keys.push_back(one.key);
    boards.insert(std::get<1>(one.key).begin(), std::get<1>(one.key).end());
  }
  if (edges.size() > 1)
    for (const BoardKey& key : keys)
      for (const Edge* edge : search.Take([&](const Edge& one) { return MayFollow(search, one, key); }))
        edges.push_back(edge);
  const double ratio = MeanOf(scales).ratio;
  RootCause cause{CauseKind::kBoardSize, {}, {boards.begin(), boards.end()}, {}, IdsOf(edges), {}, kPushAgain};
  cause.trait = ratio > 0 ? "larger" : "smaller";
  DoubtPoses(search, keys, ratio, cause);
  if (edges.empty()) cause.doubted.clear();  // off by less than a hundredth of each distance: a warning
  std::vector<WrongBoards> wrong;
  for (const SizedBoards& one : print)
    wrong.push_back({CandidatesOf(search, one.scales.front()), std::get<2>(one.key), ratio});
  cause.said = wrong.size() == 1 ? WrongSize(wrong.front(), scales.size()) : WrongPrint(wrong, ratio, scales.size());
  const bool by_trackers = std::all_of(scales.begin(), scales.end(),
                                       [](const Scale& scale) { return IsBy(*scale.edge, Method::kTrackerCamera); });
  if (by_trackers) cause.said.what_to_do += ", or the tracker's scale, if the size is as given";
  return cause;
}

}  // namespace

void FindBoardSizes(CauseSearch& search) {
  std::vector<SizedBoards> sized;
  for (const auto& [key, scales] : ScalesOf(search)) {
    if (!AgreedRatio(scales))
      AddDisputed(search, key, scales);
    else if (std::vector<const Edge*> edges = TakeSuspected(search, scales); !edges.empty() || IsSurelyOff(scales))
      sized.push_back({key, scales, std::move(edges)});
  }
  for (const OnePrint& print : PrintsOf(sized)) search.causes.push_back(CauseOf(search, print));
}

}  // namespace rigcal::fleet
