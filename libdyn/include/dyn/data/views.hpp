// How vectors and matrices cross the library's boundary: as pointers with sizes. No Eigen object does, so flags never matter.
#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace dyn {

struct VectorView {
  const double* data = nullptr;
  std::ptrdiff_t size = 0;
};

/// Argument of an algorithm: any Eigen vector expression or a pointer with a size. Contiguous vectors are passed as they are; other
/// expressions are evaluated into a temporary on the caller's side (which allocates: pass a vector in real-time loops).
class VectorArg {
 public:
  VectorArg(const double* data, std::ptrdiff_t size) : view_{data, size} {}
  template <class Derived>
  VectorArg(const Eigen::DenseBase<Derived>& x) {  // NOLINT: meant to convert
    constexpr bool direct =
        (Derived::Flags & Eigen::DirectAccessBit) && int(Derived::InnerStrideAtCompileTime) == 1 && (int(Derived::IsVectorAtCompileTime));
    if constexpr (direct) {
      view_ = {x.derived().data(), x.size()};
    } else {
      copy_ = x.derived().template cast<double>();
      view_ = {copy_.data(), copy_.size()};
    }
  }
  VectorArg(const VectorArg&) = delete;
  VectorArg& operator=(const VectorArg&) = delete;
  operator VectorView() const { return view_; }  // NOLINT

 private:
  VectorView view_;
  Eigen::VectorXd copy_;
};

/// Results: views of memory that the Data owns, valid until it is destroyed, overwritten by the next call.
using VectorResult = Eigen::Map<const Eigen::VectorXd>;
using MatrixResult = Eigen::Map<const Eigen::MatrixXd>;

}  // namespace dyn
