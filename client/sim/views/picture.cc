#include "client/sim/views/picture.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "client/sim/rig/random.h"
#include "client/sim/views/tile.h"

namespace rigcal::sim {
namespace {

constexpr int kBlockTiles = 8;  // tiles of a block along x and y: panels are chosen block by block first
constexpr int kJpegQuality = 90;
constexpr std::size_t kNoiseCount = 1 << 20;

// Noise is cut from one long list at random places: independent enough between pixels that are near, and fast.
const std::vector<float>& NoiseList() {
  static const std::vector<float> kList = [] {
    std::vector<float> list(kNoiseCount + kTile);
    Random random(KeyOf(0, "grey"));
    for (float& value : list) value = static_cast<float>(random.Normal());
    return list;
  }();
  return kList;
}

std::vector<const PanelView*> ViewsInBlock(const Painter& painter, const std::vector<PanelView>& views, int x, int y) {
  const auto clipped = [](int node, int tiles) { return std::min(node, 2 * tiles); };
  Eigen::Vector3f rays[9];
  for (int i = 0; i < 9; ++i)
    rays[i] = painter.grid.rays[painter.grid.NodeIndex(clipped((2 * x + i % 3) * kBlockTiles, painter.grid.tiles_x),
                                                       clipped((2 * y + i / 3) * kBlockTiles, painter.grid.tiles_y))];
  std::vector<const PanelView*> chosen;
  for (const PanelView& view : views)
    if (CoverOf(view, rays, kTile, SoftEdge::kReach * painter.blur_px) != Cover::kNone) chosen.push_back(&view);
  return chosen;
}

std::uint8_t Grey(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f); }

// One noise for the three colours of a pixel: what demosaicing makes of it is close to that.
void Develop(const Tile& tile, int tile_x, int tile_y, float noise_grey, Random& random, Picture& picture) {
  const std::vector<float>& noise = NoiseList();
  const int x0 = tile_x * kTile, y0 = tile_y * kTile;
  const int width = std::min(kTile, picture.width_px - x0), height = std::min(kTile, picture.height_px - y0);
  std::array<float, 3 * kTile> row;
  for (int y = 0; y < height; ++y) {
    const float* grain = noise.data() + (random.Bits() & (kNoiseCount - 1));
    const std::size_t at = static_cast<std::size_t>(y) * kTile;
    for (std::size_t x = 0; x < kTile; ++x) {
      const float shift = noise_grey * grain[x];
      row[3 * x] = 255 * tile.blue[at + x] + shift;
      row[3 * x + 1] = 255 * tile.green[at + x] + shift;
      row[3 * x + 2] = 255 * tile.red[at + x] + shift;
    }
    std::uint8_t* to =
        picture.bgr.data() + 3 * (static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(picture.width_px) +
                                  static_cast<std::size_t>(x0));
    for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(width); ++i) to[i] = Grey(row[i]);
  }
}

}  // namespace

Picture TakePicture(const Scene& scene, const CameraTruth& camera, const RayGrid& grid, const Se3& T_world_cam,
                    std::uint64_t key) {
  Picture picture{camera.width_px, camera.height_px, {}};
  picture.bgr.resize(3 * static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px));
  const std::vector<PanelView> views = PanelViews(scene, T_world_cam);
  const Painter painter{scene, grid, T_world_cam.p_m, T_world_cam.R(), static_cast<float>(camera.blur_px)};
  Random random(key);
  Tile tile;
  for (int block_y = 0; block_y * kBlockTiles < grid.tiles_y; ++block_y)
    for (int block_x = 0; block_x * kBlockTiles < grid.tiles_x; ++block_x) {
      const auto in_block = ViewsInBlock(painter, views, block_x, block_y);
      for (int y = block_y * kBlockTiles; y < std::min((block_y + 1) * kBlockTiles, grid.tiles_y); ++y)
        for (int x = block_x * kBlockTiles; x < std::min((block_x + 1) * kBlockTiles, grid.tiles_x); ++x) {
          DrawTile(painter, in_block, x, y, tile);
          Develop(tile, x, y, static_cast<float>(camera.noise_grey), random, picture);
        }
    }
  return picture;
}

std::string SuffixOf(PictureFormat format) { return format == PictureFormat::kPng ? "png" : "jpg"; }

Result<std::string> Encoded(const Picture& picture, PictureFormat format) {
  // The encoder only reads, yet its wrapper for memory takes a mutable pointer.
  const cv::Mat pixels(picture.height_px, picture.width_px, CV_8UC3, const_cast<std::uint8_t*>(picture.bgr.data()));
  const std::vector<int> jpeg = {cv::IMWRITE_JPEG_QUALITY, kJpegQuality};
  const std::vector<int> png = {cv::IMWRITE_PNG_COMPRESSION, 1};
  std::vector<std::uint8_t> bytes;
  try {
    cv::imencode("." + SuffixOf(format), pixels, bytes, format == PictureFormat::kPng ? png : jpeg);
  } catch (const cv::Exception& exception) {
    return Fail(ErrorCode::kInternal, std::string("the picture cannot be encoded: ") + exception.what(),
                "Use the other picture format.");
  }
  return std::string(bytes.begin(), bytes.end());
}

}  // namespace rigcal::sim
