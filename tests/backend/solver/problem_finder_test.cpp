#include "backend/solver/problem_finder.hpp"

#include "backend/graph/marginal_factor.hpp"
#include "tests/backend/broken_graphs.hpp"

namespace motorcade {
namespace {

using Kind = SolverProblem::Kind;
using test::Chain;
using test::IsNear;
using test::kindsOf;
using test::kSame;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAreArray;

template <class Space>
using ProblemFinder = test::BrokenGraph<Space>;
TYPED_TEST_SUITE(ProblemFinder, test::Spaces);

TYPED_TEST(ProblemFinder, AMissingPriorIsNamedWithThePartThatIsFree) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    this->restart();
    Chain<TypeParam> chain(this->solver(), seed);
    chain.addMany(8);
    const auto problems = this->problemsFound();
    ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kMissingPrior)) << "seed " << seed;
    const auto& problem = problems[0];
    EXPECT_EQ(problem.freedoms, this->kSize);
    EXPECT_EQ(problem.moving_variables, 8);
    EXPECT_EQ(problem.part_variables, 8);
    EXPECT_THAT(problem.directions, testing::ElementsAreArray(this->allDirections()));
    EXPECT_THAT(problem.factors, UnorderedElementsAreArray(this->solver().graph().factorsOf(problem.variable)));
    EXPECT_THAT(describe(problem, this->solver().graph(), test::nameOf),
                AllOf(HasSubstr("nothing holds the 8 variables connected with " + test::nameOf(problem.variable)),
                      HasSubstr("add a prior on one of them")));

    // The same as with a prior on the one that was named, where it stands.
    std::vector<Value> free;
    for (const VariableId v : chain.ids()) free.push_back(this->solver().estimate(v));
    this->solver().addFactor(TypeParam::prior(problem.variable, this->solver().estimate(problem.variable)));
    EXPECT_THAT(this->problemsFound(), IsEmpty());
    this->expectSolvedAs(free, chain.ids());
  }
}

TYPED_TEST(ProblemFinder, AnUnconstrainedDirectionIsNamedInTheVariablesOwnAxes) {
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
  const auto problems = this->problemsFound();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kUnconstrained));
  EXPECT_EQ(problems[0].variable, loose);
  ASSERT_EQ(problems[0].directions.size(), 1U);
  EXPECT_THAT(problems[0].directions[0], IsNear(d, kSame));
  EXPECT_EQ(problems[0].moving_variables, 1);
  EXPECT_EQ(problems[0].part_variables, 1);
  EXPECT_THAT(problems[0].factors, ElementsAre(factor.value()));
  EXPECT_THAT(describe(problems[0], this->solver().graph(), test::nameOf),
              HasSubstr("v9 is not constrained along (0.60 "));
  this->expectSolvedAs(good, chain.ids());
  EXPECT_THAT(displacement(seen, this->solver().estimate(loose)),
              IsNear(SmallVector(SmallVector::Zero(this->kSize)), kSame));
}

TYPED_TEST(ProblemFinder, AJointThatSlidesFreesWhatHangsOnIt) {
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
  EXPECT_THAT(describe(problems[0], this->solver().graph(), test::nameOf),
              HasSubstr("and 4 others that move with it are not constrained"));
}

TYPED_TEST(ProblemFinder, ADisconnectedPartIsNamedWithItsSize) {
  const auto good = this->goodSolution(8, 5);
  Chain<TypeParam> chain(this->solver(), 5), apart(this->solver(), 6);
  chain.addMany(8);
  chain.hold(0);
  apart.addMany(3);
  const VariableId alone = this->solver().addVariable(TypeParam::origin());
  const auto problems = this->problemsFound();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kDisconnectedPart, Kind::kDisconnectedPart));
  EXPECT_THAT(apart.ids(), testing::Contains(problems[0].variable));
  EXPECT_EQ(problems[0].part_variables, 3);
  EXPECT_EQ(problems[0].moving_variables, 3);
  EXPECT_EQ(problems[0].freedoms, this->kSize);
  EXPECT_EQ(problems[1].variable, alone);
  EXPECT_EQ(problems[1].part_variables, 1);
  EXPECT_THAT(problems[1].factors, IsEmpty());
  EXPECT_THAT(problems[1].directions, testing::ElementsAreArray(this->allDirections()));
  EXPECT_THAT(describe(problems[0], this->solver().graph(), test::nameOf), HasSubstr("the 3 variables connected with"));
  EXPECT_THAT(describe(problems[1], this->solver().graph(), test::nameOf),
              HasSubstr("v11 is disconnected from the rest, no factor touches it"));
  this->expectSolvedAs(good, chain.ids());
}

TYPED_TEST(ProblemFinder, AFactorThatSaysNextToNothingMakesABadCondition) {
  // Below what the elimination takes for singular, and above it.
  for (const double weight : {1e-15, 1e-10}) {
    this->restart();
    Chain<TypeParam> chain(this->solver(), 9);
    chain.addMany(2);
    this->solver().addFactor(TypeParam::prior(chain.ids()[0], chain.truth()[0], weight));
    const auto problems = this->problemsFound();
    ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kBadlyConditioned)) << weight;
    EXPECT_EQ(problems[0].freedoms, this->kSize);
    EXPECT_EQ(problems[0].moving_variables, 2);
    EXPECT_THAT(problems[0].factors, UnorderedElementsAreArray(this->solver().graph().factorsOf(problems[0].variable)));
    EXPECT_THAT(describe(problems[0], this->solver().graph(), test::nameOf),
                HasSubstr("badly conditioned in any direction"));
  }
}

TYPED_TEST(ProblemFinder, NegativeInformationIsNamed) {
  const auto good = this->goodSolution(8, 10);
  Chain<TypeParam> chain(this->solver(), 10);
  chain.addMany(8);
  chain.hold(0);
  const VariableId odd = this->solver().addVariable(TypeParam::origin());
  Eigen::MatrixXd information = Eigen::MatrixXd::Identity(this->kSize + 1, this->kSize + 1);
  information(1, 1) = -4;
  this->solver().addFactor(
      std::make_unique<MarginalFactor>(std::vector{odd}, std::vector{TypeParam::origin()}, information));
  const auto problems = this->problemsFound();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kIndefinite));
  EXPECT_EQ(problems[0].variable, odd);
  EXPECT_THAT(problems[0].directions, ElementsAre(SmallVector(SmallVector::Unit(this->kSize, 1))));
  this->expectSolvedAs(good, chain.ids());
}

TYPED_TEST(ProblemFinder, AFactorWithoutInformationConstrainsNothing) {
  Chain<TypeParam> chain(this->solver(), 11);
  chain.addMany(5);
  chain.hold(0);
  const VariableId loose = this->solver().addVariable(TypeParam::origin());
  const Eigen::MatrixXd nothing = Eigen::MatrixXd::Zero(this->kSize, this->kSize);
  this->solver().addFactor(std::make_unique<test::ProjectedFactor>(
      TypeParam::relative(chain.ids()[2], loose, TypeParam::origin()), nothing));
  const auto problems = this->problemsFound();
  ASSERT_THAT(kindsOf(problems), ElementsAre(Kind::kUnconstrained));
  EXPECT_EQ(problems[0].variable, loose);
  EXPECT_EQ(problems[0].freedoms, this->kSize);
  EXPECT_EQ(problems[0].part_variables, 6);
  EXPECT_THAT(describe(problems[0], this->solver().graph(), test::nameOf),
              HasSubstr("v5 is not constrained in any direction: its 1 factor joins it to v2"));
}

}  // namespace
}  // namespace motorcade
