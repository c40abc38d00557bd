#include "backend/solver/solver_problem.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/graph/marginal_factor.hpp"
#include "tests/backend/space_fixtures.hpp"
#include "tests/support/matchers.hpp"

/// Broken graphs over each kind of variable: what the solver says of them, and that their good rest is solved as if the
/// broken part were not there.
namespace motorcade {
namespace {

using Kind = SolverProblem::Kind;
using test::IsNear;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAreArray;

constexpr IncrementalSolver::Params kExact{
    .mismatch_tolerance = 0, .jacobian_drift_sigmas = 0, .relinearize_rad = 0, .substitution_tolerance = 0};
constexpr double kSame = 1e-8;  // of two solvers that both have converged

std::string nameOf(VariableId v) { return std::string("v").append(std::to_string(v.value)); }

std::vector<Kind> kindsOf(const std::vector<SolverProblem>& problems) {
  std::vector<Kind> kinds;
  for (const auto& problem : problems) kinds.push_back(problem.kind);
  return kinds;
}

/// A graph of noisy relative measurements: each variable to the one before, and some to others.
template <class Space>
class Chain {
 public:
  Chain(IncrementalSolver& solver, std::uint64_t seed) : solver_(solver), random_(seed) {}

  VariableId add(bool joined = true) {
    const SmallVector step = random_.noise(1.0, 0.5).template head<Space::kSize>();
    truth_.push_back(truth_.empty() ? Space::origin() : Space::moved(truth_.back(), step));
    ids_.push_back(solver_.addVariable(Space::moved(truth_.back(), noise(0.05))));
    const std::size_t n = ids_.size();
    if (joined && n > 1) join(n - 2, n - 1);
    if (joined && n > 3 && n % 2 == 0) join(n - 4, n - 1);
    return ids_.back();
  }
  void addMany(int count) {
    for (int i = 0; i < count; ++i) add();
  }
  void join(std::size_t i, std::size_t j) {
    const Value Z = Space::moved(Space::between(truth_[i], truth_[j]), noise(0.02));
    solver_.addFactor(Space::relative(ids_[i], ids_[j], Z, 100));
  }
  std::optional<FactorId> hold(std::size_t i) { return solver_.addFactor(Space::prior(ids_[i], truth_[i], 1e4)); }
  SmallVector noise(double sigma) { return random_.noise(sigma, sigma).template head<Space::kSize>(); }

  const std::vector<VariableId>& ids() const { return ids_; }
  const std::vector<Value>& truth() const { return truth_; }

 private:
  IncrementalSolver& solver_;
  test::RandomPoses random_;
  std::vector<VariableId> ids_;
  std::vector<Value> truth_;
};

template <class Space>
class BrokenGraph : public testing::Test {
 protected:
  static constexpr int kSize = Space::kSize;
  /// Solves, and gives what was found.
  std::vector<SolverProblem> settle() {
    auto problems = solver().update().problems;
    for (int i = 0; i < 10; ++i) {
      const auto& later = solver().update().problems;
      EXPECT_THAT(later, IsEmpty()) << "told again without a change: "
                                    << (later.empty() ? "" : describe(later[0], solver().graph(), nameOf));
    }
    return problems;
  }
  /// Of the good graph alone.
  std::vector<Value> goodSolution(int count, std::uint64_t seed) {
    IncrementalSolver solver(kExact);
    Chain<Space> chain(solver, seed);
    chain.addMany(count);
    chain.hold(0);
    for (int i = 0; i < 10; ++i) EXPECT_THAT(solver.update().problems, IsEmpty());
    std::vector<Value> values;
    for (const VariableId v : chain.ids()) values.push_back(solver.estimate(v));
    return values;
  }
  void expectSolvedAs(const std::vector<Value>& expected, const std::vector<VariableId>& ids) {
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_THAT(displacement(expected[i], solver().estimate(ids[i])),
                  IsNear(SmallVector(SmallVector::Zero(kSize)), kSame))
          << "variable " << i;
  }
  static std::vector<SmallVector> allDirections() {
    std::vector<SmallVector> directions;
    for (int i = 0; i < kSize; ++i) directions.push_back(SmallVector::Unit(kSize, i));
    return directions;
  }
  static SmallVector slanted() {
    SmallVector direction = SmallVector::Zero(kSize);
    direction[0] = 0.6, direction[1] = 0.8;
    return direction;
  }

