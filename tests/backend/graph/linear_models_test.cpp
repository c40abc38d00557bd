#include "backend/graph/linear_models.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/graph/marginal_factor.hpp"
#include "tests/backend/factor_differences.hpp"
#include "tests/backend/graph_scene.hpp"
#include "tests/backend/unpacked.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::forAllKinds;
using test::GraphScene;
using test::IsNear;
using test::kResidualRounding;
using test::numericJacobian;
using test::RandomWorld;
using test::residualAt;

constexpr double kNumeric = 2e-4;  // of central differences with a step of 1e-6 on whitened residuals of some hundreds

TEST(LinearModels, ANewModelIsTheFactorToFirstOrderInStepsOfTheWorldsAxes) {
  forAllKinds([](GraphScene& scene) {
    for (const FactorId f : scene.factors) {
      const JacobianFactor& factor = *scene.models.jacobianFactor(f);
      const auto values = scene.estimatesOf(factor);
      const auto term = scene.models.term(f);
      EXPECT_THAT(term.leftCols(term.cols() - 1), IsNear(numericJacobian(factor, values, displaced), kNumeric));
      EXPECT_THAT(scene.modeled(f), IsNear(residualAt(factor, values), kResidualRounding));
    }
  });
}

TEST(LinearModels, AModelThatIsLinearizedAfterAMoveIsTheFactorThere) {
  forAllKinds([](GraphScene& scene) {
    scene.move(0.3);
    for (const VariableId v : scene.variables) scene.states.moveLinearizationPoint(v);
    for (const FactorId f : scene.factors) {
      scene.models.linearize(f);
      const JacobianFactor& factor = *scene.models.jacobianFactor(f);
      const auto values = scene.estimatesOf(factor);
      const auto term = scene.models.term(f);
      EXPECT_THAT(term.leftCols(term.cols() - 1), IsNear(numericJacobian(factor, values, displaced), kNumeric));
      EXPECT_THAT(scene.modeled(f), IsNear(residualAt(factor, values), kResidualRounding));
      EXPECT_LT(scene.models.mismatch(f).norm, kResidualRounding);
    }
  });
}

TEST(LinearModels, AFactorAddedAfterAMoveIsStatedInTheSameCoordinates) {
  forAllKinds([](GraphScene& scene) {
    scene.move(0.3);
    for (const VariableId v : scene.variables) scene.states.moveLinearizationPoint(v);
    const FactorId f = *scene.graph.addFactor(scene.world.between(scene.variables[0], scene.variables[2], true));
    EXPECT_THAT(scene.modeled(f),
                IsNear(residualAt(*scene.models.jacobianFactor(f), scene.estimatesOf(scene.models.factor(f))),
                       kResidualRounding));
    EXPECT_LT(scene.models.mismatch(f).norm, kResidualRounding);
  });
}

TEST(LinearModels, TheMismatchIsWhatTheModelMissesOfTheFactor) {
  forAllKinds([](GraphScene& scene) {
    scene.move(0.1);
    for (const FactorId f : scene.factors) {
      const Eigen::VectorXd missed =
          residualAt(*scene.models.jacobianFactor(f), scene.estimatesOf(scene.models.factor(f))) - scene.modeled(f);
      const auto mismatch = scene.models.mismatch(f);
      EXPECT_NEAR(mismatch.norm, missed.norm(), kResidualRounding);
      ASSERT_EQ(static_cast<Eigen::Index>(mismatch.r.size()), missed.size());
      for (Eigen::Index i = 0; i < missed.size(); ++i) EXPECT_NEAR(mismatch.r[i], missed[i], kResidualRounding);
    }
  });
}

TEST(LinearModels, TheMismatchGrowsWithTheSquareOfTheStep) {
  // Steps of the same direction, one half as long: a quarter of the mismatch, up to the third order.
  const auto total = [](std::uint64_t seed, RandomWorld::Kind kind, double sigma) {
    GraphScene scene(seed, kind);
    scene.move(sigma);
    double sum = 0;
    for (const FactorId f : scene.factors) sum += scene.models.mismatch(f).norm;
    return sum;
  };
  for (const auto kind : RandomWorld::kKinds)
    for (std::uint64_t seed = 0; seed < 5; ++seed)
      EXPECT_NEAR(total(seed, kind, 1e-3) / total(seed, kind, 5e-4), 4.0, 0.05);
}

