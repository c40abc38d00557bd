#include "backend/graph/factor_graph.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "backend/graph/symmetric_product.hpp"

namespace motorcade {
namespace {

/// Of the residuals: without noise the tolerances that are relative to it do not vanish.
constexpr double kLeastMeanSquare = 1e-8;

/// A slot of `slots` that is free, or a new one at the end.
template <class IdType, class Slot>
IdType takeSlot(std::vector<IdType>& free, std::vector<Slot>& slots) {
  if (free.empty()) {
    slots.emplace_back();
    return IdType{static_cast<std::int64_t>(slots.size()) - 1};
  }
  const IdType id = free.back();
  free.pop_back();
  return id;
}

/// Columns M <- M R^T.
template <int N>
void turnColumns(FactorGraph::Term& term, Eigen::Index column, const Eigen::Matrix<double, N, N>& R) {
  for (Eigen::Index i = 0; i < term.rows(); ++i)
    term.row(i).segment<N>(column) = (term.row(i).segment<N>(column) * R.transpose()).eval();
}

using Column = Eigen::Map<Eigen::VectorXd>;

/// No entry is infinite or undefined, nor too large to square, as the elimination does.
bool canBeSquared(const Factor& factor, const FactorGraph::Term& term) {
  if (factor.form() == Factor::Form::kJacobian) return std::isfinite(term.squaredNorm());
  double sum = 0;
  for (Eigen::Index j = 0; j < term.cols(); ++j) sum += term.col(j).tail(term.rows() - j).squaredNorm();
  return std::isfinite(sum);
}

SmallVector step(const FactorGraph::Variable& variable) {
  SmallVector d(variable.size);
  for (int i = 0; i < variable.size; ++i) d[i] = variable.x[i] - variable.x_applied[i];
  return d;
}

}  // namespace

VariableId FactorGraph::addVariable(const Value& initial) {
  const VariableId id = takeSlot(free_variables_, variables_);
  Variable& variable = (*this)[id];
  variable.applied_estimate = variable.linearization_point = initial;
  variable.x = variable.x_spread = variable.x_compared = variable.x_linearized = variable.x_applied =
      variable.information = {};
  variable.size = dimension(initial);
  variable.alive = true;
  return id;
}

void FactorGraph::removeVariable(VariableId id) {
  assert((*this)[id].alive && (*this)[id].factors.empty());
  (*this)[id].alive = false;
  free_variables_.push_back(id);
}

Value FactorGraph::estimate(VariableId id) const {
  const Variable& variable = (*this)[id];
  if (variable.x == variable.x_applied) return variable.applied_estimate;
  return displaced(variable.applied_estimate, step(variable));
}

void FactorGraph::apply(VariableId id) {
  Variable& variable = (*this)[id];
  if (variable.x == variable.x_applied) return;
  variable.applied_estimate = displaced(variable.applied_estimate, step(variable));
  variable.x_applied = variable.x;
}

void FactorGraph::apply(const Factor& factor) {
  for (const VariableId v : factor.variables()) apply(v);
}

void FactorGraph::restartCoordinates() {
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    Variable& variable = variables_[i];
    if (!variable.alive) continue;
    apply({static_cast<std::int64_t>(i)});
    variable.x = variable.x_spread = variable.x_compared = variable.x_linearized = variable.x_applied = {};
    variable.linearization_point = variable.applied_estimate;
  }
}

void FactorGraph::moveLinearizationPoint(VariableId id) {
  apply(id);
  Variable& variable = (*this)[id];
  variable.linearization_point = variable.applied_estimate;
  variable.x_linearized = variable.x;
}

/// The turn between two coordinates of a variable; zero for vectors.
double FactorGraph::turnBetween(const Variable& variable, const Coordinates& from, const Coordinates& to) {
  if (std::holds_alternative<SmallVector>(variable.applied_estimate)) return 0;
  double squared = 0;
  for (int i = variable.size == 3 ? 2 : 3; i < variable.size; ++i) squared += (to[i] - from[i]) * (to[i] - from[i]);
  return std::sqrt(squared);
}

double FactorGraph::turnSinceLinearization(VariableId id) const {
  return turnBetween((*this)[id], (*this)[id].x_linearized, (*this)[id].x);
}

double FactorGraph::mismatchBound(VariableId id) const {
  const Variable& variable = (*this)[id];
  if (std::holds_alternative<SmallVector>(variable.applied_estimate)) return std::numeric_limits<double>::infinity();
  double sigmas_squared = 0;
  for (int i = 0; i < variable.size; ++i) {
    const double step = variable.x[i] - variable.x_compared[i];
    sigmas_squared += step * step * variable.information[i];
  }
  return turnBetween(variable, variable.x_compared, variable.x) * std::sqrt(sigmas_squared);
}

std::span<const Value* const> FactorGraph::valuesOf(const Factor& factor, Value Variable::*member) {
  values_.clear();
  for (const VariableId v : factor.variables()) values_.push_back(&((*this)[v].*member));
  return values_;
}

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

/// Fills `term` in steps from the applied estimates. False when it is not finite.
bool FactorGraph::evaluate(const Factor& factor, Term term) {
  apply(factor);
  if (factor.form() == Factor::Form::kJacobian) {
    factor.linearize(valuesOf(factor, &Variable::linearization_point), term);
    factor.residual(valuesOf(factor, &Variable::applied_estimate), term.col(term.cols() - 1));
    turnToWorldAxes(factor, term);
  } else {
    factor.linearize(valuesOf(factor, &Variable::applied_estimate), term);
  }
  return canBeSquared(factor, term);
}