  IncrementalSolver& solver() { return *solver_; }
  void restart() { solver_ = std::make_unique<IncrementalSolver>(kExact); }

 private:
  std::unique_ptr<IncrementalSolver> solver_ = std::make_unique<IncrementalSolver>(kExact);
};

using Spaces = testing::Types<test::Space3, test::Space2, test::Vectors>;
TYPED_TEST_SUITE(BrokenGraph, Spaces);

TYPED_TEST(BrokenGraph, AMissingPriorIsNamedWithThePartThatIsFree) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    this->restart();
    Chain<TypeParam> chain(this->solver(), seed);
    chain.addMany(8);
    const auto problems = this->settle();
    ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kMissingPrior)) << "seed " << seed;
    const auto& problem = problems[0];
    EXPECT_EQ(problem.freedoms, this->kSize);
    EXPECT_EQ(problem.moving_variables, 8);
    EXPECT_EQ(problem.part_variables, 8);
    EXPECT_THAT(problem.directions, testing::ElementsAreArray(this->allDirections()));
    EXPECT_THAT(problem.factors, UnorderedElementsAreArray(this->solver().graph()[problem.variable].factors));
    EXPECT_THAT(describe(problem, this->solver().graph(), nameOf),
                AllOf(HasSubstr("nothing holds the 8 variables connected with " + nameOf(problem.variable)),
                      HasSubstr("add a prior on one of them")));

    // The same as with a prior on the one that was named, where it stands.
    std::vector<Value> free;
    for (const VariableId v : chain.ids()) free.push_back(this->solver().estimate(v));
    this->solver().addFactor(TypeParam::prior(problem.variable, this->solver().estimate(problem.variable)));
    EXPECT_THAT(this->settle(), IsEmpty());
    this->expectSolvedAs(free, chain.ids());
  }
}

TYPED_TEST(BrokenGraph, AnUnconstrainedDirectionIsNamedInTheVariablesOwnAxes) {
  const auto good = this->goodSolution(9, 1);
  Chain<TypeParam> chain(this->solver(), 1);
  chain.addMany(9);
  chain.hold(0);
  // Apart from the others, one of which a factor that sees all but one direction is all that is known.
  const Value seen = TypeParam::moved(chain.truth()[4], chain.noise(1.0));
  const VariableId loose = this->solver().addVariable(seen);
  const SmallVector d = this->slanted();
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(this->kSize, this->kSize) - d * d.transpose();
  const auto factor =
      this->solver().addFactor(std::make_unique<test::ProjectedFactor>(TypeParam::prior(loose, seen, 25), A));
  const auto problems = this->settle();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kUnconstrained));
  EXPECT_EQ(problems[0].variable, loose);
  ASSERT_EQ(problems[0].directions.size(), 1U);
  EXPECT_THAT(problems[0].directions[0], IsNear(d, kSame));
  EXPECT_EQ(problems[0].moving_variables, 1);
  EXPECT_EQ(problems[0].part_variables, 1);
  EXPECT_THAT(problems[0].factors, ElementsAre(factor.value()));
  EXPECT_THAT(describe(problems[0], this->solver().graph(), nameOf), HasSubstr("v9 is not constrained along (0.60 "));
  this->expectSolvedAs(good, chain.ids());
  EXPECT_THAT(displacement(seen, this->solver().estimate(loose)),
              IsNear(SmallVector(SmallVector::Zero(this->kSize)), kSame));
}

