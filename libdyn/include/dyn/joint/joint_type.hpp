// SPDX-License-Identifier: BSD-2-Clause
// The interface that a plugin implements. Only plain types cross it: pointers to numbers, sizes, C strings.
#pragma once

#include <dyn/joint/shape.hpp>
#include <dyn/scalar/dual.hpp>
#include <dyn/scalar/traced.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn {

/// Kinds of parameters. Numbers must be finite.
enum class ParameterKind : std::int32_t {
  number,   ///< one number
  vector3,  ///< three numbers
  numbers,  ///< a list of numbers, of any length
  text,     ///< a text
  joints    ///< a list of joints, for types with Structure::series
};

/// One entry of a type's schema of parameters. compile() refuses parameters that do not fit the schema with Error(parameter).
struct ParameterSpec {
  const char* name;               ///< printable, without blanks and without any of <>&"'
  ParameterKind kind;             ///< the kind of value
  bool required;                  ///< whether a model must give it
  const char* unit;               ///< its unit, "" if it has none
  const char* help;               ///< its meaning, for messages; "" if there is nothing to say
  const char* example = nullptr;  ///< a value that the type accepts, for tests: numbers separated by spaces, or a text; "": tests leave it out
};

/// The checked value of one parameter. Arrays of arguments are in the order of the schema. They hold only during the call.
struct ParameterArgument {
  const double* numbers;  ///< `count` numbers
  int count;              ///< 0 for texts, for lists of joints and where `given` is false
  const char* text;       ///< "" for numbers and where `given` is false
  bool given;             ///< false for an optional parameter that the model leaves out
};

/// The parts of a type that are closed forms, as bits. The SDK derives the others from the pose map.
enum ClosedForm : std::uint32_t {
  closed_subspace = 1,       ///< the motion subspace S
  closed_bias = 2,           ///< the bias (dS/dt) v
  closed_configuration = 4,  ///< its own q (+) v; without it, q (+) v is the sum q + v, and neutral is zero
  own_rates = 8,             ///< only dense shapes: v is not dq/dt, and rates() computes dq/dt
};

/// How the compiler treats a type.
enum class Structure : std::int32_t {
  joint,   ///< one joint with a pose map
  series,  ///< a list of joints, one after the other (parameter "parts"); the compiler expands it
};

/// Description of a joint or coupling type. All that it points to lives as long as the type.
struct JointTypeInfo {
  const char* name;                 ///< the name by which models name the type, with the characters of ParameterSpec::name
  const char* summary;              ///< one line for people
  Structure structure;              ///< one joint, or a series of joints
  std::uint32_t closed_forms;       ///< bits of ClosedForm
  const ParameterSpec* parameters;  ///< the schema: `parameter_count` entries
  int parameter_count;              ///< number of parameters
};

/// Result of `prepare` for one joint. The joint's motion is before * core(q) * after, where core has the declared shape.
struct JointInstance {
  Shape shape = Shape::dense;              ///< the shape of the core's motion
  int nq = 0,                              ///< number of coordinates, at most max_joint_nq
      nv = 0;                              ///< number of velocities, at most max_joint_nv
  int constant_count = 0;                  ///< how many numbers `constants` writes
  SE3<double> before,                      ///< constant part of the motion before the core
      after;                               ///< constant part behind it
  double subspace[6 * max_joint_nv] = {};  ///< dense_constant only: S (6 x nv, linear part first), column after column
};

/// Arrays of one batch: `lanes` states of each of `count` joints. Component c of joint i in state l is at [c * stride + i * lanes + l]. Each array
/// has its own stride, which counts numbers. Motions are in the moving frame, linear part first.
template <class S>
struct JointBatch {
  int count = 0;                        ///< number of joints
  int lanes = 1;                        ///< number of states
  const double* constants = nullptr;    ///< component c of joint i at [c * constants_stride + i]
  int constant_count = 0;               ///< number of components of `constants`
  std::ptrdiff_t constants_stride = 0;  ///< stride of `constants`
  const S* q = nullptr;                 ///< coordinates, nq components
  std::ptrdiff_t q_stride = 0;          ///< stride of q
  const S* v = nullptr;                 ///< velocities, nv components; null: compute poses (and subspaces) only
  std::ptrdiff_t v_stride = 0;          ///< stride of v
  std::ptrdiff_t stride = 0;            ///< stride of pose, subspace and bias
  S* pose = nullptr;                    ///< poseSize(shape) components, as Shape defines them
  S* subspace = nullptr;                ///< 6 nv components, S column after column; null for all shapes but dense
  S* bias = nullptr;                    ///< 6 components, (dS/dt) v; null unless the shape is dense and v is given
};

