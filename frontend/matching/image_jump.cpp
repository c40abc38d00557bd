#include "frontend/matching/image_jump.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "frontend/parallel_items.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kSearched = 128;  // points, spread over the image
constexpr std::size_t kLeastFound = 16;

float medianOf(std::vector<float> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

std::optional<Shift> imageJump(const std::vector<FollowedPoint>& points, std::span<const int> order,
                               const YoungPointSearch& search) {
  std::vector<const FollowedPoint*> moving;
  for (const int i : order)
    if (points[i].observation.age >= 2) moving.push_back(&points[i]);
  const std::size_t stride = std::max<std::size_t>(1, moving.size() / kSearched);
  std::vector<std::optional<AlignedPatch>> found((moving.size() + stride - 1) / stride);
  forEachItem(found.size(), [&](std::size_t k) { found[k] = search(moving[k * stride]->observation); });
  std::vector<float> du_px, dv_px;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found[k]) continue;
    const FollowedPoint& point = *moving[k * stride];
    du_px.push_back(found[k]->u_px - point.observation.u_px - point.shift.du_px);
    dv_px.push_back(found[k]->v_px - point.observation.v_px - point.shift.dv_px);
  }
  if (du_px.size() < kLeastFound) return std::nullopt;
  return Shift{medianOf(std::move(du_px)), medianOf(std::move(dv_px))};
}

}  // namespace motorcade
