/// The part of FactorGraph that makes and corrects the factors' linear models.

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "backend/graph/factor_graph.hpp"
#include "backend/graph/symmetric_product.hpp"

namespace motorcade {
namespace {

/// Columns M <- M R^T.
template <int N>
void turnColumns(FactorGraph::Term& term, Eigen::Index column, const Eigen::Matrix<double, N, N>& R) {
  for (Eigen::Index i = 0; i < term.rows(); ++i)
    term.row(i).segment<N>(column) = (term.row(i).segment<N>(column) * R.transpose()).eval();
}

using Column = Eigen::Map<Eigen::VectorXd>;

/// No entry is infinite or undefined, nor too large to square, as the elimination does.
bool canBeSquared(std::span<const double> numbers) {
  double sum = 0;
  for (const double number : numbers) sum += number * number;
  return std::isfinite(sum);
}

}  // namespace

/// The stacked coordinates of the factor's variables where the estimates stand, in `coordinates_`.
Column FactorGraph::appliedCoordinates(const Factor& factor) {
  coordinates_.clear();
  for (const VariableId v : factor.variables()) {
    const Variable& variable = (*this)[v];
    coordinates_.insert(coordinates_.end(), variable.x_applied.begin(), variable.x_applied.begin() + variable.size);
  }
  return {coordinates_.data(), static_cast<Eigen::Index>(coordinates_.size())};
}

/// From right perturbations to steps in the world's axes: to first order rho = R^T dp, phi = R^T dphi.
void FactorGraph::turnToWorldAxes(const Factor& factor, Term& term) const {
  Eigen::Index at = 0;
  for (const VariableId v : factor.variables()) {
    const Value& value = (*this)[v].linearization_point;
    if (const auto* pose = std::get_if<SE3>(&value))
      for (const Eigen::Index k : {at, at + 3}) turnColumns<3>(term, k, pose->rotation());
    if (const auto* planar = std::get_if<SE2>(&value)) turnColumns<2>(term, at, planar->rotation());
    at += sizeOf(v);
  }
}

FactorGraph::Term FactorGraph::term(FactorId id) const {
  assert(isJacobian(id));
  return {slot(id).term, slot(id).factor().rows(), slot(id).columns};
}

FactorGraph::Information FactorGraph::information(FactorId id) const { return informationOf(slot(id)); }

FactorGraph::Information FactorGraph::informationOf(const LinearizedFactor& slot) {
  assert(slot.quadratic);
  return {.H = {slot.lower_H, slot.columns - 1}, .g_c = {slot.g_c, slot.columns}};
}

/// The model and the cost at the applied estimates. False, and nothing changes, when they are not finite.
bool FactorGraph::linearize(LinearizedFactor& slot) {
  apply(slot.factor());
  if (!(slot.jacobian ? linearizeResidual(slot) : linearizeInformation(slot))) return false;
  slot.drift = 0;
  return true;
}

bool FactorGraph::linearizeResidual(LinearizedFactor& slot) {
  const JacobianFactor& factor = *slot.jacobian;
  matrix_.resize(std::size_t(factor.rows()) * slot.columns);
  Term fresh(matrix_.data(), factor.rows(), slot.columns);
  factor.linearize(valuesOf(factor, &Variable::linearization_point), fresh);
  factor.residual(valuesOf(factor, &Variable::applied_estimate), fresh.rightCols<1>().col(0));
  turnToWorldAxes(factor, fresh);
  if (!canBeSquared(matrix_)) return false;
  setCost(slot, fresh.rightCols<1>().squaredNorm());
  const Column x = appliedCoordinates(factor);
  fresh.rightCols<1>().noalias() -= fresh.leftCols(x.size()) * x;
  if (!slot.term) slot.term = terms_.take(matrix_.size());
  std::ranges::copy(matrix_, slot.term);
  return true;
}

/// Where a factor still says what it was made of, its H serves as it is, whatever became of g and c.
bool FactorGraph::linearizeInformation(LinearizedFactor& slot) {
  const InformationFactor& factor = *slot.quadratic;
  const auto values = valuesOf(factor, &Variable::applied_estimate);
  const Quadratic* held = factor.heldModel(values);
  if (!held) {
    matrix_.resize(std::size_t(factor.rows()) * factor.rows());
    Term whole(matrix_.data(), factor.rows(), factor.rows());
    factor.linearize(values, whole);
    pack(whole, quadratic_);
  }
  const Quadratic& model = held ? *held : quadratic_;
  if (!canBeSquared(model.lower_H) || !canBeSquared({model.g_c.data(), std::size_t(model.g_c.size())})) return false;
  if (held) {
    terms_.give(std::exchange(slot.term, nullptr));
    slot.lower_H = held->lower_H.data();
  } else {
    if (!slot.term) slot.term = terms_.take(model.lower_H.size());
    std::ranges::copy(model.lower_H, slot.term);
    slot.lower_H = slot.term;
  }
  if (!slot.g_c) slot.g_c = terms_.take(slot.columns);
  const Information information = informationOf(slot);
  Eigen::Map<Eigen::VectorXd> g_c = information.g_c;
  g_c = model.g_c;
  setCost(slot, information.c());
  // From steps to coordinates: the model at x = 0.
  const Column x = appliedCoordinates(factor);
  product_.assign(x.size(), 0.0);
  addSymmetricProduct(information.H, x.data(), product_.data());
  const Column Hx(product_.data(), x.size());
  g_c[x.size()] += x.dot(Hx) - 2 * x.dot(g_c.head(x.size()));
  g_c.head(x.size()) -= Hx;
  return true;
}

void FactorGraph::linearize(FactorId id) { linearize(factors_[id.value]); }

FactorGraph::Mismatch FactorGraph::mismatch(FactorId id) {
  if (!isJacobian(id)) return informationMismatch(id);
  const JacobianFactor& factor = *slot(id).jacobian;
  const Term model = term(id);
  apply(factor);
  residual_.resize(factor.rows());
  Column r(residual_.data(), factor.rows());
  factor.residual(valuesOf(factor, &Variable::applied_estimate), r);
  setCost(factors_[id.value], r.squaredNorm());
  const Column x = appliedCoordinates(factor);
  r -= model.col(x.size());
  r.noalias() -= model.leftCols(x.size()) * x;
  return {.norm = r.norm(), .r = residual_};
}

/// Of the gradient, and by its entries over the square root of their information.
FactorGraph::Mismatch FactorGraph::informationMismatch(FactorId id) {
  const InformationFactor& factor = *slot(id).quadratic;
  const Information model = information(id);
  const Eigen::Index n = model.H.size;
  apply(factor);
  residual_.assign(n + 1, 0.0);
  Column difference(residual_.data(), n + 1);
  factor.gradient(valuesOf(factor, &Variable::applied_estimate), difference);
  if (!std::isfinite(difference.squaredNorm())) {
    residual_.assign(n, 0.0);
    return {.norm = 0, .r = residual_};
  }
  setCost(factors_[id.value], difference[n]);
  residual_.resize(n);
  Column change(residual_.data(), n);
  change -= model.g();
  product_.assign(n, 0.0);
  addSymmetricProduct(model.H, appliedCoordinates(factor).data(), product_.data());
  change -= Column(product_.data(), n);
  double squared = 0;
  for (int i = 0; i < model.H.size; ++i)
    if (const double own = model.H.column(i)[i]; own > 0) squared += change[i] * change[i] / own;
  return {.norm = std::sqrt(squared), .r = residual_};
}

void FactorGraph::correctResidual(FactorId id, std::span<const double> r) {
  const Eigen::Map<const Eigen::VectorXd> shift(r.data(), static_cast<Eigen::Index>(r.size()));
  if (!isJacobian(id))
    information(id).g_c.head(shift.size()) += shift;
  else
    term(id).rightCols<1>() += shift;
}

}  // namespace motorcade
