#include "backend/graph/factor_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/graph/marginal_factor.hpp"
#include "tests/backend/factor_differences.hpp"
#include "tests/backend/random_factors.hpp"
#include "tests/backend/unpacked.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::numericJacobian;
using test::RandomWorld;
using test::residualAt;

constexpr double kResidualRounding = 1e-9;  // of whitened residuals of some hundreds
constexpr double kNumeric = 2e-4;           // of central differences with a step of 1e-6 on them

/// Four variables of a world, and factors between them.
struct Scene {
  explicit Scene(std::uint64_t seed, RandomWorld::Kind kind) : world(seed, kind) {
    for (int i = 0; i < 4; ++i) variables.push_back(world.addVariable(graph));
    for (const VariableId v : variables) factors.push_back(*graph.addFactor(world.prior(v)));
    for (std::size_t i = 0; i < 6; ++i)
      factors.push_back(*graph.addFactor(world.between(variables[i % 4], variables[(i + 1 + i / 4) % 4], true)));
  }

  /// Moves the coordinates of all variables, and the estimates with them.
  void move(double sigma) {
    for (const VariableId v : variables) {
      for (int i = 0; i < graph.sizeOf(v); ++i) graph[v].x[i] += world.noise().gaussian(sigma);
      graph.apply(v);
    }
  }
  std::vector<Value> estimatesOf(const Factor& factor) const {
    std::vector<Value> values;
    for (const VariableId v : factor.variables()) values.push_back(graph.estimate(v));
    return values;
  }
  Eigen::VectorXd coordinatesOf(const Factor& factor) const {
    std::vector<double> x;
    for (const VariableId v : factor.variables())
      x.insert(x.end(), graph[v].x.begin(), graph[v].x.begin() + graph.sizeOf(v));
    return Eigen::Map<Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  }
  /// What the linear model says at the present coordinates.
  Eigen::VectorXd modeled(FactorId f) const {
    const auto term = graph.term(f);
    return term.leftCols(term.cols() - 1) * coordinatesOf(graph.factor(f)) + term.col(term.cols() - 1);
  }

  RandomWorld world;
  FactorGraph graph;
  std::vector<VariableId> variables;
  std::vector<FactorId> factors;
};

template <class Check>
void forAllKinds(const Check& check) {
  for (const auto kind : RandomWorld::kKinds)
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      Scene scene(seed, kind);
      check(scene);
    }
}

TEST(FactorGraph, ANewModelIsTheFactorToFirstOrderInStepsOfTheWorldsAxes) {
  forAllKinds([](Scene& scene) {
    for (const FactorId f : scene.factors) {
      const JacobianFactor& factor = *scene.graph.jacobianFactor(f);
      const auto values = scene.estimatesOf(factor);
      const auto term = scene.graph.term(f);
      EXPECT_THAT(term.leftCols(term.cols() - 1), IsNear(numericJacobian(factor, values, displaced), kNumeric));
      EXPECT_THAT(scene.modeled(f), IsNear(residualAt(factor, values), kResidualRounding));
    }
  });
}

TEST(FactorGraph, AModelThatIsLinearizedAfterAMoveIsTheFactorThere) {
  forAllKinds([](Scene& scene) {
    scene.move(0.3);
    for (const VariableId v : scene.variables) scene.graph.moveLinearizationPoint(v);
    for (const FactorId f : scene.factors) {
      scene.graph.linearize(f);
      const JacobianFactor& factor = *scene.graph.jacobianFactor(f);
      const auto values = scene.estimatesOf(factor);
      const auto term = scene.graph.term(f);
      EXPECT_THAT(term.leftCols(term.cols() - 1), IsNear(numericJacobian(factor, values, displaced), kNumeric));
      EXPECT_THAT(scene.modeled(f), IsNear(residualAt(factor, values), kResidualRounding));
      EXPECT_LT(scene.graph.mismatch(f).norm, kResidualRounding);
    }
  });
}

