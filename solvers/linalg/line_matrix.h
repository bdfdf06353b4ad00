#pragma once

#include <cstdint>
#include <memory>

#include <zwang/core/problem/types.h>

namespace zwang {

// A matrix that begins at a cache line, as Eigen's own need not: where columns are eight numbers long, or a multiple of
// that, no vector of the processor then lies on two lines. It allocates only to grow.
template <int Rows>
class LineMatrix : public Eigen::Map<Mat<double, Rows, Eigen::Dynamic>> {
  using Map = Eigen::Map<Mat<double, Rows, Eigen::Dynamic>>;

 public:
  LineMatrix() : Map(nullptr, Rows > 0 ? Rows : 0, 0) {}
  LineMatrix(Index rows, Index cols) : LineMatrix() { resize(rows, cols); }
  LineMatrix(const LineMatrix& other) : LineMatrix() { *this = other; }
  template <class Other>
  LineMatrix(const Eigen::DenseBase<Other>& other) : LineMatrix() {
    *this = other;
  }
  LineMatrix& operator=(const LineMatrix& other) { return *this = static_cast<const Eigen::DenseBase<Map>&>(other); }
  template <class Other>
  LineMatrix& operator=(const Eigen::DenseBase<Other>& other) {
    resize(other.rows(), other.cols());
    Map::operator=(other.derived());
    return *this;
  }

  void resize(Index rows, Index cols) {
    constexpr Index line = 8;
    if (rows * cols > room_) {
      room_ = rows * cols;
      storage_ = std::make_unique_for_overwrite<double[]>(at(room_ + line - 1));
    }
    const auto past = reinterpret_cast<std::uintptr_t>(storage_.get()) / sizeof(double) % line;
    double* const begin = storage_ ? storage_.get() + (past > 0 ? line - past : 0) : nullptr;
    new (static_cast<Map*>(this)) Map(begin, rows, cols);
  }
  using Map::setZero;
  void setZero(Index rows, Index cols) {
    resize(rows, cols);
    setZero();
  }

 private:
  std::unique_ptr<double[]> storage_;
  Index room_ = 0;
};

namespace lanes {
using Columns = LineMatrix<Eigen::Dynamic>;
}

}  // namespace zwang
