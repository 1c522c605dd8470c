#include "client/sim/views/tile.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rigcal::sim {
namespace {

using Row = std::array<float, kTile>;
using Rays = Eigen::Vector3f[9];

// Over the tile's unit square: c[i][j] x^i y^j.
struct Quadratic {
  float c[3][3];

  explicit Quadratic(const float (&nodes)[9]) {
    float rows[3][3];  // by row of nodes: powers of x
    for (int y = 0; y < 3; ++y) Powers(nodes[3 * y], nodes[3 * y + 1], nodes[3 * y + 2], rows[y]);
    for (int i = 0; i < 3; ++i) Powers(rows[0][i], rows[1][i], rows[2][i], c[i]);
  }
  static void Powers(float at_0, float at_half, float at_1, float (&to)[3]) {
    to[0] = at_0, to[1] = -3 * at_0 + 4 * at_half - at_1, to[2] = 2 * at_0 - 4 * at_half + 2 * at_1;
  }
  void Fill(float y, Row& row) const {
    const float c0 = c[0][0] + y * (c[0][1] + y * c[0][2]), c1 = c[1][0] + y * (c[1][1] + y * c[1][2]);
    const float c2 = c[2][0] + y * (c[2][1] + y * c[2][2]);
    for (int i = 0; i < kTile; ++i) {
      const float x = static_cast<float>(i) * (1.0f / kTile);
      row[static_cast<std::size_t>(i)] = c0 + x * (c1 + x * c2);
    }
  }
};

Quadratic Along(const Eigen::Vector3f& direction, const Rays& rays) {
  float nodes[9];
  for (int i = 0; i < 9; ++i) nodes[i] = direction.dot(rays[i]);
  return Quadratic(nodes);
}

// One panel in one tile.
struct Piece {
  const PanelView* view;
  Cover cover;
  float depth_m;          // of its point nearest to the tile's middle: its plane may come nearer beside it
  Eigen::Array2f blur_m;  // of the point spread along u and v
};

Piece PieceOf(const Painter& painter, const PanelView& view, const Rays& rays, Cover cover) {
  const auto at = [&](int i) {
    const float d = std::max(view.D.dot(rays[i]), view.least);
    return Eigen::Array2f(view.Na.dot(rays[i]) / d, view.Nb.dot(rays[i]) / d);
  };
  const Eigen::Array2f along_x = (at(5) - at(3)) / kTile, along_y = (at(7) - at(1)) / kTile;
  const Panel& panel = *view.panel;
  const Eigen::Array2f half = panel.half_m.cast<float>().array(), nearest = at(4).max(-half).min(half);
  const Eigen::Vector3d point_m = panel.middle_m + nearest.x() * panel.u + nearest.y() * panel.v;
  const Eigen::Array2f per_px = (along_x.square() + along_y.square()).sqrt();
  return {&view, cover, static_cast<float>((point_m - painter.from_m).norm()), (painter.blur_px * per_px).max(1e-7f)};
}

bool IsBefore(const Piece& a, const Piece& b) {
  const Layer layer_a = a.view->panel->layer, layer_b = b.view->panel->layer;
  return layer_a != layer_b ? layer_a > layer_b : a.depth_m < b.depth_m;
}

// From the front on; what is behind a panel that fills the tile is left away.
std::vector<Piece> PiecesOf(const Painter& painter, const std::vector<const PanelView*>& views, const Rays& rays) {
  std::vector<Piece> pieces;
  for (const PanelView* view : views) {
    const Cover cover = CoverOf(*view, rays, kTile, SoftEdge::kReach * painter.blur_px);
    if (cover != Cover::kNone) pieces.push_back(PieceOf(painter, *view, rays, cover));
  }
  std::stable_sort(pieces.begin(), pieces.end(), IsBefore);
  const auto filling =
      std::find_if(pieces.begin(), pieces.end(), [](const Piece& p) { return p.cover == Cover::kWhole; });
  if (filling != pieces.end()) pieces.erase(filling + 1, pieces.end());
  return pieces;
}

// Light from the surface times what the lens lets through.
Quadratic ShadeOf(const Painter& painter, const PanelView& view, const Rays& rays, const float (&brightness)[9]) {
  float nodes[9];
  for (int i = 0; i < 9; ++i) {
    const double distance = view.plane_m / std::max(view.D.dot(rays[i]), view.least);
    const Eigen::Vector3d point_m = painter.from_m + painter.R_world_cam * rays[i].cast<double>() * distance;
    nodes[i] = brightness[i] * static_cast<float>(ShadeAt(painter.scene, point_m, view.panel->outward));
  }
  return Quadratic(nodes);
}

const SoftEdge& Edge() {
  static const SoftEdge kEdge;
  return kEdge;
}

// Squares along one axis, in squares from the first inner corner.
struct Axis {
  float per_m, offset, blur, last;  // `last` inner corner