TEST(FactorGraph, AFactorAddedAfterAMoveIsStatedInTheSameCoordinates) {
  forAllKinds([](Scene& scene) {
    scene.move(0.3);
    for (const VariableId v : scene.variables) scene.graph.moveLinearizationPoint(v);
    const FactorId f = *scene.graph.addFactor(scene.world.between(scene.variables[0], scene.variables[2], true));
    EXPECT_THAT(scene.modeled(f),
                IsNear(residualAt(*scene.graph.jacobianFactor(f), scene.estimatesOf(scene.graph.factor(f))),
                       kResidualRounding));
    EXPECT_LT(scene.graph.mismatch(f).norm, kResidualRounding);
  });
}

TEST(FactorGraph, TheMismatchIsWhatTheModelMissesOfTheFactor) {
  forAllKinds([](Scene& scene) {
    scene.move(0.1);
    for (const FactorId f : scene.factors) {
      const Eigen::VectorXd missed =
          residualAt(*scene.graph.jacobianFactor(f), scene.estimatesOf(scene.graph.factor(f))) - scene.modeled(f);
      const auto mismatch = scene.graph.mismatch(f);
      EXPECT_NEAR(mismatch.norm, missed.norm(), kResidualRounding);
      ASSERT_EQ(static_cast<Eigen::Index>(mismatch.r.size()), missed.size());
      for (Eigen::Index i = 0; i < missed.size(); ++i) EXPECT_NEAR(mismatch.r[i], missed[i], kResidualRounding);
    }
  });
}

TEST(FactorGraph, TheMismatchGrowsWithTheSquareOfTheStep) {
  // Steps of the same direction, one half as long: a quarter of the mismatch, up to the third order.
  const auto total = [](std::uint64_t seed, RandomWorld::Kind kind, double sigma) {
    Scene scene(seed, kind);
    scene.move(sigma);
    double sum = 0;
    for (const FactorId f : scene.factors) sum += scene.graph.mismatch(f).norm;
    return sum;
  };
  for (const auto kind : RandomWorld::kKinds)
    for (std::uint64_t seed = 0; seed < 5; ++seed)
      EXPECT_NEAR(total(seed, kind, 1e-3) / total(seed, kind, 5e-4), 4.0, 0.05);
}

TEST(FactorGraph, ACorrectedModelMeetsTheFactorWithItsFormerJacobian) {
  forAllKinds([](Scene& scene) {
    scene.move(0.1);
    for (const FactorId f : scene.factors) {
      const auto term = scene.graph.term(f);
      const Eigen::MatrixXd before = term.leftCols(term.cols() - 1);
      const auto mismatch = scene.graph.mismatch(f);
      scene.graph.correctResidual(f, mismatch.r);
      EXPECT_LT(scene.graph.mismatch(f).norm, kResidualRounding);
      EXPECT_EQ(before, scene.graph.term(f).leftCols(before.cols()));
    }
  });
}

TEST(FactorGraph, RestartingTheCoordinatesKeepsTheEstimates) {
  forAllKinds([](Scene& scene) {
    scene.move(0.3);
    std::vector<Value> before;
    for (const VariableId v : scene.variables) before.push_back(scene.graph.estimate(v));
    scene.graph.restartCoordinates();
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_LT(local(before[i], scene.graph.estimate(scene.variables[i])).norm(), kResidualRounding);
      EXPECT_EQ(scene.graph[scene.variables[i]].x, FactorGraph::Coordinates{});
    }
    for (const FactorId f : scene.factors) {
      scene.graph.linearize(f);
      EXPECT_THAT(scene.modeled(f),
                  IsNear(residualAt(*scene.graph.jacobianFactor(f), scene.estimatesOf(scene.graph.factor(f))),
                         kResidualRounding));
    }
  });
}

