// The algorithms over many states. Arguments are matrices whose columns are states, nq or nv rows, at most as many columns as the batch
// has room for; so are results, which the batch owns until its next call.
//
// Throw Error(size) for matrices of wrong sizes, Error(argument) for a quaternion that is zero, naming the state; the other states' results are
// there. As for single states, forward dynamics of models with joints that follow others goes through M, and computeJointJacobians refuses them.
#pragma once

#include <dyn/algorithm/jacobians.hpp>
#include <dyn/data/batch_data.hpp>

#include <type_traits>

namespace dyn {

namespace detail {

template <class T>
struct StatesView {
  const T* data = nullptr;
  std::ptrdiff_t rows = 0, cols = 0, stride = 0;
  bool given = false;  ///< an argument, even one without numbers
};

/// Argument: a column-major matrix, a block of columns, a Map. Nothing is copied.
template <class T>
class StatesArg {
 public:
  template <class Derived>
  StatesArg(const Eigen::DenseBase<Derived>& x)  // NOLINT: meant to convert
      : view_{x.derived().data(), x.rows(), x.cols(), x.derived().outerStride(), true} {
    static_assert(std::is_same_v<typename Derived::Scalar, T>, "the batch computes in another number type");
    static_assert(!Derived::IsRowMajor || int(Derived::ColsAtCompileTime) == 1, "columns are states: a column-major matrix");
    static_assert(int(Derived::InnerStrideAtCompileTime) == 1, "the numbers of a state must follow one another");
  }
  operator StatesView<T>() const { return view_; }  // NOLINT

 private:
  StatesView<T> view_;
};

enum class BatchQuantity { rnea, nle, gravity, mass_matrix, aba };
/// Returns the result's first number; v and a that are not given are zero.
template <class T>
DYN_API const T* computeBatch(const CompactModel&, BasicBatchData<T>&, BatchQuantity, StatesView<T> q, StatesView<T> v, StatesView<T> a);
template <class T>
DYN_API const T* batchJacobians(const CompactModel&, BasicBatchData<T>&, StatesView<T> q, Kind kind, int id, ReferenceFrame);
template <class T>
DYN_API void batchKinematics(const CompactModel&, BasicBatchData<T>&, StatesView<T> q, StatesView<T> v, StatesView<T> a);

/// Not deduced from, so that any matrix converts.
template <class T>
using States = StatesArg<std::type_identity_t<T>>;
template <class T>
using StatesResult = Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>;

template <class T>
StatesResult<T> computeBatch(const CompactModel& model, BasicBatchData<T>& data, BatchQuantity what, Eigen::Index rows, const StatesView<T>& q,
                             const StatesView<T>& v, const StatesView<T>& a) {
  return {computeBatch<T>(model, data, what, q, v, a), rows, q.cols};
}

template <class T>
StatesResult<T> batchJacobians(const CompactModel& model, BasicBatchData<T>& data, Kind kind, int id, ReferenceFrame reference,
                               const StatesView<T>& q) {
  return {batchJacobians<T>(model, data, q, kind, id, reference), 6 * Eigen::Index(model.nv()), q.cols};
}

}  // namespace detail

/// tau, nv x N, as the rnea of one state.
template <class T>
auto rnea(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V, const detail::States<T>& A) {
  return detail::computeBatch<T>(model, data, detail::BatchQuantity::rnea, model.nv(), Q, V, A);
}
/// rnea at zero acceleration.
template <class T>
auto nonLinearEffects(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  return detail::computeBatch<T>(model, data, detail::BatchQuantity::nle, model.nv(), Q, V, detail::StatesView<T>{});
}
/// rnea at rest.
template <class T>
auto generalizedGravity(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::computeBatch<T>(model, data, detail::BatchQuantity::gravity, model.nv(), Q, detail::StatesView<T>{}, detail::StatesView<T>{});
}
/// Each column is a mass matrix, nv * nv numbers. The batch must have been made with Need::mass_matrix.
template <class T>
auto crba(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::computeBatch<T>(model, data, detail::BatchQuantity::mass_matrix, Eigen::Index(model.nv()) * model.nv(), Q, detail::StatesView<T>{},
                                 detail::StatesView<T>{});
}
/// Joint accelerations, nv x N. Throws Error(singular) naming joint and state, whose column is NaN; the others are right.
template <class T>
auto aba(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V, const detail::States<T>& Tau) {
  return detail::computeBatch<T>(model, data, detail::BatchQuantity::aba, model.nv(), Q, V, Tau);
}

/// Each column is a Jacobian, 6 x nv numbers, as the function of the same name writes it for one state. The batch must have been made with
/// Need::jacobians.
template <class T>
auto computeJointJacobians(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::batchJacobians<T>(model, data, detail::Kind::all_joints, 0, ReferenceFrame::WORLD, Q);
}
template <class T>
auto computeJointJacobian(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, int joint, ReferenceFrame reference) {
  return detail::batchJacobians<T>(model, data, detail::Kind::joint, joint, reference, Q);
}
template <class T>
auto computeFrameJacobian(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, int frame, ReferenceFrame reference) {
  return detail::batchJacobians<T>(model, data, detail::Kind::frame, frame, reference, Q);
}

/// Poses, with V velocities, with A accelerations of all joints, to be read by the functions below. The batch must have been made with
/// Need::kinematics.
template <class T>
void forwardKinematics(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  detail::batchKinematics<T>(model, data, Q, {}, {});
}
template <class T>
void forwardKinematics(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  detail::batchKinematics<T>(model, data, Q, V, {});
}
template <class T>
void forwardKinematics(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V,
                       const detail::States<T>& A) {
  detail::batchKinematics<T>(model, data, Q, V, A);
}

// What the last forwardKinematics of sufficient order found for one state. Throw Error(argument) for numbers out of range, or a
// batch of another model.
template <class T>
DYN_API SE3<T> framePlacement(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state);
template <class T>
DYN_API Motion<T> frameVelocity(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference);
template <class T>
DYN_API Motion<T> frameAcceleration(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference);

}  // namespace dyn
