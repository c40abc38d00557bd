#pragma once

#include <array>
#include <cstddef>

namespace vehicle_stack {

/// A small matrix as Motorcade's interface gives it: row by row.
template <std::size_t kRows, std::size_t kColumns>
struct Matrix {
  std::array<double, kRows * kColumns> values{};

  double& operator()(std::size_t row, std::size_t column) { return values[row * kColumns + column]; }
  double operator()(std::size_t row, std::size_t column) const { return values[row * kColumns + column]; }
};
using Vector3 = Matrix<3, 1>;
using Matrix3 = Matrix<3, 3>;
using Matrix6 = Matrix<6, 6>;

template <std::size_t kRows, std::size_t kInner, std::size_t kColumns>
Matrix<kRows, kColumns> operator*(const Matrix<kRows, kInner>& a, const Matrix<kInner, kColumns>& b) {
  Matrix<kRows, kColumns> product;
  for (std::size_t row = 0; row < kRows; ++row)
    for (std::size_t column = 0; column < kColumns; ++column)
      for (std::size_t i = 0; i < kInner; ++i) product(row, column) += a(row, i) * b(i, column);
  return product;
}

template <std::size_t kRows, std::size_t kColumns>
Matrix<kRows, kColumns> operator*(double factor, Matrix<kRows, kColumns> a) {
  for (double& value : a.values) value *= factor;
  return a;
}

template <std::size_t kRows, std::size_t kColumns>
Matrix<kRows, kColumns> operator+(Matrix<kRows, kColumns> a, const Matrix<kRows, kColumns>& b) {
  for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] += b.values[i];
  return a;
}

template <std::size_t kRows, std::size_t kColumns>
Matrix<kColumns, kRows> transposed(const Matrix<kRows, kColumns>& a) {
  Matrix<kColumns, kRows> turned;
  for (std::size_t row = 0; row < kRows; ++row)
    for (std::size_t column = 0; column < kColumns; ++column) turned(column, row) = a(row, column);
  return turned;
}

/// The covariance of J x where C is that of x: J C J'.
template <std::size_t kRows, std::size_t kColumns>
Matrix<kRows, kRows> propagated(const Matrix<kRows, kColumns>& J, const Matrix<kColumns, kColumns>& C) {
  return J * C * transposed(J);
}

/// Writes a block of 3x3 into a larger matrix.
template <std::size_t kRows, std::size_t kColumns>
void setBlock(Matrix<kRows, kColumns>& matrix, std::size_t row, std::size_t column, const Matrix3& block) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) matrix(row + i, column + j) = block(i, j);
}

/// [v]x, for which [v]x w is the cross product of v and w.
inline Matrix3 crossMatrix(const Vector3& v) {
  const auto& [x, y, z] = v.values;
  return {{0, -z, y, z, 0, -x, -y, x, 0}};
}

}  // namespace vehicle_stack