/// Arrays of the configuration-space functions of one batch, laid out as in JointBatch. Each function of JointType says which arrays it uses.
template <class S>
struct ConfigurationBatch {
  int count = 0;                        ///< number of joints
  int lanes = 1;                        ///< number of states
  const double* constants = nullptr;    ///< component c of joint i at [c * constants_stride + i]
  int constant_count = 0;               ///< number of components of `constants`
  std::ptrdiff_t constants_stride = 0;  ///< stride of `constants`
  std::ptrdiff_t q_stride = 0,          ///< stride of q0, q1 and q_out
      v_stride = 0,                     ///< stride of v and v_out
      j_stride = 0;                     ///< stride of J_q and J_v
  const S* q0 = nullptr;                ///< the (first) configuration, nq components
  const S* q1 = nullptr;                ///< the second configuration, nq components
  const S* v = nullptr;                 ///< velocities or tangent vectors, nv components
  S* q_out = nullptr;                   ///< resulting coordinates or their rates, nq components
  S* v_out = nullptr;                   ///< resulting tangent vector, nv components
  S* J_q = nullptr;                     ///< nv x nv, row-major: derivative w.r.t. the (first) configuration
  S* J_v = nullptr;                     ///< the same w.r.t. the tangent vector, or the second configuration; set if J_q is
};

/// A joint type, as a plugin implements it. One call serves a whole batch of joints of the type. Implementations are
/// stateless and re-entrant: a joint's parameters live in the model's constants, and results go to the caller's arrays. No function may throw, or
/// keep a pointer after it returns. Authors write it by the SDK: dyn_sdk/joint_plugin.hpp.
class JointType {
 public:
  /// Returns the type's description.
  virtual const JointTypeInfo& info() const noexcept = 0;

  /// Checks parameters, which already have the right kinds, and fills `out`. If it refuses them, writes the reason into `message`, of message_size
  /// bytes, and returns false.
  virtual bool prepare(const ParameterArgument* parameters, JointInstance& out, char* message, int message_size) const noexcept = 0;
  /// Writes JointInstance::constant_count numbers for the joint with these parameters, which `prepare` has accepted.
  virtual void constants(const ParameterArgument* parameters, double* out) const noexcept = 0;

  /// Writes poses, subspaces and biases of the core motion. Duals carry derivatives from q and v to the results.
  /// @{
  virtual void kinematics(const JointBatch<double>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<float>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<Dual<double>>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<Dual<Dual<double>>>& batch) const noexcept = 0;
  /// @}
  /// Returns false, and writes nothing, if the type's functions cannot be traced.
  virtual bool kinematics(const JointBatch<Traced>& batch) const noexcept = 0;

  /// Writes q_out, the configuration at which the joint is "at zero". Reads constants only.
  virtual void neutral(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// Writes q_out = q0 (+) v, where the joint is after one second of v, and J_q (w.r.t. q0) and J_v (w.r.t. v). Leaves out results that are null.
  virtual void integrate(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// Writes v_out = q1 (-) q0, the v with q0 (+) v = q1, and J_q (w.r.t. q0) and J_v (w.r.t. q1). Leaves out results that are null.
  virtual void difference(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// Writes q_out = q0 brought back onto the configuration space, and v_out (one component) = its distance from that space before. Leaves out
  /// results that are null.
  virtual void normalize(const ConfigurationBatch<double>& batch) const noexcept = 0;

  /// Writes q_out = dq/dt at q0 for velocities v, with derivatives along both. Only called for types with own_rates.
  virtual void rates(const ConfigurationBatch<Dual<double>>& batch) const noexcept = 0;
  /// The same for tracing. Returns false, and writes nothing, if the type's functions cannot be traced.
  virtual bool rates(const ConfigurationBatch<Traced>& batch) const noexcept = 0;

 protected:
  ~JointType() = default;  // owned by the plugin, never deleted through this interface
};

/// A type of relation that makes one coordinate a function of another (mimic, cams, gears): y = f(x) with its first three derivatives. The rules of
/// JointType hold here as well.
class CouplingType {
 public:
  /// Returns the type's description.
  virtual const JointTypeInfo& info() const noexcept = 0;
  /// Checks parameters, which already have the right kinds, and writes how many constants they make. If it refuses them, writes the reason into
  /// `message`, of message_size bytes, and returns false.
  virtual bool prepare(const ParameterArgument* parameters, int& constant_count, char* message, int message_size) const noexcept = 0;
  /// Writes constant_count numbers for these parameters, which `prepare` has accepted.
  virtual void constants(const ParameterArgument* parameters, double* out) const noexcept = 0;
  /// Writes f[0..3]: f(x) and its first three derivatives. `constants` has constant_count numbers.
  virtual void evaluate(const double* constants, int constant_count, double x, double* f) const noexcept = 0;

 protected:
  ~CouplingType() = default;
};

}  // namespace dyn
