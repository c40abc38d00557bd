#include "backend/joint/bundle_factor.hpp"

#include <random>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/backend/unpacked.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

/// Costs whose derivatives are exact: no weight follows the residuals.
constexpr LandmarkNoise kQuadratic{.loss = RobustLoss::kNone, .variance_freedom = 0};

/// A body seen in a few frames by a camera that moves, with the values of the factor's variables.
struct BodyInFewFrames {
  static constexpr int kFrames = 4, kLandmarks = 12;
  std::vector<Value> values;
  std::unique_ptr<BundleFactor> factor;
  LandmarkViews landmarks;
  LandmarkNoise noise;
  FramePose pose;

  BodyInFewFrames(bool moving, double noise_px, LandmarkNoise landmark_noise, unsigned seed)
      : pose(moving ? FramePose::kCamBody : FramePose::kWorldCam) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<SE3> x, T;
    for (int k = 0; k < kFrames; ++k) {
      Vector6d camera, body;
      camera << 0.1 * k, 0.02 * k, 1.1 * k, 0.01 * k, 0.02 * k, 0.005 * k;
      body << 0.8 * k, 0.1 * k, 0, 0.01 * k, 0, 0.05 * k;
      x.push_back(SE3(expSO3({0.1, 0.2, 0.3}), {5, 1, 2}) * SE3::exp(camera));
      T.push_back(moving ? x[0] * SE3(expSO3({1.2, -1.0, 1.1}), {2, 1, 16}) * SE3::exp(body) : SE3{});
    }
    const double offset_px = 0.3;
    for (int j = 0; j < kLandmarks; ++j) {
      const Eigen::Vector3d p_cam(4 * uniform(random), uniform(random), 16 + 5 * uniform(random));
      const Eigen::Vector3d p_body = T[0].inverse() * (x[0] * p_cam);
      for (int k = 0; k < kFrames; ++k) {
        if (j % 4 == k) continue;
        Eigen::Vector3d uvd_px = *kRig.project(x[k].inverse() * (T[k] * p_body));
        uvd_px.z() -= offset_px;
        for (double& value : uvd_px) value += noise_px * normal(random);
        landmarks.views.push_back({k, uvd_px, {4, 4, 3}});
      }
      landmarks.first_view.push_back(static_cast<int>(landmarks.views.size()));
    }
    std::vector<VariableId> variables;
    std::vector<SE3> T_cam_body;
    for (int k = 0; k < kFrames; ++k) {
      T_cam_body.push_back(x[k].inverse() * T[k]);
      variables.push_back({k});
      values.emplace_back(moving ? T_cam_body.back() : x[k]);
    }
    values.emplace_back(SmallVector(SmallVector::Constant(1, offset_px)));
    factor = std::make_unique<BundleFactor>(
        variables, VariableId{kFrames},
        eliminateLandmarks(kRig, landmark_noise, landmarks, pose, T_cam_body, offset_px));
    noise = landmark_noise;
  }
  /// Cost of the landmarks fitted anew at the present values.
  double freshCost() const {
    const auto fresh = eliminateLandmarks(kRig, noise, landmarks, pose, factor->posesFromCamera(pointers()),
                                          std::get<SmallVector>(values.back())[0]);
    return fresh.system.g_c[fresh.system.g_c.size() - 1];
  }
  std::vector<const Value*> pointers() const {
    std::vector<const Value*> pointers;
    for (const Value& value : values) pointers.push_back(&value);
    return pointers;
  }
  int dimension() const { return factor->rows() - 1; }
  Eigen::MatrixXd linearize() const {
    Eigen::MatrixXd term(factor->rows(), factor->rows());
    factor->linearize(pointers(), term);
    return term;
  }
  double cost() const { return linearize()(dimension(), dimension()); }
  void move(int coordinate, double step) {
    for (Value& value : values) {
      if (coordinate < motorcade::dimension(value)) {
        SmallVector delta = SmallVector::Zero(motorcade::dimension(value));
        delta[coordinate] = step;
        value = displaced(value, delta);
        return;
      }
      coordinate -= motorcade::dimension(value);
    }
  }
};

class BundleFactorOf : public testing::TestWithParam<bool> {};

TEST_P(BundleFactorOf, NoResidualsAtTheTruth) {
  const BodyInFewFrames scene(GetParam(), 0, {}, 1);
  const Eigen::MatrixXd term = scene.linearize();
  EXPECT_LT(scene.cost(), 1e-12);
  EXPECT_LT(term.row(scene.dimension()).norm(), 1e-6);
}

