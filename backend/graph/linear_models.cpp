#include "backend/graph/linear_models.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "backend/graph/symmetric_product.hpp"

namespace motorcade {
namespace {

/// Least noise of the residuals, without which tolerances relative to it would vanish.
constexpr double kLeastMeanSquare = 1e-8;

/// Columns M <- M R^T.
template <int N>
void turnColumns(LinearModels::Term& term, Eigen::Index column, const Eigen::Matrix<double, N, N>& R) {
  for (Eigen::Index i = 0; i < term.rows(); ++i)
    term.row(i).segment<N>(column) = (term.row(i).segment<N>(column) * R.transpose()).eval();
}

/// Turns columns that act on right perturbations into columns for steps in the world's axes:
/// to first order rho = R^T dp, phi = R^T dphi.
void turnToWorldAxes(const VariableStates& states, std::span<const VariableId> variables, LinearModels::Term& term) {
  Eigen::Index at = 0;
  for (const VariableId v : variables) {
    const Value& value = states[v].linearization_point;
    if (const auto* pose = std::get_if<SE3>(&value))
      for (const Eigen::Index k : {at, at + 3}) turnColumns<3>(term, k, pose->rotation());
    if (const auto* planar = std::get_if<SE2>(&value)) turnColumns<2>(term, at, planar->rotation());
    at += states[v].size;
  }
}

using Column = Eigen::Map<Eigen::VectorXd>;

/// r -= J x. The compiler keeps the sums of poses' six or three rows in registers.
template <int kRows>
void subtractProduct(const double* J, std::span<const double> x, double* r) {
  double sums[kRows]{};
  for (const double number : x)
    for (int row = 0; row < kRows; ++row) sums[row] += *J++ * number;
  for (int row = 0; row < kRows; ++row) r[row] -= sums[row];
}
void subtractProduct(const LinearModels::Term& model, const Column& x, double* r) {
  const std::span numbers(x.data(), static_cast<std::size_t>(x.size()));
  if (model.rows() == 6) return subtractProduct<6>(model.data(), numbers, r);
  if (model.rows() == 3) return subtractProduct<3>(model.data(), numbers, r);
  Column(r, model.rows()).noalias() -= model.leftCols(x.size()) * x;
}

/// True when all entries are finite and small enough to square, as the elimination does.
bool canBeSquared(std::span<const double> numbers) {
  double sums[4]{};  // so that they do not wait for each other
  std::size_t i = 0;
  for (; i + 4 <= numbers.size(); i += 4)
    for (int lane = 0; lane < 4; ++lane) sums[lane] += numbers[i + lane] * numbers[i + lane];
  for (; i < numbers.size(); ++i) sums[0] += numbers[i] * numbers[i];
  return std::isfinite((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

}  // namespace

bool LinearModels::add(FactorId id, AnyFactor factor) {
  slots_.resize(std::max(slots_.size(), static_cast<std::size_t>(id.value) + 1));
  Slot& slot = slots_[id.value];
  if (auto* jacobian = std::get_if<std::unique_ptr<const JacobianFactor>>(&factor))
    slot.jacobian = std::move(*jacobian);
  else
    slot.quadratic = std::move(std::get<std::unique_ptr<const InformationFactor>>(factor));
  slot.columns = 1;
  for (const VariableId v : slot.factor().variables()) slot.columns += states_[v].size;
  if (!linearize(id)) {
    slot = {};
    return false;
  }
  int at = 0;
  for (const VariableId v : slot.factor().variables())
    for (int i = 0; i < states_[v].size; ++i, ++at)
      states_[v].information[i] += slot.jacobian ? term(id).col(at).squaredNorm() : information(id).H.column(at)[at];
  if (slot.jacobian) ++residual_count_;
  return true;
}

void LinearModels::remove(FactorId id) {
  Slot& slot = slots_[id.value];
  setCost(slot, 0);
  if (slot.jacobian) --residual_count_;
  terms_.give(slot.term);
  terms_.give(slot.g_c);
  slot = {};
}

void LinearModels::setCost(Slot& slot, double cost) {
  if (!std::isfinite(cost)) return;  // it would never leave the sum again
  total_cost_ += cost - slot.cost;
  if (slot.jacobian) residual_cost_ += cost - slot.cost;
  slot.cost = cost;
}

double LinearModels::rmsResidual() const {
  const double mean_square = residual_count_ == 0 ? 0 : residual_cost_ / static_cast<double>(residual_count_);
  return std::sqrt(std::max(mean_square, kLeastMeanSquare));
}

std::span<const Value* const> LinearModels::valuesOf(const Factor& factor, Value VariableState::*member) {
  values_.resize(factor.variables().size());
  std::ranges::transform(factor.variables(), values_.begin(), [&](VariableId v) { return &(states_[v].*member); });
  return values_;
}

/// Stacks the coordinates of the factor's variables at the applied estimates, in `coordinates_`.
Column LinearModels::appliedCoordinates(const Factor& factor) {
  const std::size_t most = factor.variables().size() * VariableState::kMaxDimension;
  if (coordinates_.size() < most) coordinates_.resize(most);
  double* end = coordinates_.data();
  for (const VariableId v : factor.variables()) {
    const VariableState& state = states_[v];
    __builtin_memcpy(end, state.x_applied.data(), sizeof(state.x_applied));  // so many are copied without a call
    end += state.size;
  }
  return {coordinates_.data(), end - coordinates_.data()};
}

LinearModels::Term LinearModels::term(FactorId id) const {
  assert(isJacobian(id));
  return {slot(id).term, slot(id).factor().rows(), slot(id).columns};
}

LinearModels::Information LinearModels::information(FactorId id) const {
  const Slot& slot = slots_[id.value];
  assert(slot.quadratic);
  return {.H = {slot.lower_H, slot.columns - 1}, .g_c = {slot.g_c, slot.columns}};
}

bool LinearModels::linearize(FactorId id) {
  Slot& slot = slots_[id.value];
  states_.apply(slot.factor().variables());
  if (!(slot.jacobian ? linearizeResidual(slot) : linearizeInformation(id))) return false;
  slot.drift = 0;
  return true;
}

/// Computes the model and the cost at the applied estimates. Returns false, and changes nothing, when they are not
/// finite.
bool LinearModels::linearizeResidual(Slot& slot) {
  const JacobianFactor& factor = *slot.jacobian;
  matrix_.resize(std::size_t(factor.rows()) * slot.columns);
  Term fresh(matrix_.data(), factor.rows(), slot.columns);
  factor.linearize(valuesOf(factor, &VariableState::linearization_point), fresh);
  factor.residual(valuesOf(factor, &VariableState::applied_estimate), fresh.rightCols<1>().col(0));
  turnToWorldAxes(states_, factor.variables(), fresh);
  if (!canBeSquared(matrix_)) return false;
  setCost(slot, fresh.rightCols<1>().squaredNorm());
  subtractProduct(fresh, appliedCoordinates(factor), fresh.rightCols<1>().data());
  if (!slot.term) slot.term = terms_.take(matrix_.size());
  std::ranges::copy(matrix_, slot.term);
  return true;
}

/// Linearizes an InformationFactor. Where its held model is still valid, the model's H is used in place, not copied.
bool LinearModels::linearizeInformation(FactorId id) {
  Slot& slot = slots_[id.value];
  const InformationFactor& factor = *slot.quadratic;
  const auto values = valuesOf(factor, &VariableState::applied_estimate);
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
  const Information fresh = information(id);
  Eigen::Map<Eigen::VectorXd> g_c = fresh.g_c;
  g_c = model.g_c;
  setCost(slot, fresh.c());
  // From steps to coordinates: the model at x = 0.
  const Column x = appliedCoordinates(factor);
  product_.assign(x.size(), 0.0);
  addSymmetricProduct(fresh.H, x.data(), product_.data());
  const Column Hx(product_.data(), x.size());
  g_c[x.size()] += x.dot(Hx) - 2 * x.dot(g_c.head(x.size()));
  g_c.head(x.size()) -= Hx;
  return true;
}

void LinearModels::fetch(FactorId id) const {
  constexpr int kLine = 64 / sizeof(double), kFactorLines = 6;
  const Slot& slot = this->slot(id);
  if (!slot.jacobian) return;
  const auto* const factor = reinterpret_cast<const double*>(slot.jacobian.get());
  for (int line = 0; line < kFactorLines; ++line) __builtin_prefetch(factor + line * kLine);
  for (int i = 0; i < slot.jacobian->rows() * slot.columns; i += kLine) __builtin_prefetch(slot.term + i);
}

LinearModels::Mismatch LinearModels::mismatch(FactorId id) {
  if (!isJacobian(id)) return informationMismatch(id);
  const JacobianFactor& factor = *slot(id).jacobian;
  const Term model = term(id);
  states_.apply(factor.variables());
  residual_.resize(factor.rows());
  Column r(residual_.data(), factor.rows());
  factor.residual(valuesOf(factor, &VariableState::applied_estimate), r);
  setCost(slots_[id.value], r.squaredNorm());
  r -= model.rightCols<1>();
  subtractProduct(model, appliedCoordinates(factor), r.data());
  return {.norm = r.norm(), .r = residual_};
}

/// Mismatch of the gradient; its norm divides each entry by the square root of its information.
LinearModels::Mismatch LinearModels::informationMismatch(FactorId id) {
  const InformationFactor& factor = *slot(id).quadratic;
  const Information model = information(id);
  const Eigen::Index n = model.H.size;
  states_.apply(factor.variables());
  residual_.assign(n + 1, 0.0);
  Column difference(residual_.data(), n + 1);
  factor.gradient(valuesOf(factor, &VariableState::applied_estimate), difference);
  if (!std::isfinite(difference.squaredNorm())) {
    residual_.assign(n, 0.0);
    return {.norm = 0, .r = residual_};
  }
  setCost(slots_[id.value], difference[n]);
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

void LinearModels::correctResidual(FactorId id, const Mismatch& mismatch) {
  const Eigen::Map<const Eigen::VectorXd> shift(mismatch.r.data(), static_cast<Eigen::Index>(mismatch.r.size()));
  if (!isJacobian(id))
    information(id).g_c.head(shift.size()) += shift;
  else
    term(id).rightCols<1>() += shift;
  slots_[id.value].drift += mismatch.norm;
}

}  // namespace motorcade
