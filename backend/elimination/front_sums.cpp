#include "backend/elimination/front_sums.hpp"

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/elimination/front_sums.cpp"
#include <hwy/foreach_target.h>

#include "backend/graph/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

HWY_INLINE void addTo(double* to, const double* from, int count) {
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) store(to + i, load(to + i) + load(from + i));
  for (; i < count; ++i) to[i] += from[i];
}

/// `source` gives the matrix's columns, indexed by row.
template <class ColumnOf>
HWY_INLINE void addSymmetric(const FrontColumns& front, const ColumnOf& source, std::span<const RowSpan> spans) {
  for (std::size_t b = 0; b < spans.size(); ++b) {
    const RowSpan columns = spans[b];
    const std::span<const RowSpan> below = spans.subspan(b + 1);
    for (int j = 0; j < columns.size; ++j) {
      const double* const from = source(columns.from + j);
      double* const to = front[columns.to + j];
      addTo(to + columns.to + j, from + columns.from + j, columns.size - j);
      for (const RowSpan& rows : below) {
        if (rows.to > columns.to) {
          addTo(to + rows.to, from + rows.from, rows.size);
        } else {  // above the front's diagonal, so that its transpose is added
          for (int i = 0; i < rows.size; ++i) front[rows.to + i][columns.to + j] += from[rows.from + i];
        }
      }
    }
  }
}

}  // namespace

void addPacked(const FrontColumns& front, const PackedTriangle& matrix, std::span<const RowSpan> spans) {
  addSymmetric(
      front, [&](int j) HWY_ATTR { return matrix.column(j); }, spans);
}

void addStrided(const FrontColumns& front, const double* matrix, int stride, std::span<const RowSpan> spans) {
  addSymmetric(
      front, [=](int j) HWY_ATTR { return matrix + std::ptrdiff_t(j) * stride; }, spans);
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(addPacked);
MOTORCADE_EXPORT(addStrided);

void addToFront(const FrontColumns& front, const PackedTriangle& matrix, std::span<const RowSpan> spans) {
  MOTORCADE_KERNEL(addPacked)(front, matrix, spans);
}

void addToFront(const FrontColumns& front, const double* matrix, int stride, std::span<const RowSpan> spans) {
  MOTORCADE_KERNEL(addStrided)(front, matrix, stride, spans);
}

}  // namespace motorcade
#endif