/// Holds a model at zero; elsewhere it is another one.
class HoldingFactor final : public InformationFactor {
 public:
  explicit HoldingFactor(VariableId v) : InformationFactor({v}, 4) {
    pack((Eigen::Matrix4d() << 2, 0, 0, 0, 1, 3, 0, 0, 0, 1, 4, 0, 1, 2, 3, 5).finished(), held_);
  }
  void linearize(std::span<const Value* const>, Eigen::Ref<Eigen::MatrixXd> term) const override {
    term = 7 * Eigen::Matrix4d::Identity();
  }
  const Quadratic* heldModel(std::span<const Value* const> values) const override {
    return std::get<SmallVector>(*values[0]).norm() == 0 ? &held_ : nullptr;
  }

 private:
  Quadratic held_;
};

TEST(FactorGraph, AModelThatAFactorHoldsIsNotCopied) {
  FactorGraph graph;
  const VariableId v = graph.addVariable(SmallVector(SmallVector::Zero(3)));
  const FactorId f = *graph.addFactor(std::make_unique<HoldingFactor>(v));
  const auto heldBy = [&](const Value& value) { return graph.informationFactor(f)->heldModel(std::array{&value}); };
  const Quadratic& held = *heldBy(SmallVector(SmallVector::Zero(3)));
  const Eigen::VectorXd g_c = held.g_c;
  EXPECT_EQ(graph.information(f).H.data, held.lower_H.data());
  EXPECT_EQ(graph.information(f).g_c, g_c);
  EXPECT_EQ(graph[v].information[1], 3);
  graph.correctResidual(f, std::array{0.5, 0.0, 0.0});
  EXPECT_EQ(graph.information(f).g_c[0], g_c[0] + 0.5);
  EXPECT_EQ(held.g_c, g_c);

  graph[v].x[0] = 1;
  graph.linearize(f);
  EXPECT_NE(graph.information(f).H.data, held.lower_H.data());
  EXPECT_EQ(graph.information(f).H.column(1)[1], 7);
  EXPECT_EQ(graph.information(f).g_c[0], -7);  // in the coordinates
  graph[v].x[0] = 0;
  graph.linearize(f);
  EXPECT_EQ(graph.information(f).H.data, held.lower_H.data());
  EXPECT_EQ(graph.information(f).g_c, g_c);
}

TEST(FactorGraph, AMarginalPriorsModelHasTheGradientOfItsCost) {
  // The quadratic of a marginal in steps from where it was made, at estimates that have moved on.
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Scene scene(seed, RandomWorld::kKinds[seed % 4]);
    std::vector<Value> values;
    Eigen::Index n = 0;
    for (const VariableId v : scene.variables) {
      values.push_back(scene.graph.estimate(v));
      n += scene.graph.sizeOf(v);
    }
    Eigen::MatrixXd root(n + 2, n + 1);
    for (double& entry : root.reshaped()) entry = scene.world.noise().gaussian();
    const Eigen::MatrixXd information = root.transpose() * root;
    const FactorId f = *scene.graph.addFactor(std::make_unique<MarginalFactor>(scene.variables, values, information));
    EXPECT_LT(scene.graph.mismatch(f).norm, kResidualRounding);
    const auto cost = [&](const std::vector<Value>& at) {
      Eigen::VectorXd e(n + 1);
      Eigen::Index row = 0;
      for (std::size_t k = 0; k < at.size(); ++k) {
        const SmallVector step = displacement(values[k], at[k]);
        e.segment(row, step.size()) = step;
        row += step.size();
      }
      e[n] = 1;
      return e.dot(information * e);
    };
    scene.move(0.05);
    scene.graph.linearize(f);
    const auto now = scene.estimatesOf(scene.graph.factor(f));
    const auto model = scene.graph.information(f);
    const Eigen::MatrixXd H = test::unpacked(model.H, model.g_c).topLeftCorner(n, n);
    const Eigen::VectorXd gradient = 2 * (H * scene.coordinatesOf(scene.graph.factor(f)) + model.g());
    Eigen::Index row = 0;
    for (std::size_t k = 0; k < now.size(); ++k) {
      for (int i = 0; i < dimension(now[k]); ++i, ++row) {
        constexpr double kStep = 1e-5;
        auto plus = now, minus = now;
        plus[k] = displaced(now[k], kStep * SmallVector::Unit(dimension(now[k]), i));
        minus[k] = displaced(now[k], -kStep * SmallVector::Unit(dimension(now[k]), i));
        EXPECT_NEAR(gradient[row], (cost(plus) - cost(minus)) / (2 * kStep), 1e-5) << "seed " << seed;
      }
    }
  }
}

