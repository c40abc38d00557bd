#include <algorithm>
#include <random>

#include <Eigen/Cholesky>
#include <benchmark/benchmark.h>

#include "backend/elimination/dense_substitution.hpp"

/// Measures each kernel beside Eigen's solution of the same task. The rate "flops" counts a multiplication with its
/// addition as two.
namespace motorcade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kProblems = 8;

MatrixXd randomMatrix(int rows, int cols, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// Panels of random problems, unfactorized and factorized, and right-hand sides for them.
struct Panels {
  int rows, columns, ld = padded(rows);
  std::vector<MatrixXd> information, factors;
  std::vector<VectorXd> right;

  Panels(int rows_, int columns_) : rows(rows_), columns(columns_) {
    std::mt19937 random(1);
    std::vector<int> singular;
    for (int i = 0; i < kProblems; ++i) {
      const MatrixXd J = randomMatrix(ld, ld, random);
      information.push_back((MatrixXd::Identity(ld, ld) * ld + J.transpose() * J).leftCols(columns));
      factors.push_back(information.back());
      factorizePanel(in(factors.back()), singular);
      right.emplace_back(randomMatrix(ld, 1, random));
    }
  }
  Panel in(MatrixXd& matrix) const { return {.data = matrix.data(), .ld = ld, .rows = rows, .columns = columns}; }
};

void reportFlops(benchmark::State& state, double flops) {
  state.SetItemsProcessed(state.iterations());
  state.counters["flops"] = benchmark::Counter(flops, benchmark::Counter::kIsIterationInvariantRate);
}

double factorizationFlops(double rows, double columns) {
  const double below = rows - columns;
  return columns * columns * columns / 3 + below * columns * columns;
}

double outerProductFlops(double n, double k) { return n * (n + 1) * k; }

void eliminateByEigen(MatrixXd& panel, int rows, int columns) {
  auto H = panel.topLeftCorner(columns, columns);
  Eigen::LLT<Eigen::Ref<MatrixXd>> in_place(H);
  auto below = panel.middleRows(columns, rows - columns);
  H.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
}

// Both include the copy of the panel.
void BM_FactorizePanel(benchmark::State& state) {
  const Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  MatrixXd panel(panels.ld, panels.columns);
  std::vector<int> singular;
  std::size_t i = 0;
  for (auto _ : state) {
    panel = panels.information[i++ % kProblems];
    benchmark::DoNotOptimize(factorizePanel(panels.in(panel), singular));
  }
  reportFlops(state, factorizationFlops(panels.rows, panels.columns));
}

void BM_FactorizePanelByEigen(benchmark::State& state) {
  const Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  MatrixXd panel(panels.ld, panels.columns);
  std::size_t i = 0;
  for (auto _ : state) {
    panel = panels.information[i++ % kProblems];
    eliminateByEigen(panel, panels.rows, panels.columns);
    benchmark::DoNotOptimize(panel.data());
    benchmark::ClobberMemory();
  }
  reportFlops(state, factorizationFlops(panels.rows, panels.columns));
}

void BM_OuterProduct(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0)), k = static_cast<int>(state.range(1));
  std::mt19937 random(1);
  const MatrixXd A = randomMatrix(padded(n), k, random);
  MatrixXd C = MatrixXd::Zero(padded(n), n);
  for (auto _ : state) {
    subtractOuterProduct(C.data(), padded(n), A.data(), padded(n), n, k);
    benchmark::ClobberMemory();
  }
  reportFlops(state, outerProductFlops(n, k));
}

void BM_OuterProductByEigen(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0)), k = static_cast<int>(state.range(1));
  std::mt19937 random(1);
  const MatrixXd A = randomMatrix(n, k, random);
  MatrixXd C = MatrixXd::Zero(n, n);
  for (auto _ : state) {
    C.selfadjointView<Eigen::Lower>().rankUpdate(A, -1.0);
    benchmark::ClobberMemory();
  }
  reportFlops(state, outerProductFlops(n, k));
}

/// A clique's whole elimination: its factor, and the contribution to its parent.
void BM_EliminateClique(benchmark::State& state) {
  const Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const int rest = panels.rows - panels.columns;
  MatrixXd panel(panels.ld, panels.columns), update = MatrixXd::Zero(padded(rest), rest);
  std::vector<int> singular;
  std::size_t i = 0;
  for (auto _ : state) {
    panel = panels.information[i++ % kProblems];
    factorizePanel(panels.in(panel), singular);
    subtractOuterProduct(update.data(), padded(rest), panel.data() + panels.columns, panels.ld, rest, panels.columns);
    benchmark::ClobberMemory();
  }
  reportFlops(state, factorizationFlops(panels.rows, panels.columns) + outerProductFlops(rest, panels.columns));
}

void BM_EliminateCliqueByEigen(benchmark::State& state) {
  const Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const int rest = panels.rows - panels.columns;
  MatrixXd panel(panels.ld, panels.columns), update = MatrixXd::Zero(rest, rest);
  std::size_t i = 0;
  for (auto _ : state) {
    panel = panels.information[i++ % kProblems];
    eliminateByEigen(panel, panels.rows, panels.columns);
    update.selfadjointView<Eigen::Lower>().rankUpdate(panel.middleRows(panels.columns, rest), -1.0);
    benchmark::ClobberMemory();
  }
  reportFlops(state, factorizationFlops(panels.rows, panels.columns) + outerProductFlops(rest, panels.columns));
}