TYPED_TEST(BrokenGraph, AJointThatSlidesFreesWhatHangsOnIt) {
  Chain<TypeParam> chain(this->solver(), 2);
  chain.addMany(4);
  chain.hold(0);
  const std::size_t joint = 4;
  for (int i = 0; i < 5; ++i) chain.add(false);
  const SmallVector d = this->slanted();
  const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(this->kSize, this->kSize) - d * d.transpose();
  const Value Z =
      TypeParam::between(this->solver().estimate(chain.ids()[joint - 1]), this->solver().estimate(chain.ids()[joint]));
  auto whole = TypeParam::relative(chain.ids()[joint - 1], chain.ids()[joint], Z, 25);
  this->solver().addFactor(std::make_unique<test::ProjectedFactor>(std::move(whole), A));
  for (std::size_t i = joint; i + 1 < chain.ids().size(); ++i) chain.join(i, i + 1);
  const auto problems = this->solver().update().problems;
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kUnconstrained));
  EXPECT_EQ(problems[0].freedoms, 1);
  EXPECT_EQ(problems[0].moving_variables, 5);
  EXPECT_EQ(problems[0].part_variables, 9);
  EXPECT_GE(problems[0].variable, chain.ids()[joint]);
  EXPECT_THAT(describe(problems[0], this->solver().graph(), nameOf),
              HasSubstr("and 4 others that move with it are not constrained"));
}

TYPED_TEST(BrokenGraph, AMeasurementThatIsNoNumberIsNamedByItsVariables) {
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
    const auto problems = this->settle();
    ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kNotFinite)) << bad;
    EXPECT_EQ(problems[0].variable, chain.ids()[2]);
    EXPECT_THAT(problems[0].others, ElementsAre(chain.ids()[6]));
    EXPECT_THAT(describe(problems[0], this->solver().graph(), nameOf),
                HasSubstr("a factor on v2 and v6 is not finite"));
    this->expectSolvedAs(good, chain.ids());
  }
}

TYPED_TEST(BrokenGraph, AVariableTwiceInAFactorAndOneThatIsNotThereAreNamed) {
  const auto good = this->goodSolution(8, 4);
  Chain<TypeParam> chain(this->solver(), 4);
  chain.addMany(8);
  chain.hold(0);
  EXPECT_FALSE(this->solver().addFactor(TypeParam::relative(chain.ids()[5], chain.ids()[5], TypeParam::origin())));
  EXPECT_FALSE(this->solver().addFactor(TypeParam::relative(chain.ids()[1], VariableId{77}, TypeParam::origin())));
  const auto problems = this->settle();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kRepeatedVariable, Kind::kUnknownVariable));
  EXPECT_EQ(problems[0].variable, chain.ids()[5]);
  EXPECT_EQ(problems[1].variable, VariableId{77});
  EXPECT_THAT(problems[1].others, ElementsAre(chain.ids()[1]));
  EXPECT_THAT(describe(problems[0], this->solver().graph(), nameOf),
              HasSubstr("a factor on v5 names a variable twice"));
  EXPECT_THAT(describe(problems[1], this->solver().graph(), nameOf), HasSubstr("not in the graph"));
  this->expectSolvedAs(good, chain.ids());
}

TYPED_TEST(BrokenGraph, ADisconnectedPartIsNamedWithItsSize) {
  const auto good = this->goodSolution(8, 5);
  Chain<TypeParam> chain(this->solver(), 5), apart(this->solver(), 6);
  chain.addMany(8);
  chain.hold(0);
  apart.addMany(3);
  const VariableId alone = this->solver().addVariable(TypeParam::origin());
  const auto problems = this->settle();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kDisconnectedPart, Kind::kDisconnectedPart));
  EXPECT_THAT(apart.ids(), testing::Contains(problems[0].variable));
  EXPECT_EQ(problems[0].part_variables, 3);
  EXPECT_EQ(problems[0].moving_variables, 3);
  EXPECT_EQ(problems[0].freedoms, this->kSize);
  EXPECT_EQ(problems[1].variable, alone);
  EXPECT_EQ(problems[1].part_variables, 1);
  EXPECT_THAT(problems[1].factors, IsEmpty());
  EXPECT_THAT(problems[1].directions, testing::ElementsAreArray(this->allDirections()));
  EXPECT_THAT(describe(problems[0], this->solver().graph(), nameOf), HasSubstr("the 3 variables connected with"));
  EXPECT_THAT(describe(problems[1], this->solver().graph(), nameOf),
              HasSubstr("v11 is disconnected from the rest, no factor touches it"));
  this->expectSolvedAs(good, chain.ids());
}