TEST(FactorGraph, TheTotalCostIsTheSumOfTheSquaredResiduals) {
  forAllKinds([](Scene& scene) {
    scene.graph.removeFactor(scene.factors.back());
    scene.factors.pop_back();
    scene.move(0.1);
    double expected = 0;
    for (const FactorId f : scene.factors) {
      scene.graph.mismatch(f);
      expected += residualAt(*scene.graph.jacobianFactor(f), scene.estimatesOf(scene.graph.factor(f))).squaredNorm();
    }
    EXPECT_NEAR(scene.graph.totalCost(), expected, kResidualRounding * expected);
  });
}

TEST(FactorGraph, TheTurnSinceLinearizationIsTheAngle) {
  Scene space(0, RandomWorld::Kind::kSpace), plane(0, RandomWorld::Kind::kPlane);
  for (auto* scene : {&space, &plane}) {
    const VariableId v = scene->variables[0];
    EXPECT_NEAR(scene->graph.turnSinceLinearization(v), 0, 1e-7);
    const bool planar = scene == &plane;
    scene->graph[v].x[planar ? 2 : 4] += 0.3;
    scene->graph[v].x[0] += 5;
    scene->graph.apply(v);
    EXPECT_NEAR(scene->graph.turnSinceLinearization(v), 0.3, kResidualRounding);
    scene->graph.moveLinearizationPoint(v);
    EXPECT_NEAR(scene->graph.turnSinceLinearization(v), 0, 1e-7);
  }
}

TEST(FactorGraph, KeepsBooksOfWhatComesAndGoes) {
  Scene scene(1, RandomWorld::Kind::kMixed);
  FactorGraph& graph = scene.graph;
  EXPECT_EQ(graph.variableCount(), 4U);
  EXPECT_EQ(graph.factorCount(), 10U);
  const VariableId gone = scene.variables[3];
  for (const FactorId f : std::vector(graph[gone].factors)) {
    graph.removeFactor(f);
    EXPECT_FALSE(graph.contains(f));
    for (const VariableId v : scene.variables) EXPECT_THAT(graph[v].factors, testing::Not(testing::Contains(f)));
  }
  graph.removeVariable(gone);
  EXPECT_FALSE(graph.contains(gone));
  EXPECT_THAT(graph.variables(), testing::ElementsAre(scene.variables[0], scene.variables[1], scene.variables[2]));
  EXPECT_EQ(graph.factors().size(), graph.factorCount());
  // The slot of one that left serves one that comes, without a trace of it.
  const VariableId next = graph.addVariable(SE3{});
  EXPECT_TRUE(graph.contains(next));
  EXPECT_EQ(graph.slots(), 4U);
  EXPECT_TRUE(graph[next].factors.empty());
  EXPECT_EQ(graph[next].information, FactorGraph::Coordinates{});
}

TEST(FactorGraph, RefusesAFactorThatIsNotFinite) {
  Scene scene(2, RandomWorld::Kind::kSpace);
  const std::size_t before = scene.graph.factorCount();
  const double cost = scene.graph.totalCost();
  const SE3 broken(Eigen::Matrix3d::Identity(), {0, std::numeric_limits<double>::infinity(), 0});
  EXPECT_FALSE(scene.graph.addFactor(
      std::make_unique<PriorFactor>(std::array{scene.variables[0]}, PriorModel{broken}, PoseNoise{})));
  EXPECT_EQ(scene.graph.factorCount(), before);
  EXPECT_EQ(scene.graph.totalCost(), cost);
}

}  // namespace
}  // namespace motorcade
