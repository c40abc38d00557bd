#include "backend/solver/problem_reporter.hpp"

#include "tests/backend/broken_graphs.hpp"

namespace motorcade {
namespace {

using Kind = SolverProblem::Kind;
using test::Chain;
using test::kindsOf;
using testing::ElementsAre;
using testing::IsEmpty;

template <class Space>
using ReportedProblem = test::BrokenGraph<Space>;
TYPED_TEST_SUITE(ReportedProblem, test::Spaces);

TYPED_TEST(ReportedProblem, AProblemIsReportedOnceUntilItComesBack) {
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

TYPED_TEST(ReportedProblem, AnIdThatIsUsedAgainIsNamedAgain) {
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

}  // namespace
}  // namespace motorcade