TEST_P(BundleFactorOf, GradientMatchesFiniteDifferencesOfTheCost) {
  BodyInFewFrames scene(GetParam(), 0.2, kQuadratic, 2);
  const Eigen::MatrixXd term = scene.linearize();
  for (int i = 0; i < scene.dimension(); ++i) {
    constexpr double kStep = 1e-4;
    BodyInFewFrames plus = BodyInFewFrames(GetParam(), 0.2, kQuadratic, 2),
                    minus = BodyInFewFrames(GetParam(), 0.2, kQuadratic, 2);
    plus.move(i, kStep), minus.move(i, -kStep);
    const double numeric = (plus.freshCost() - minus.freshCost()) / (4 * kStep);
    EXPECT_NEAR(term(scene.dimension(), i), numeric, 1e-3 * (1 + std::abs(numeric))) << i;
    const double curvature = (plus.freshCost() + minus.freshCost() - 2 * scene.freshCost()) / (2 * kStep * kStep);
    EXPECT_NEAR(term(i, i), curvature, 0.03 * term(i, i) + 1) << i;
  }
}

TEST_P(BundleFactorOf, TheQuadraticHoldsAwayFromItsLinearization) {
  BodyInFewFrames scene(GetParam(), 0.2, kQuadratic, 3);
  const double before = scene.cost();
  for (int i = 0; i < scene.dimension(); ++i) scene.move(i, i % 2 == 0 ? 2e-3 : -1e-3);
  EXPECT_NEAR(scene.cost(), scene.freshCost(), 0.02 * std::abs(scene.freshCost() - before));
}

TEST_P(BundleFactorOf, HoldsTheSystemWhereItWasLinearized) {
  BodyInFewFrames scene(GetParam(), 0.2, {}, 8);
  const Quadratic* const held = scene.factor->heldModel(scene.pointers());
  ASSERT_TRUE(held);
  const Eigen::MatrixXd at = test::unpacked(*held);
  for (int i = 0; i < scene.dimension(); ++i) scene.move(i, i % 2 == 0 ? 2e-8 : -1e-8);
  EXPECT_FALSE(scene.factor->heldModel(scene.pointers()));
  const Eigen::MatrixXd beside = scene.linearize();
  for (int j = 0; j < at.cols(); ++j)
    for (int i = j; i < at.rows(); ++i)
      EXPECT_NEAR(at(i, j), beside(i, j), 1e-5 * (1 + std::sqrt(at(i, i) * at(j, j)))) << i << " " << j;
}

TEST_P(BundleFactorOf, TheGradientAloneIsThatOfTheSystem) {
  BodyInFewFrames scene(GetParam(), 0.2, {}, 5);
  for (int i = 0; i < scene.dimension(); ++i) scene.move(i, 1e-2);
  Eigen::VectorXd gradient(scene.factor->rows());
  scene.factor->gradient(scene.pointers(), gradient);
  const Eigen::MatrixXd term = scene.linearize();
  EXPECT_LT((gradient.transpose() - term.row(scene.dimension())).norm(), 1e-9 * gradient.norm());
}

TEST_P(BundleFactorOf, KnowsNothingOfWhereTheWholeIs) {
  BodyInFewFrames scene(GetParam(), 0.2, {}, 4);
  const double before = scene.cost();
  const SE3 elsewhere(expSO3({0.4, -1, 2}), {100, -30, 7});
  for (Value& value : scene.values)
    if (auto* pose = std::get_if<SE3>(&value)) *pose = GetParam() ? *pose * elsewhere : elsewhere * *pose;
  EXPECT_NEAR(scene.cost(), before, 1e-6 * before);
}

/// Robust weights follow slowly: fits from the estimate before come nearer.
TEST_P(BundleFactorOf, LandmarksThatWereFoundBeforeAreFoundBetter) {
  const BodyInFewFrames scene(GetParam(), 0.3, {}, 7);
  LandmarkViews landmarks = scene.landmarks;
  const EliminatedLandmarks& at = scene.factor->landmarks();
  std::vector<Eigen::MatrixXd> systems;
  for (int time = 0; time < 40; ++time) {
    auto eliminated = eliminateLandmarks(kRig, {}, landmarks, at.pose, at.T_cam_body, at.offset_px);
    systems.push_back(test::unpacked(eliminated.system));
    landmarks.before = std::move(eliminated.estimates);
  }
  const auto error = [&](int time) { return (systems[time] - systems.back()).norm(); };
  EXPECT_GT(error(0), 0.05 * systems.back().norm());
  EXPECT_LT(error(1), 0.7 * error(0));
  EXPECT_LT(error(8), 0.3 * error(0));
}

INSTANTIATE_TEST_SUITE_P(Bodies, BundleFactorOf, testing::Bool());

}  // namespace
}  // namespace motorcade