TEST(LinearModels, ACorrectedModelMeetsTheFactorWithItsFormerJacobian) {
  forAllKinds([](GraphScene& scene) {
    scene.move(0.1);
    for (const FactorId f : scene.factors) {
      const auto term = scene.models.term(f);
      const Eigen::MatrixXd before = term.leftCols(term.cols() - 1);
      const auto mismatch = scene.models.mismatch(f);
      scene.models.correctResidual(f, mismatch);
      EXPECT_LT(scene.models.mismatch(f).norm, kResidualRounding);
      EXPECT_EQ(before, scene.models.term(f).leftCols(before.cols()));
    }
  });
}

/// Holds a model at zero; elsewhere it has another one.
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

TEST(LinearModels, AModelThatAFactorHoldsIsNotCopied) {
  FactorGraph graph;
  const VariableId v = graph.addVariable(SmallVector(SmallVector::Zero(3)));
  const FactorId f = *graph.addFactor(std::make_unique<HoldingFactor>(v));
  const auto heldBy = [&](const Value& value) {
    return graph.models().informationFactor(f)->heldModel(std::array{&value});
  };
  const Quadratic& held = *heldBy(SmallVector(SmallVector::Zero(3)));
  const Eigen::VectorXd g_c = held.g_c;
  EXPECT_EQ(graph.models().information(f).H.data, held.lower_H.data());
  EXPECT_EQ(graph.models().information(f).g_c, g_c);
  EXPECT_EQ(graph.states()[v].information[1], 3);
  graph.models().correctResidual(f, {.norm = 0.5, .r = std::array{0.5, 0.0, 0.0}});
  EXPECT_EQ(graph.models().information(f).g_c[0], g_c[0] + 0.5);
  EXPECT_EQ(held.g_c, g_c);

  graph.states()[v].x[0] = 1;
  graph.models().linearize(f);
  EXPECT_NE(graph.models().information(f).H.data, held.lower_H.data());
  EXPECT_EQ(graph.models().information(f).H.column(1)[1], 7);
  EXPECT_EQ(graph.models().information(f).g_c[0], -7);  // in the coordinates
  graph.states()[v].x[0] = 0;
  graph.models().linearize(f);
  EXPECT_EQ(graph.models().information(f).H.data, held.lower_H.data());
  EXPECT_EQ(graph.models().information(f).g_c, g_c);
}

TEST(LinearModels, AMarginalPriorsModelHasTheGradientOfItsCost) {
  // The quadratic of a marginal in steps from where it was made, at estimates that have moved on.
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    GraphScene scene(seed, RandomWorld::kKinds[seed % 4]);
    std::vector<Value> values;
    Eigen::Index n = 0;
    for (const VariableId v : scene.variables) {
      values.push_back(scene.states.estimate(v));
      n += scene.graph.sizeOf(v);
    }
    Eigen::MatrixXd root(n + 2, n + 1);
    for (double& entry : root.reshaped()) entry = scene.world.noise().gaussian();
    const Eigen::MatrixXd information = root.transpose() * root;
    const FactorId f = *scene.graph.addFactor(std::make_unique<MarginalFactor>(scene.variables, values, information));
    EXPECT_LT(scene.models.mismatch(f).norm, kResidualRounding);
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
    scene.models.linearize(f);
    const auto now = scene.estimatesOf(scene.models.factor(f));
    const auto model = scene.models.information(f);
    const Eigen::MatrixXd H = test::unpacked(model.H, model.g_c).topLeftCorner(n, n);
    const Eigen::VectorXd gradient = 2 * (H * scene.coordinatesOf(scene.models.factor(f)) + model.g());
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

TEST(LinearModels, TheTotalCostIsTheSumOfTheSquaredResiduals) {
  forAllKinds([](GraphScene& scene) {
    scene.graph.removeFactor(scene.factors.back());
    scene.factors.pop_back();
    scene.move(0.1);
    double expected = 0;
    for (const FactorId f : scene.factors) {
      scene.models.mismatch(f);
      expected += residualAt(*scene.models.jacobianFactor(f), scene.estimatesOf(scene.models.factor(f))).squaredNorm();
    }
    EXPECT_NEAR(scene.models.totalCost(), expected, kResidualRounding * expected);
  });
}

}  // namespace
}  // namespace motorcade
