#include "apps/pipeline/object_ages.hpp"

namespace motorcade {

void ObjectAges::fill(FrameEstimate& estimate) {
  constexpr double kGone_s = 60;  // far longer than an object that is found again was away
  std::erase_if(lives_,
                [&](const auto& life) { return secondsBetween(life.second.last, estimate.head.stamp) > kGone_s; });
  for (ObjectEstimate& object : estimate.objects) {
    Life& life = lives_.try_emplace(object.track, Life{estimate.head.stamp, estimate.head.stamp}).first->second;
    life.last = estimate.head.stamp;
    object.age_s = secondsBetween(life.first, life.last);
  }
}

}  // namespace motorcade
