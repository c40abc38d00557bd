#include "apps/bridge/messages/object_fields.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace motorcade {

SE3 boxInBody(const Result::Object& object) {
  return {Eigen::Matrix3d::Identity(), vectorFrom(object.box_center_body_m)};
}

std::optional<Matrix6d> boxCovariance(const Result::Object& object) {
  if (!object.covariance) return std::nullopt;
  const Matrix6d adjoint = boxInBody(object).inverse().adjoint();
  Matrix6d covariance = adjoint * matrixOf<6>(*object.covariance) * adjoint.transpose();
  covariance.diagonal().head<3>() += vectorFrom(object.box_center_sigma_m).cwiseAbs2();
  if (!covariance.allFinite()) return std::nullopt;
  return covariance;
}

std::vector<KindShare> kindShares(const Result::Object& object) {
  using Kind = Result::Kind;
  const double named = object.kind == Kind::kUnknown ? 0 : std::clamp(object.kind_probability, 0.0, 1.0);
  std::vector<KindShare> shares;
  if (named > 0) shares.push_back({object.kind, named});
  if (named < 1) shares.push_back({Kind::kUnknown, 1 - named});
  return shares;
}

namespace {

constexpr int kBitsPerByte = 8;
constexpr std::size_t kHalf_bytes = 8;

/// The highest byte first.
void write(std::uint64_t value, std::uint8_t* bytes) {
  for (std::size_t i = kHalf_bytes; i-- > 0; value >>= kBitsPerByte) bytes[i] = static_cast<std::uint8_t>(value);
}

}  // namespace

ros::Uuid uuidOf(std::int64_t object, std::int64_t first_stamp_ns) {
  constexpr std::uint64_t kVersion = 8, kVersionBits = 0xF000, kBelowVersion = 0x0FFF;
  constexpr std::uint64_t kVariant = std::uint64_t{1} << 63, kBelowVariant = (std::uint64_t{1} << 62) - 1;
  constexpr std::int64_t kNanoseconds = 1000;  // per microsecond
  const auto first_us = static_cast<std::uint64_t>(first_stamp_ns / kNanoseconds);
  const std::uint64_t high = ((first_us << 4) & ~(kVersionBits | kBelowVersion)) | (first_us & kBelowVersion);
  ros::Uuid uuid{};
  write(high | kVersion << 12, uuid.data());
  write(kVariant | (static_cast<std::uint64_t>(object) & kBelowVariant), uuid.data() + kHalf_bytes);
  return uuid;
}

std::string textOf(const ros::Uuid& uuid) {
  std::string text;
  for (std::size_t i = 0; i < uuid.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += fmt::format("{:02x}", uuid[i]);
  }
  return text;
}

}  // namespace motorcade
