#include "backend/front.hpp"

#include <Eigen/Cholesky>

namespace motorcade {
namespace {

constexpr double kSingularPivot = 1e-13;  // relative to the diagonal before elimination; rounding leaves about 1e-16 times the size

/// Fast path: empty handed (false, front unchanged) when a pivot is doubtful.
bool factorizeWhole(Eigen::Ref<Eigen::MatrixXd> H) {
  const Eigen::LLT<Eigen::MatrixXd> cholesky(H);
  if (cholesky.info() != Eigen::Success) return false;
  const auto& L = cholesky.matrixLLT();
  for (Eigen::Index i = 0; i < H.rows(); ++i)
    if (!(L(i, i) * L(i, i) > kSingularPivot * H(i, i))) return false;
  H = L;
  return true;
}

/// Scalar by scalar over whole columns of the front; replaces pivots that vanish.
std::vector<int> factorizeByScalar(Front& front, int eliminated) {
  const Eigen::VectorXd diagonal = front.diagonal().head(eliminated);
  std::vector<int> singular;
  for (int k = 0; k < eliminated; ++k) {
    const Eigen::Index below = front.rows() - k - 1;
    if (!(front(k, k) > kSingularPivot * diagonal[k]) || !std::isfinite(front(k, k))) {
      singular.push_back(k);
      front(k, k) = 1.0;
      front.col(k).tail(below).setZero();
      continue;
    }
    front(k, k) = std::sqrt(front(k, k));
    front.col(k).tail(below) /= front(k, k);
    const Eigen::VectorXd column = front.col(k).tail(below);
    front.bottomRightCorner(below, below).selfadjointView<Eigen::Lower>().rankUpdate(column, -1.0);
  }
  return singular;
}

void addTerm(Front& front, const Contribution& contribution, const FactorGraph& graph, const std::vector<int>& offset) {
  const LinearTerm& term = *contribution.term;
  struct Block {
    int from, to, size;
  };
  std::vector<Block> blocks;
  int from = 0;
  for (const VariableId v : contribution.variables) {
    blocks.push_back({from, offset[static_cast<std::size_t>(v.value)], graph.sizeOf(v)});
    from += blocks.back().size;
  }
  blocks.push_back({from, static_cast<int>(front.rows()) - 1, 1});
  for (std::size_t a = 0; a < blocks.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const Block &row = blocks[a], &column = blocks[b];
      const bool flipped = row.to < column.to;
      const Block &low = flipped ? column : row, &high = flipped ? row : column;
      auto target = front.block(low.to, high.to, low.size, high.size);
      if (term.form == Factor::Form::kJacobian) {
        target += term.matrix.middleCols(low.from, low.size).transpose().lazyProduct(term.matrix.middleCols(high.from, high.size));
      } else if (!flipped) {
        const auto source = term.matrix.block(row.from, column.from, row.size, column.size);
        if (a == b)
          target.triangularView<Eigen::Lower>() += source;
        else
          target += source;
      } else {
        target += term.matrix.block(row.from, column.from, row.size, column.size).transpose();
      }
    }
  }
}

}  // namespace

Front assembleFront(std::span<const VariableId> variables, std::span<const Contribution> contributions, const FactorGraph& graph,
                    std::vector<int>& offset, std::vector<double>& workspace) {
  int size = 0;
  for (const VariableId v : variables) {
    offset[static_cast<std::size_t>(v.value)] = size;
    size += graph.sizeOf(v);
  }
  workspace.assign(static_cast<std::size_t>(size + 1) * static_cast<std::size_t>(size + 1), 0.0);
  Front front(workspace.data(), size + 1, size + 1);
  for (const Contribution& c : contributions) addTerm(front, c, graph, offset);
  return front;
}

std::vector<int> eliminateFront(Front& front, int eliminated) {
  const Eigen::Index rest = front.rows() - eliminated;
  auto H = front.topLeftCorner(eliminated, eliminated);
  if (!factorizeWhole(H)) return factorizeByScalar(front, eliminated);
  auto panel = front.bottomLeftCorner(rest, eliminated);
  H.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(panel);
  front.bottomRightCorner(rest, rest).selfadjointView<Eigen::Lower>().rankUpdate(panel, -1.0);
  return {};
}

}  // namespace motorcade