TYPED_TEST(BrokenGraph, AProblemIsToldOnceUntilItComesBack) {
  Chain<TypeParam> chain(this->solver(), 7);
  chain.add();
  ASSERT_THAT(kindsOf(this->solver().update().problems), ElementsAre(Kind::kMissingPrior));
  for (int i = 0; i < 20; ++i) {
    chain.add();
    EXPECT_THAT(this->solver().update().problems, IsEmpty())
        << "another variable of the part is held now, but the part was named";
  }
  const FactorId prior = chain.hold(4).value();
  EXPECT_THAT(this->solver().update().problems, IsEmpty());
  this->solver().removeFactor(prior);
  const auto problems = this->solver().update().problems;
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kMissingPrior));
  EXPECT_EQ(problems[0].part_variables, 21);
}

TYPED_TEST(BrokenGraph, AnIdThatIsUsedAgainIsNamedAgain) {
  Chain<TypeParam> chain(this->solver(), 8);
  chain.addMany(4);
  chain.hold(0);
  const VariableId first = this->solver().addVariable(TypeParam::origin());
  ASSERT_THAT(kindsOf(this->solver().update().problems), ElementsAre(Kind::kDisconnectedPart));
  this->solver().retire(std::vector{first});
  const VariableId second = this->solver().addVariable(TypeParam::origin());
  ASSERT_EQ(first, second);
  EXPECT_THAT(kindsOf(this->solver().update().problems), ElementsAre(Kind::kDisconnectedPart));
  EXPECT_THAT(this->solver().drop(std::vector{second}).problems, IsEmpty());
}

TYPED_TEST(BrokenGraph, AFactorThatSaysNextToNothingMakesABadCondition) {
  // Below what the elimination takes for singular, and above it.
  for (const double weight : {1e-15, 1e-10}) {
    this->restart();
    Chain<TypeParam> chain(this->solver(), 9);
    chain.addMany(2);
    this->solver().addFactor(TypeParam::prior(chain.ids()[0], chain.truth()[0], weight));
    const auto problems = this->settle();
    ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kBadlyConditioned)) << weight;
    EXPECT_EQ(problems[0].freedoms, this->kSize);
    EXPECT_EQ(problems[0].moving_variables, 2);
    EXPECT_THAT(problems[0].factors, UnorderedElementsAreArray(this->solver().graph()[problems[0].variable].factors));
    EXPECT_THAT(describe(problems[0], this->solver().graph(), nameOf), HasSubstr("badly conditioned in any direction"));
  }
}

TYPED_TEST(BrokenGraph, NegativeInformationIsNamed) {
  const auto good = this->goodSolution(8, 10);
  Chain<TypeParam> chain(this->solver(), 10);
  chain.addMany(8);
  chain.hold(0);
  const VariableId odd = this->solver().addVariable(TypeParam::origin());
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(this->kSize + 1, this->kSize + 1);
  information(1, 1) = -4;
  this->solver().addFactor(
      std::make_unique<MarginalFactor>(std::vector{odd}, std::vector{TypeParam::origin()}, information));
  const auto problems = this->settle();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kIndefinite));
  EXPECT_EQ(problems[0].variable, odd);
  EXPECT_THAT(problems[0].directions, ElementsAre(SmallVector(SmallVector::Unit(this->kSize, 1))));
  this->expectSolvedAs(good, chain.ids());
}

TYPED_TEST(BrokenGraph, AFactorWithoutInformationConstrainsNothing) {
  Chain<TypeParam> chain(this->solver(), 11);
  chain.addMany(5);
  chain.hold(0);
  const VariableId loose = this->solver().addVariable(TypeParam::origin());
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(this->kSize, this->kSize);
  this->solver().addFactor(std::make_unique<test::ProjectedFactor>(
      TypeParam::relative(chain.ids()[2], loose, TypeParam::origin()), nothing));
  const auto problems = this->settle();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kUnconstrained));
  EXPECT_EQ(problems[0].variable, loose);
  EXPECT_EQ(problems[0].freedoms, this->kSize);
  EXPECT_EQ(problems[0].part_variables, 6);
  EXPECT_THAT(describe(problems[0], this->solver().graph(), nameOf),
              HasSubstr("v5 is not constrained in any direction: its 1 factor joins it to v2"));
}

/// Not a number beyond 5.
class RootFactor final : public Factor {
 public:
  explicit RootFactor(VariableId v) : Factor({v}, Form::kJacobian, 1) {}
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