  // `plate_m`: from the middle of the pattern to that of the plate.
  Axis(int corners, double square_m, double plate_m, float blur_m)
      : per_m(static_cast<float>(1 / square_m)),
        offset(static_cast<float>(corners - 1) / 2 + static_cast<float>(plate_m / square_m)),
        blur(static_cast<float>(blur_m / square_m)),
        last(static_cast<float>(corners - 1)) {}
  [[nodiscard]] float Place(float ab_m) const { return ab_m * per_m + offset; }
  // 1 in even squares, -1 in odd ones.
  [[nodiscard]] float Parity(float place, const SoftEdge& edge) const {
    const float corner = std::clamp(std::floor(place + 0.5f), 0.0f, last);
    const float step = 2 * edge((place - corner) / blur) - 1;
    return (static_cast<int>(corner) & 1) != 0 ? -step : step;
  }
  // 1 within the pattern, 0 on the plate's margin.
  [[nodiscard]] float Within(float place, const SoftEdge& edge) const {
    return edge((last / 2 + 1 - std::abs(place - last / 2)) / blur);
  }
};

struct Checkerboard {
  Axis x, y;
  const SoftEdge& edge;

  Checkerboard(const Target& target, const Eigen::Array2f& blur_m)
      : Checkerboard(target, target.plate_offset_m.value_or(Eigen::Vector2d::Zero()), blur_m) {}
  Checkerboard(const Target& target, const Eigen::Vector2d& offset_m, const Eigen::Array2f& blur_m)
      : x(target.cols, target.square_m, offset_m.x(), blur_m.x()),
        y(target.rows, target.square_m, offset_m.y(), blur_m.y()),
        edge(Edge()) {}
  [[nodiscard]] float Grey(float a_m, float b_m) const {
    constexpr auto kMiddle = static_cast<float>((kWhite + kBlack) / 2),
                   kHalf = static_cast<float>((kWhite - kBlack) / 2);
    const float s = x.Place(a_m), t = y.Place(b_m);
    const float squares = kMiddle - kHalf * x.Parity(s, edge) * y.Parity(t, edge);
    return static_cast<float>(kWhite) + x.Within(s, edge) * y.Within(t, edge) * (squares - static_cast<float>(kWhite));
  }
};

// How light the print of a board is; of no board, nothing.
class Print {
 public:
  Print(const Scene& scene, int board_idx, const Eigen::Array2f& blur_m) : blur_m_(blur_m) {
    if (board_idx < 0) return;
    const auto idx = static_cast<std::size_t>(board_idx);
    if (scene.boards[idx].kind == TargetKind::kCheckerboard)
      squares_.emplace(scene.boards[idx], blur_m);
    else
      pattern_ = &scene.prints[idx];
  }
  [[nodiscard]] float Grey(float a_m, float b_m) const {
    if (squares_) return squares_->Grey(a_m, b_m);
    const float black = pattern_->Black({a_m, b_m}, blur_m_, Edge());
    return static_cast<float>(kWhite) - black * static_cast<float>(kWhite - kBlack);
  }

 private:
  Eigen::Array2f blur_m_;
  std::optional<Checkerboard> squares_;
  const PrintedPattern* pattern_ = nullptr;
};

struct Canvas {
  Tile& tile;
  std::array<float, Tile::kPixels> rest;  // of the light that still comes from behind
};

void FillPlain(const Colour& colour, const Quadratic& shade, Tile& tile) {
  const Eigen::Vector3f c = colour.cast<float>();
  Row light;
  for (std::size_t y = 0, at = 0; y < kTile; ++y) {
    shade.Fill(static_cast<float>(y) / kTile, light);
    for (std::size_t x = 0; x < kTile; ++x, ++at) {
      tile.red[at] = c[0] * light[x];
      tile.green[at] = c[1] * light[x];
      tile.blue[at] = c[2] * light[x];
    }
  }
}

// Plane coordinates of one row of pixels.
struct Coordinates {
  Quadratic Na, Nb, D;
  const PanelView& view;
  Row a_m, b_m;