/// From steps to coordinates: the model's right-hand side at x = 0.
void FactorGraph::shiftToCoordinates(const Factor& factor, Term term) {
  const Column x = appliedCoordinates(factor);
  const Eigen::Index n = x.size();
  if (factor.form() == Factor::Form::kJacobian) {
    term.col(n).noalias() -= term.leftCols(n) * x;
    return;
  }
  product_.assign(n, 0.0);
  addSymmetricProduct(term.data(), static_cast<int>(n + 1), static_cast<int>(n), x.data(), product_.data());
  const Column Hx(product_.data(), n);
  term(n, n) += x.dot(Hx) - 2 * x.dot(term.row(n).head(n));
  term.row(n).head(n) -= Hx.transpose();
}

std::optional<FactorId> FactorGraph::addFactor(std::unique_ptr<const Factor> factor) {
  int columns = 1;
  for (const VariableId v : factor->variables()) columns += sizeOf(v);
  double* data = terms_.take(factor->rows() * columns);
  const Term term(data, factor->rows(), columns);
  if (!evaluate(*factor, term)) {
    terms_.give(data);
    return std::nullopt;
  }
  const FactorId id = takeSlot(free_factors_, factors_);
  int at = 0;
  for (const VariableId v : factor->variables()) {
    Variable& variable = (*this)[v];
    variable.factors.push_back(id);
    for (int i = 0; i < variable.size; ++i, ++at)
      variable.information[i] += factor->form() == Factor::Form::kJacobian ? term.col(at).squaredNorm() : term(at, at);
  }
  LinearizedFactor& slot = factors_[id.value];
  slot.term = data;
  slot.columns = columns;
  slot.drift = 0;
  slot.cost = 0;
  slot.factor = std::move(factor);
  setCost(slot, costOf(*slot.factor, term));
  shiftToCoordinates(*slot.factor, term);
  if (slot.factor->form() == Factor::Form::kJacobian) ++residual_count_;
  return id;
}

void FactorGraph::removeFactor(FactorId id) {
  auto& slot = factors_[id.value];
  assert(slot.factor);
  for (const VariableId v : slot.factor->variables()) std::erase((*this)[v].factors, id);
  setCost(slot, 0);
  if (slot.factor->form() == Factor::Form::kJacobian) --residual_count_;
  terms_.give(slot.term);
  slot.factor = nullptr;
  slot.term = nullptr;
  free_factors_.push_back(id);
}

void FactorGraph::linearize(FactorId id) {
  auto& slot = factors_[id.value];
  const Factor& factor = *slot.factor;
  matrix_.resize(factor.rows() * slot.columns);
  const Term fresh(matrix_.data(), factor.rows(), slot.columns);
  if (!evaluate(factor, fresh)) return;
  setCost(slot, costOf(factor, fresh));
  shiftToCoordinates(factor, fresh);
  term(id) = fresh;
  slot.drift = 0;
}

FactorGraph::Mismatch FactorGraph::mismatch(FactorId id) {
  const Factor& factor = *slot(id).factor;
  const Term model = term(id);
  if (factor.form() == Factor::Form::kInformation) return informationMismatch(id);
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
  const Factor& factor = *slot(id).factor;
  const Term model = term(id);
  const Eigen::Index n = model.cols() - 1;
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
  change -= model.row(n).head(n);
  product_.assign(n, 0.0);
  addSymmetricProduct(model.data(), static_cast<int>(n + 1), static_cast<int>(n), appliedCoordinates(factor).data(),
                      product_.data());
  change -= Column(product_.data(), n);
  double squared = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    if (model(i, i) > 0) squared += change[i] * change[i] / model(i, i);
  return {.norm = std::sqrt(squared), .r = residual_};
}

void FactorGraph::correctResidual(FactorId id, std::span<const double> r) {
  Term model = term(id);
  const Eigen::Map<const Eigen::VectorXd> shift(r.data(), static_cast<Eigen::Index>(r.size()));
  if (slot(id).factor->form() == Factor::Form::kInformation)
    model.row(model.rows() - 1).head(shift.size()) += shift.transpose();
  else
    model.col(model.cols() - 1) += shift;
}

double FactorGraph::costOf(const Factor& factor, const Term& term) {
  return factor.form() == Factor::Form::kJacobian ? term.col(term.cols() - 1).squaredNorm()
                                                  : term(term.rows() - 1, term.cols() - 1);
}

void FactorGraph::setCost(LinearizedFactor& slot, double cost) {
  if (!std::isfinite(cost)) return;  // it would never leave the sum again
  total_cost_ += cost - slot.cost;
  if (slot.factor->form() == Factor::Form::kJacobian) residual_cost_ += cost - slot.cost;
  slot.cost = cost;
}

double FactorGraph::rmsResidual() const {
  const double mean_square = residual_count_ == 0 ? 0 : residual_cost_ / static_cast<double>(residual_count_);
  return std::sqrt(std::max(mean_square, kLeastMeanSquare));
}

bool FactorGraph::contains(VariableId id) const {
  return id.value >= 0 && static_cast<std::size_t>(id.value) < variables_.size() && (*this)[id].alive;
}

bool FactorGraph::contains(FactorId id) const {
  return id.value >= 0 && static_cast<std::size_t>(id.value) < factors_.size() && slot(id).factor;
}

std::vector<VariableId> FactorGraph::variables() const {
  std::vector<VariableId> ids;
  for (std::size_t i = 0; i < variables_.size(); ++i)
    if (variables_[i].alive) ids.push_back({static_cast<std::int64_t>(i)});
  return ids;
}

std::vector<FactorId> FactorGraph::factors() const {
  std::vector<FactorId> ids;
  for (std::size_t i = 0; i < factors_.size(); ++i)
    if (factors_[i].factor) ids.push_back({static_cast<std::int64_t>(i)});
  return ids;
}

}  // namespace motorcade
