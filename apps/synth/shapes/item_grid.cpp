#include "apps/synth/shapes/item_grid.hpp"

namespace motorcade::synth {

template <class Visit>
void ItemGrid::forCells(const Covered& item, const Visit& visit) const {
  const int x0 = column(item.left), x1 = column(item.right), y1 = row(item.bottom);
  for (int y = row(item.top); y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) visit(y * columns_ + x);
}

ItemGrid::ItemGrid(std::vector<Covered> items, const Area& area, float cell)
    : area_(area),
      per_unit_(1 / cell),
      columns_(std::max(1, static_cast<int>(std::ceil((area.right - area.left) / cell)))),
      rows_(std::max(1, static_cast<int>(std::ceil((area.bottom - area.top) / cell)))) {
  std::erase_if(items, [&](const Covered& i) {
    return i.right < area.left || i.left > area.right || i.bottom < area.top || i.top > area.bottom;
  });
  std::stable_sort(items.begin(), items.end(), [](const Covered& a, const Covered& b) { return a.near < b.near; });
  std::vector<std::uint32_t> filled(columns_ * rows_);
  for (const auto& item : items) forCells(item, [&](std::size_t c) { ++filled[c]; });
  first_.reserve(filled.size() + 1);
  first_.push_back(0);
  for (auto& count : filled) {
    first_.push_back(first_.back() + (count + 3) / 4);
    count = 0;
  }
  groups_.resize(first_.back());
  for (const auto& item : items)
    forCells(item, [&](std::size_t c) {
      Group& group = groups_[first_[c] + filled[c] / 4];
      const std::size_t i = filled[c]++ % 4;
      group.left[i] = item.left;
      group.top[i] = item.top;
      group.right[i] = item.right;
      group.bottom[i] = item.bottom;
      group.near[i] = item.near;
      group.far[i] = item.far;
      group.item[i] = item.item;
    });
}

}  // namespace motorcade::synth
