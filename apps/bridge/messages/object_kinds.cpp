#include "apps/bridge/messages/object_kinds.hpp"

#include <algorithm>

namespace motorcade {

std::vector<KindShare> kindShares(const Result::Object& object) {
  using Kind = Result::Kind;
  const double named = object.kind == Kind::kUnknown ? 0 : std::clamp(object.kind_probability, 0.0, 1.0);
  std::vector<KindShare> shares;
  if (named > 0) shares.push_back({object.kind, named});
  if (named < 1) shares.push_back({Kind::kUnknown, 1 - named});
  return shares;
}

}  // namespace motorcade
