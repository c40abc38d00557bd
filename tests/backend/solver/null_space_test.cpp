#include "backend/solver/null_space.hpp"

#include <algorithm>

#include <Eigen/QR>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/elimination/eliminator.hpp"
#include "backend/graph/marginal_factor.hpp"
#include "core/decompositions.hpp"
#include "tests/backend/random_factors.hpp"
#include "tests/backend/tree_information.hpp"
#include "tests/support/matchers.hpp"

/// Directions from back-substitution in the tree, against dense linear algebra on the sum of the factors.
namespace motorcade {
namespace {

using Constraint = NullSpaceDirection::Constraint;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::IsNear;
using test::RandomWorld;

constexpr double kSmallestStep = 1e-7;  // over the largest: what is below 1e-8 of it counts as rounding

/// A chain of a few variables with some more measurements between them, eliminated in random order.
struct Scene {
  Scene(std::uint64_t seed, RandomWorld::Kind kind) : world(seed, kind) {
    const std::size_t count = 2 + world.below(9);
    for (std::size_t i = 0; i < count; ++i) {
      variables.push_back(world.addVariable(graph));
      if (i > 0) graph.addFactor(world.between(variables[i - 1], variables[i], true));
      if (i > 2) graph.addFactor(world.between(variables[world.below(i - 1)], variables[i], true));
    }
  }

  void eliminate() {
    std::vector<VariableId> order = variables;
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[world.below(i)]);
    eliminator.eliminate({.order = order, .factors = graph.factors()});
  }

  /// All scalars, in elimination order.
  std::vector<FrontalScalar> scalars() const {
    auto cliques = tree.cliques();
    std::ranges::sort(cliques, {}, [&](int c) { return tree.sequence(c); });
    std::vector<FrontalScalar> all;
    for (const int c : cliques)
      for (int column = 0; column < tree[c].frontal_size; ++column) all.push_back({c, column});
    return all;
  }
  /// Their rows in the dense system.
  std::vector<int> rows(const test::DenseSystem& dense) const {
    std::vector<int> all;
    for (const FrontalScalar& scalar : scalars())
      all.push_back(dense.entries(tree[scalar.clique].frontalVariables())[scalar.column]);
    return all;
  }
  std::vector<FrontalScalar> weak(double ratio) const {
    std::vector<FrontalScalar> all;
    for (const int c : tree.cliques())
      for (const FrontalScalar& scalar : weakScalars(tree, c, ratio)) all.push_back(scalar);
    return all;
  }

  RandomWorld world;
  FactorGraph graph;
  EliminationTree tree;
  Eliminator eliminator{graph, tree};
  std::vector<VariableId> variables;
};

MatrixXd informationOf(const Scene& scene, const test::DenseSystem& dense) {
  return test::informationOfFactors(scene.graph, dense).topLeftCorner(dense.size(), dense.size());
}

VectorXd stacked(const NullSpaceDirection& direction, const test::DenseSystem& dense) {
  VectorXd x = VectorXd::Zero(dense.size());
  for (const auto& [v, step] : direction.steps) x.segment(dense.offset(v), step.size()) = step;
  return x;
}

TEST(NullSpace, AlongADirectionEarlierScalarsMoveSoThatTheCostRisesLeast) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Scene scene(seed, RandomWorld::kKinds[seed % 4]);
    for (const VariableId v : scene.variables) scene.graph.addFactor(scene.world.prior(v, 10));
    scene.eliminate();
    const test::DenseSystem dense(scene.graph);
    const MatrixXd H = informationOf(scene, dense);
    const auto scalars = scene.scalars();
    const auto rows = scene.rows(dense);
    for (std::size_t i = 0; i < scalars.size(); ++i) {
      const std::vector<int> earlier(rows.begin(), rows.begin() + i);
      VectorXd expected = VectorXd::Unit(dense.size(), rows[i]);
      if (i > 0) expected(earlier) = -test::solved(H(earlier, earlier), H.col(rows[i])(earlier));
      const auto direction = nullSpaceDirection(scene.graph, scene.tree, scalars[i]);
      ASSERT_THAT(stacked(direction, dense), IsNear(expected, kSmallestStep * expected.cwiseAbs().maxCoeff()))
          << "seed " << seed << ", scalar " << i;
      EXPECT_EQ(direction.constraint, Constraint::kWeak);
      const int held = rows[i] - dense.offset(direction.held);
      EXPECT_TRUE(held >= 0 && held < scene.graph.sizeOf(direction.held));
    }
  }
}

/// Orthonormal; the gap between its eigenvalues, which are rounding, and the others is wide.
MatrixXd denseNullSpace(const MatrixXd& H) {
  const SymmetricEigen eigen(H);
  const double rounding = 1e-12 * eigen.values.maxCoeff();
  return eigen.vectors.leftCols((eigen.values.array() < rounding).count());
}

