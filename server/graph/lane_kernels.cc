#include "server/graph/lane_kernels.h"

#include "server/graph/edge_series.h"

namespace rigcal::graph {
namespace {

constexpr double kFinite = __DBL_MAX__;

namespace portable {
#include "server/graph/lanes.inc"
#include "server/graph/triangle_lanes.inc"
#include "server/graph/information_lanes.inc"
#include "server/graph/edge_lanes.inc"
}

#pragma GCC push_options
#pragma GCC target("avx")
namespace avx {
#include "server/graph/lanes.inc"
#include "server/graph/triangle_lanes.inc"
#include "server/graph/information_lanes.inc"
#include "server/graph/edge_lanes.inc"
}
#pragma GCC pop_options

constexpr LaneKernels kPortable{portable::Factor, portable::Solve, portable::InverseColumns,
 portable::Information, portable::Residuals, portable::Forces};
constexpr LaneKernels kAvx{avx::Factor, avx::Solve, avx::InverseColumns,
 avx::Information, avx::Residuals, avx::Forces};

}  // namespace

const LaneKernels& PortableKernels() { return kPortable; }

const LaneKernels& Kernels() {
  static const LaneKernels& kernels = __builtin_cpu_supports("avx") ? kAvx : kPortable;
  return kernels;
}

}  // namespace rigcal::graph