  Coordinates(const PanelView& seen, const Rays& rays)
      : Na(Along(seen.Na, rays)), Nb(Along(seen.Nb, rays)), D(Along(seen.D, rays)), view(seen), a_m{}, b_m{} {}
  void Fill(float y) {
    Row d;
    Na.Fill(y, a_m), Nb.Fill(y, b_m), D.Fill(y, d);
    for (std::size_t x = 0; x < kTile; ++x) {
      const float inverse = 1 / std::max(d[x], view.least);
      a_m[x] *= inverse, b_m[x] *= inverse;
    }
    if (!view.panel->bend.is_flat()) Bend();
  }
  // A ray goes on until it meets the bent plate.
  void Bend() {
    for (std::size_t x = 0; x < kTile; ++x) {
      const auto farther = static_cast<float>(BendAlong(*view.panel, {a_m[x], b_m[x]}, view.from_m.z()));
      a_m[x] += farther * (a_m[x] - view.from_m.x());
      b_m[x] += farther * (b_m[x] - view.from_m.y());
    }
  }
};

void CoverRow(const Piece& piece, const Coordinates& at, const SoftEdge& edge, Row& cover) {
  const Eigen::Array2f half = piece.view->panel->half_m.cast<float>().array();
  const Eigen::Array2f per_blur = piece.blur_m.inverse();
  for (std::size_t x = 0; x < kTile; ++x)
    cover[x] =
        edge((half.x() - std::abs(at.a_m[x])) * per_blur.x()) * edge((half.y() - std::abs(at.b_m[x])) * per_blur.y());
}

void Paint(const Painter& painter, const Piece& piece, const Rays& rays, const Quadratic& shade, bool fills,
           Canvas& canvas) {
  const Panel& panel = *piece.view->panel;
  const bool is_board = panel.board_idx >= 0 && !piece.view->is_back;
  const Eigen::Vector3f colour = panel.colour.cast<float>();
  const Print board(painter.scene, is_board ? panel.board_idx : -1, piece.blur_m);
  const auto per_stretch = static_cast<float>(1 / panel.stretch_ratio);
  Coordinates at(*piece.view, rays);
  Row light, cover;
  cover.fill(1);
  for (std::size_t y = 0; y < kTile; ++y) {
    const float row = static_cast<float>(y) / kTile;
    shade.Fill(row, light);
    if (is_board || !fills) at.Fill(row);
    if (!fills) CoverRow(piece, at, Edge(), cover);
    for (std::size_t x = 0; x < kTile; ++x) {
      const std::size_t i = y * kTile + x;
      const float part = canvas.rest[i] * cover[x],
                  grey = is_board ? board.Grey(at.a_m[x] * per_stretch, at.b_m[x]) : 0;
      canvas.rest[i] -= part;
      canvas.tile.red[i] += part * light[x] * (is_board ? grey : colour[0]);
      canvas.tile.green[i] += part * light[x] * (is_board ? grey : colour[1]);
      canvas.tile.blue[i] += part * light[x] * (is_board ? grey : colour[2]);
    }
  }
}

}  // namespace

void DrawTile(const Painter& painter, const std::vector<const PanelView*>& views, int tile_x, int tile_y, Tile& tile) {
  Rays rays;
  float brightness[9];
  for (int i = 0; i < 9; ++i) {
    const std::size_t node = painter.grid.NodeIndex(2 * tile_x + i % 3, 2 * tile_y + i / 3);
    rays[i] = painter.grid.rays[node];
    brightness[i] = painter.grid.brightness[node];
  }
  const std::vector<Piece> pieces = PiecesOf(painter, views, rays);
  if (pieces.size() == 1 && pieces[0].view->panel->board_idx < 0)
    return FillPlain(pieces[0].view->panel->colour, ShadeOf(painter, *pieces[0].view, rays, brightness), tile);
  Canvas canvas{tile, {}};
  canvas.rest.fill(1);
  for (std::array<float, Tile::kPixels>* channel : {&tile.red, &tile.green, &tile.blue}) channel->fill(0);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool fills = pieces[i].cover == Cover::kWhole || i + 1 == pieces.size();
    Paint(painter, pieces[i], rays, ShadeOf(painter, *pieces[i].view, rays, brightness), fills, canvas);
  }
}

}  // namespace rigcal::sim