TEST(NullSpace, WithoutAPriorTheDirectionsSpanTheMotionsOfTheWhole) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const bool in_space = seed % 2 == 0;
    Scene scene(seed, in_space ? RandomWorld::Kind::kSpace : RandomWorld::Kind::kPlane);
    scene.eliminate();
    const test::DenseSystem dense(scene.graph);
    const MatrixXd H = informationOf(scene, dense), expected = denseNullSpace(H);
    const auto weak = scene.weak(1e-11);
    ASSERT_EQ(expected.cols(), in_space ? 6 : 3);
    ASSERT_EQ(static_cast<Eigen::Index>(weak.size()), expected.cols()) << "seed " << seed;
    MatrixXd found(dense.size(), expected.cols());
    for (std::size_t i = 0; i < weak.size(); ++i) {
      const auto direction = nullSpaceDirection(scene.graph, scene.tree, weak[i]);
      const VectorXd x = stacked(direction, dense), projected = expected * (expected.transpose() * x);
      found.col(i) = x;
      EXPECT_EQ(direction.constraint, Constraint::kNone);
      EXPECT_EQ(direction.steps.size(), scene.variables.size());
      EXPECT_THAT(projected, IsNear(x, 1e-6 * x.cwiseAbs().maxCoeff()));
    }
    EXPECT_EQ(found.fullPivHouseholderQr().rank(), expected.cols());
  }
}

TEST(NullSpace, APriorThatSaysNextToNothingConstrainsWeakly) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Scene scene(seed, RandomWorld::Kind::kPlane);
    scene.graph.addFactor(scene.world.prior(scene.variables.front(), 1e7));
    scene.eliminate();
    const auto weak = scene.weak(1e-11);
    ASSERT_EQ(weak.size(), 3U) << "seed " << seed;
    for (const FrontalScalar& scalar : weak)
      EXPECT_EQ(nullSpaceDirection(scene.graph, scene.tree, scalar).constraint, Constraint::kWeak);
  }
}

TEST(NullSpace, AlongNegativeInformationTheCostFalls) {
  FactorGraph graph;
  EliminationTree tree;
  Eliminator eliminator(graph, tree);
  const Value origin = SmallVector(SmallVector::Zero(3));
  const VariableId v = graph.addVariable(origin);
  MatrixXd information = MatrixXd::Identity(4, 4);
  information(1, 1) = -4;
  graph.addFactor(std::make_unique<MarginalFactor>(std::vector{v}, std::vector{origin}, information));
  eliminator.eliminate({.order = std::array{v}, .factors = graph.factors()});
  const auto weak = weakScalars(tree, tree.cliqueOf(v), 1e-11);
  ASSERT_EQ(weak.size(), 1U);
  EXPECT_EQ(weak[0].column, 1);
  const auto direction = nullSpaceDirection(graph, tree, weak[0]);
  EXPECT_EQ(direction.constraint, Constraint::kNegative);
  EXPECT_EQ(direction.held, v);
  ASSERT_EQ(direction.steps.size(), 1U);
  EXPECT_THAT(direction.steps[0].step, IsNear(SmallVector(SmallVector::Unit(3, 1)), 1e-12));
}

/// Rest of the diagonal entry when others are eliminated.
double schurDiagonal(const MatrixXd& H, const std::vector<int>& eliminated, int row) {
  if (eliminated.empty()) return H(row, row);
  const VectorXd coupling = H.col(row)(eliminated);
  return H(row, row) - coupling.dot(VectorXd(test::solved(H(eliminated, eliminated), coupling)));
}

TEST(NullSpace, WeakScalarsAreThoseWhoseCliqueTakesMostOfTheirInformation) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Scene scene(seed, RandomWorld::kKinds[seed % 4]);
    for (const VariableId v : scene.variables) scene.graph.addFactor(scene.world.prior(v, 10));
    scene.eliminate();
    const test::DenseSystem dense(scene.graph);
    const MatrixXd H = informationOf(scene, dense);
    const auto scalars = scene.scalars();
    const auto rows = scene.rows(dense);
    for (std::size_t i = 0; i < scalars.size(); ++i) {
      const double pivot = schurDiagonal(H, {rows.begin(), rows.begin() + i}, rows[i]);
      const double before = schurDiagonal(H, {rows.begin(), rows.begin() + i - scalars[i].column}, rows[i]);
      for (const double ratio : {0.01, 0.3, 0.9}) {
        if (std::abs(pivot / before - ratio) < 1e-6) continue;  // rounding decides
        const auto weak = weakScalars(scene.tree, scalars[i].clique, ratio);
        EXPECT_EQ(std::ranges::count(weak, scalars[i].column, &FrontalScalar::column), pivot < ratio * before ? 1 : 0)
            << "seed " << seed << ", scalar " << i << ", ratio " << ratio;
      }
    }
  }
}

}  // namespace
}  // namespace motorcade
