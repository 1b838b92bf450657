// SPDX-License-Identifier: BSD-2-Clause
// The interface that a plugin implements. It is called once per batch of joints of one type, never once per joint.
//
// Only plain types cross the interface: pointers to numbers, sizes, C strings. Implementations are stateless and re-entrant: a joint's parameters
// live in the model's constants, and results go to the caller's arrays. No function may throw, or keep a pointer after it returns.
#pragma once

#include <dyn/joint/shape.hpp>
#include <dyn/scalar/dual.hpp>
#include <dyn/scalar/traced.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn {

enum class ParameterKind : std::int32_t { number, vector3, numbers, text, joints };

/// One entry of a type's schema of parameters. The compiler refuses parameters that do not fit the schema.
struct ParameterSpec {
  const char* name;
  ParameterKind kind;
  bool required;
  const char* unit;
  const char* help;
  const char* example = nullptr;  ///< a value that the type accepts, for tests: numbers separated by spaces, or a text; "": tests leave it out
};

/// A checked parameter, in the order of the schema. `given` is false for an optional parameter that the model leaves out.
struct ParameterArgument {
  const double* numbers;
  int count;
  const char* text;
  bool given;
};

/// The parts that an author wrote in closed form. The SDK derives the others from the pose map.
enum ClosedForm : std::uint32_t {
  closed_subspace = 1,
  closed_bias = 2,
  closed_configuration = 4,
  own_rates = 8,  ///< only dense shapes: v is not dq/dt, and rates() computes dq/dt
};

enum class Structure : std::int32_t {
  joint,   ///< one joint with a pose map
  series,  ///< a list of joints, one after the other (parameter "parts"); the compiler expands it
};

struct JointTypeInfo {
  const char* name;
  const char* summary;
  Structure structure;
  std::uint32_t closed_forms;
  const ParameterSpec* parameters;
  int parameter_count;
};

/// Result of `prepare` for one joint. The joint's motion is before * core(q) * after, where core has the declared shape.
struct JointInstance {
  Shape shape = Shape::dense;
  int nq = 0, nv = 0;
  int constant_count = 0;
  SE3<double> before, after;
  double subspace[6 * max_joint_nv] = {};  ///< dense_constant only: S, column after column
};

/// Arrays of one batch: `lanes` states of each of `count` joints. Component c of joint i in state l is at [c * stride + i * lanes + l].
template <class S>
struct JointBatch {
  int count = 0;
  int lanes = 1;
  const double* constants = nullptr;  ///< component c of joint i at [c * constants_stride + i]
  int constant_count = 0;
  std::ptrdiff_t constants_stride = 0;
  const S* q = nullptr;
  std::ptrdiff_t q_stride = 0;
  const S* v = nullptr;  ///< null: compute poses (and subspaces) only
  std::ptrdiff_t v_stride = 0;
  std::ptrdiff_t stride = 0;  ///< of pose, subspace and bias
  S* pose = nullptr;
  S* subspace = nullptr;  ///< null for all shapes but dense
  S* bias = nullptr;      ///< 6 components, null unless the shape is dense and v is given
};

/// Arrays of the configuration-space functions of one batch, laid out as in JointBatch. It depends on the function which arrays are set.
template <class S>
struct ConfigurationBatch {
  int count = 0;
  int lanes = 1;
  const double* constants = nullptr;
  int constant_count = 0;
  std::ptrdiff_t constants_stride = 0;
  std::ptrdiff_t q_stride = 0, v_stride = 0, j_stride = 0;
  const S* q0 = nullptr;
  const S* q1 = nullptr;
  const S* v = nullptr;
  S* q_out = nullptr;
  S* v_out = nullptr;
  S* J_q = nullptr;  ///< nv x nv, row-major: derivative w.r.t. the (first) configuration
  S* J_v = nullptr;  ///< derivative w.r.t. the tangent vector, or the second configuration
};

class JointType {
 public:
  virtual const JointTypeInfo& info() const noexcept = 0;

  /// Checks parameters, which already have the right kinds, and fills `out`. If it refuses them, writes the reason into `message` and returns false.
  virtual bool prepare(const ParameterArgument* parameters, JointInstance& out, char* message, int message_size) const noexcept = 0;
  /// Writes `constant_count` numbers for the joint with these parameters.
  virtual void constants(const ParameterArgument* parameters, double* out) const noexcept = 0;

  /// Writes poses, subspaces and biases of the core motion.
  virtual void kinematics(const JointBatch<double>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<float>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<Dual<double>>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<Dual<Dual<double>>>& batch) const noexcept = 0;
  /// Returns false, and writes nothing, if the type's functions cannot be traced.
  virtual bool kinematics(const JointBatch<Traced>& batch) const noexcept = 0;

  /// Writes q_out, the configuration at which the joint is "at zero".
  virtual void neutral(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// Writes q_out = q0 (+) v, and J_q and J_v if they are set.
  virtual void integrate(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// Writes v_out = q1 (-) q0, and J_q (w.r.t. q0) and J_v (w.r.t. q1) if they are set.
  virtual void difference(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// Writes q_out = q0 brought back onto the configuration space, and v_out[0] = its distance from that space before.
  virtual void normalize(const ConfigurationBatch<double>& batch) const noexcept = 0;

  /// Writes q_out = dq/dt at q0 for velocities v. Only called for types with own_rates.
  virtual void rates(const ConfigurationBatch<Dual<double>>& batch) const noexcept = 0;
  /// Returns false, and writes nothing, if it cannot be traced.
  virtual bool rates(const ConfigurationBatch<Traced>& batch) const noexcept = 0;

 protected:
  ~JointType() = default;  // owned by the plugin, never deleted through this interface
};

/// A relation that makes one coordinate a function of another (mimic, cams, gears): y = f(x) with its first three derivatives.
class CouplingType {
 public:
  virtual const JointTypeInfo& info() const noexcept = 0;
  virtual bool prepare(const ParameterArgument* parameters, int& constant_count, char* message, int message_size) const noexcept = 0;
  virtual void constants(const ParameterArgument* parameters, double* out) const noexcept = 0;
  /// Writes f[0..3]: f(x) and its first three derivatives.
  virtual void evaluate(const double* constants, int constant_count, double x, double* f) const noexcept = 0;

 protected:
  ~CouplingType() = default;
};

}  // namespace dyn