void BM_JacobianProduct(benchmark::State& state) {
  const int rows = static_cast<int>(state.range(0)), cols = static_cast<int>(state.range(1));
  std::mt19937 random(1);
  const MatrixXd jacobians = randomMatrix(rows * cols, 64, random);
  MatrixXd H = MatrixXd::Zero(padded(cols), cols);
  int i = 0;
  for (auto _ : state) {
    addJacobianProduct(jacobians.col(i++ % 64).data(), rows, cols, H.data(), padded(cols));
    benchmark::ClobberMemory();
  }
  reportFlops(state, outerProductFlops(cols, rows));
}

void BM_JacobianProductByEigen(benchmark::State& state) {
  const int rows = static_cast<int>(state.range(0)), cols = static_cast<int>(state.range(1));
  std::mt19937 random(1);
  const MatrixXd jacobians = randomMatrix(rows * cols, 64, random);
  MatrixXd H = MatrixXd::Zero(cols, cols);
  int i = 0;
  for (auto _ : state) {
    const Eigen::Map<const MatrixXd> J(jacobians.col(i++ % 64).data(), rows, cols);
    H.triangularView<Eigen::Lower>() += J.transpose().lazyProduct(J);
    benchmark::ClobberMemory();
  }
  reportFlops(state, outerProductFlops(cols, rows));
}

void BM_BackSubstitute(benchmark::State& state) {
  Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  VectorXd x(panels.columns);
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t problem = i++ % kProblems;
    backSubstitute(panels.in(panels.factors[problem]), panels.right[problem].data(), x.data());
    benchmark::ClobberMemory();
  }
  reportFlops(state, panels.columns * (2.0 * panels.rows - panels.columns));
}

void BM_BackSubstituteByEigen(benchmark::State& state) {
  const Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const int columns = panels.columns, separator = panels.rows - 1 - columns;
  VectorXd x(columns);
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t problem = i++ % kProblems;
    const MatrixXd& L = panels.factors[problem];
    x = -L.row(panels.rows - 1).transpose();
    x.noalias() -= L.middleRows(columns, separator).transpose() * panels.right[problem].head(separator);
    L.topRows(columns).triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    benchmark::ClobberMemory();
  }
  reportFlops(state, columns * (2.0 * panels.rows - columns));
}

void BM_ForwardSubstitute(benchmark::State& state) {
  Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  VectorXd g(panels.ld);
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t problem = i++ % kProblems;
    g = panels.right[problem];
    forwardSubstitute(panels.in(panels.factors[problem]), {}, g.data());
    benchmark::ClobberMemory();
  }
  reportFlops(state, panels.columns * (2.0 * panels.rows - panels.columns));
}

void BM_ForwardSubstituteByEigen(benchmark::State& state) {
  Panels panels(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const int columns = panels.columns, separator = panels.rows - 1 - columns;
  VectorXd g(panels.ld);
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t problem = i++ % kProblems;
    MatrixXd& L = panels.factors[problem];
    g = panels.right[problem];
    auto d = g.head(columns);
    L.topRows(columns).triangularView<Eigen::Lower>().solveInPlace(d);
    g.segment(columns, separator).noalias() -= L.middleRows(columns, separator) * d;
    L.row(panels.rows - 1) = d.transpose();
    benchmark::ClobberMemory();
  }
  reportFlops(state, columns * (2.0 * panels.rows - columns));
}

void panelSizes(benchmark::internal::Benchmark* b) {
  for (const auto& [rows, columns] :
       {std::pair{10, 3}, {19, 6}, {31, 6}, {60, 6}, {60, 12}, {100, 30}, {200, 60}, {301, 300}, {600, 150}})
    b->Args({rows, columns});
}

void outerSizes(benchmark::internal::Benchmark* b) {
  for (const auto& [n, k] : {std::pair{13, 6}, {31, 6}, {48, 12}, {100, 30}, {300, 100}, {512, 100}}) b->Args({n, k});
}

void jacobianSizes(benchmark::internal::Benchmark* b) {
  for (const auto& [rows, cols] : {std::pair{3, 7}, {3, 13}, {6, 13}, {6, 19}, {6, 25}}) b->Args({rows, cols});
}

BENCHMARK(BM_FactorizePanel)->Apply(panelSizes);
BENCHMARK(BM_FactorizePanelByEigen)->Apply(panelSizes);
BENCHMARK(BM_OuterProduct)->Apply(outerSizes);
BENCHMARK(BM_OuterProductByEigen)->Apply(outerSizes);
BENCHMARK(BM_EliminateClique)->Apply(panelSizes);
BENCHMARK(BM_EliminateCliqueByEigen)->Apply(panelSizes);
BENCHMARK(BM_JacobianProduct)->Apply(jacobianSizes);
BENCHMARK(BM_JacobianProductByEigen)->Apply(jacobianSizes);
BENCHMARK(BM_BackSubstitute)->Apply(panelSizes);
BENCHMARK(BM_BackSubstituteByEigen)->Apply(panelSizes);
BENCHMARK(BM_ForwardSubstitute)->Apply(panelSizes);
BENCHMARK(BM_ForwardSubstituteByEigen)->Apply(panelSizes);

}  // namespace
}  // namespace motorcade
