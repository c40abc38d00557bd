#include "backend/graph/factor_graph.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

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
bool canBeSquared(std::span<const double> numbers) {
  double sum = 0;
  for (const double number : numbers) sum += number * number;
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

FactorGraph::Term FactorGraph::term(FactorId id) const {
  assert(slot(id).factor->form() == Factor::Form::kJacobian);
  return {slot(id).term, slot(id).factor->rows(), slot(id).columns};
}

FactorGraph::Information FactorGraph::information(FactorId id) const { return informationOf(slot(id)); }

FactorGraph::Information FactorGraph::informationOf(const LinearizedFactor& slot) {
  assert(slot.factor->form() == Factor::Form::kInformation);
  return {.H = {slot.lower_H, slot.columns - 1}, .g_c = {slot.g_c, slot.columns}};
}

/// The model and the cost at the applied estimates. False, and nothing changes, when they are not finite.
bool FactorGraph::linearize(LinearizedFactor& slot) {
  apply(*slot.factor);
  const bool residual = slot.factor->form() == Factor::Form::kJacobian;
  if (!(residual ? linearizeResidual(slot) : linearizeInformation(slot))) return false;
  slot.drift = 0;
  return true;
}

bool FactorGraph::linearizeResidual(LinearizedFactor& slot) {
  const Factor& factor = *slot.factor;
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
  const Factor& factor = *slot.factor;
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

void FactorGraph::giveBack(LinearizedFactor& slot) {
  terms_.give(slot.term);
  terms_.give(slot.g_c);
  slot.term = slot.g_c = nullptr;
  slot.lower_H = nullptr;
}

std::optional<FactorId> FactorGraph::addFactor(std::unique_ptr<const Factor> factor) {
  LinearizedFactor fresh;
  fresh.columns = 1;
  for (const VariableId v : factor->variables()) fresh.columns += sizeOf(v);
  fresh.factor = std::move(factor);
  if (!linearize(fresh)) return std::nullopt;
  const FactorId id = takeSlot(free_factors_, factors_);
  LinearizedFactor& slot = factors_[id.value];
  slot = std::move(fresh);
  const bool residual = slot.factor->form() == Factor::Form::kJacobian;
  int at = 0;
  for (const VariableId v : slot.factor->variables()) {
    Variable& variable = (*this)[v];
    variable.factors.push_back(id);
    for (int i = 0; i < variable.size; ++i, ++at)
      variable.information[i] += residual ? term(id).col(at).squaredNorm() : information(id).H.column(at)[at];
  }
  if (residual) ++residual_count_;
  return id;
}

void FactorGraph::removeFactor(FactorId id) {
  auto& slot = factors_[id.value];
  assert(slot.factor);
  for (const VariableId v : slot.factor->variables()) std::erase((*this)[v].factors, id);
  setCost(slot, 0);
  if (slot.factor->form() == Factor::Form::kJacobian) --residual_count_;
  giveBack(slot);
  slot.factor = nullptr;
  free_factors_.push_back(id);
}

void FactorGraph::linearize(FactorId id) { linearize(factors_[id.value]); }

FactorGraph::Mismatch FactorGraph::mismatch(FactorId id) {
  const Factor& factor = *slot(id).factor;
  if (factor.form() == Factor::Form::kInformation) return informationMismatch(id);
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
  const Factor& factor = *slot(id).factor;
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
  if (slot(id).factor->form() == Factor::Form::kInformation)
    information(id).g_c.head(shift.size()) += shift;
  else
    term(id).rightCols<1>() += shift;
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
