#include "server/graph/dense_cholesky.h"

#include "server/graph/cholesky_kinds.h"

namespace rigcal::graph {

template <int B>
std::unique_ptr<BlockCholesky<B>> MakeDenseCholesky(const BlockPattern& pattern) {
  return std::make_unique<DenseCholesky<B>>(pattern);
}

template <int B>
std::unique_ptr<BlockCholesky<B>> MakeCholesky(const BlockPattern& pattern, int blocks_dense_max) {
  if (pattern.block_count <= blocks_dense_max) return MakeDenseCholesky<B>(pattern);
  return MakeSparseCholesky<B>(pattern);
}

template std::unique_ptr<BlockCholesky<1>> MakeCholesky<1>(const BlockPattern&, int);
template std::unique_ptr<BlockCholesky<3>> MakeCholesky<3>(const BlockPattern&, int);
template std::unique_ptr<BlockCholesky<6>> MakeCholesky<6>(const BlockPattern&, int);

}  // namespace rigcal::graph
