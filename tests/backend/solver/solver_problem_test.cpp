#include "backend/solver/solver_problem.hpp"

#include <cmath>
#include <limits>

#include "tests/backend/broken_graphs.hpp"

namespace motorcade {
namespace {

using Kind = SolverProblem::Kind;
using test::Chain;
using test::kindsOf;
using testing::ElementsAre;
using testing::HasSubstr;

template <class Space>
using FactorLeftOut = test::BrokenGraph<Space>;
TYPED_TEST_SUITE(FactorLeftOut, test::Spaces);

TYPED_TEST(FactorLeftOut, AMeasurementThatIsNoNumberIsNamedByItsVariables) {
  const auto good = this->goodSolution(8, 3);
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinity, 1e200}) {
    this->restart();
    Chain<TypeParam> chain(this->solver(), 3);
    chain.addMany(8);
    chain.hold(0);
    const Eigen::MatrixXd A = bad * Eigen::MatrixXd::Identity(this->kSize, this->kSize);
    EXPECT_FALSE(this->solver().addFactor(std::make_unique<test::ProjectedFactor>(
        TypeParam::relative(chain.ids()[2], chain.ids()[6], TypeParam::origin()), A)));
    const auto problems = this->problemsFound();
    ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kNotFinite)) << bad;
    EXPECT_EQ(problems[0].variable, chain.ids()[2]);
    EXPECT_THAT(problems[0].others, ElementsAre(chain.ids()[6]));
    EXPECT_THAT(describe(problems[0], this->solver().graph(), test::nameOf),
                HasSubstr("a factor on v2 and v6 is not finite"));
    this->expectSolvedAs(good, chain.ids());
  }
}

TYPED_TEST(FactorLeftOut, AVariableTwiceInAFactorAndOneThatIsNotThereAreNamed) {
  const auto good = this->goodSolution(8, 4);
  Chain<TypeParam> chain(this->solver(), 4);
  chain.addMany(8);
  chain.hold(0);
  EXPECT_FALSE(this->solver().addFactor(TypeParam::relative(chain.ids()[5], chain.ids()[5], TypeParam::origin())));
  EXPECT_FALSE(this->solver().addFactor(TypeParam::relative(chain.ids()[1], VariableId{77}, TypeParam::origin())));
  const auto problems = this->problemsFound();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kRepeatedVariable, Kind::kUnknownVariable));
  EXPECT_EQ(problems[0].variable, chain.ids()[5]);
  EXPECT_EQ(problems[1].variable, VariableId{77});
  EXPECT_THAT(problems[1].others, ElementsAre(chain.ids()[1]));
  EXPECT_THAT(describe(problems[0], this->solver().graph(), test::nameOf),
              HasSubstr("a factor on v5 names a variable twice"));
  EXPECT_THAT(describe(problems[1], this->solver().graph(), test::nameOf), HasSubstr("not in the graph"));
  this->expectSolvedAs(good, chain.ids());
}

/// Not a number beyond 5.
class RootFactor final : public JacobianFactor {
 public:
  explicit RootFactor(VariableId v) : JacobianFactor({v}, 1) {}
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    residual(values, term.col(3));
    term.row(0).head(3) << -0.5 / term(0, 3), 0, 0;
  }
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    r[0] = std::sqrt(5 - std::get<SmallVector>(*values[0])[0]);
  }
};

TEST(SolverProblem, AFactorThatIsNoNumberWhereItsVariableGoesSpoilsNeitherEstimateNorCost) {
  IncrementalSolver solver({});
  const VariableId v = solver.addVariable(test::Vectors::origin());
  ASSERT_TRUE(solver.addFactor(std::make_unique<RootFactor>(v)));
  solver.addFactor(
      test::Vectors::prior(v, test::Vectors::moved(test::Vectors::origin(), Eigen::Vector3d(10, 0, 0)), 1e6));
  for (int i = 0; i < 5; ++i) solver.update();
  solver.converge(5, 1e-9);
  EXPECT_NEAR(std::get<SmallVector>(solver.estimate(v))[0], 10, 1e-3);  // the prior is a million times as sure
  EXPECT_TRUE(std::isfinite(solver.counters().chi2));
}

}  // namespace
}  // namespace motorcade
