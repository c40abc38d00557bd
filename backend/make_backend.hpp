#pragma once

#include <memory>

#include "backend/backend.hpp"
#include "backend/filter/filter_backend.hpp"
#include "backend/smoother/optimizer.hpp"

namespace motorcade {

enum class BackendKind {
  kSmoother,  // the incremental smoother over camera and objects
  kFilter,    // the paper's baseline: chained odometry and one Kalman filter per object
};

struct BackendParams {
  BackendKind kind = BackendKind::kSmoother;
  Optimizer::Params smoother;
  FilterBackend::Params filter;
};

/// Throws std::invalid_argument, naming the parameter, when one is out of range.
std::unique_ptr<Backend> makeBackend(const BackendParams& params);

}  // namespace motorcade
