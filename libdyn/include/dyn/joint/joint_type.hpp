// The interface that a plugin implements. It is called once per batch of joints of one type, never once per joint.
//
// Only plain types cross it: pointers to numbers, sizes, C strings. Implementations are stateless and re-entrant: what a joint is lives
// in the model's constants, what it computes in the caller's arrays. Nothing here may throw or keep a pointer after it returns.
#pragma once

#include <dyn/joint/shape.hpp>
#include <dyn/scalar/dual.hpp>
#include <dyn/scalar/traced.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn {

enum class ParameterKind : std::int32_t { number, vector3, numbers, text, joints };

/// One entry of the schema a type declares; the compiler refuses parameters that do not fit it.
struct ParameterSpec {
  const char* name;
  ParameterKind kind;
  bool required;
  const char* unit;
  const char* help;
  const char* example = nullptr;  ///< a value that the type accepts, for tests: numbers separated by spaces, or a text; "": leave it out
};

/// A checked parameter, in the order of the schema. `given` is false for an optional one that the model leaves out.
struct ParameterArgument {
  const double* numbers;
  int count;
  const char* text;
  bool given;
};

/// Which parts an author wrote in closed form; the SDK derives the others from the pose map.
enum ClosedForm : std::uint32_t {
  closed_subspace = 1,
  closed_bias = 2,
  closed_configuration = 4,
  own_rates = 8,  ///< of a dense shape: v is not dq/dt, rates() tells what is
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

/// What `prepare` says of one joint. The joint's motion is before * core(q) * after, where core has the declared shape.
struct JointInstance {
  Shape shape = Shape::dense;
  int nq = 0, nv = 0;
  int constant_count = 0;
  SE3<double> before, after;
  double subspace[6 * max_joint_nv] = {};  ///< dense_constant only: S, column after column
};

/// Arrays of one batch: `lanes` states of each of `count` joints. Component c of joint i in state l stands at [c * stride + i * lanes + l].
template <class S>
struct JointBatch {
  int count = 0;
  int lanes = 1;
  const double* constants = nullptr;  ///< component c of joint i at [c * constants_stride + i]
  int constant_count = 0;
  std::ptrdiff_t constants_stride = 0;
  const S* q = nullptr;
  std::ptrdiff_t q_stride = 0;
  const S* v = nullptr;  ///< null: poses (and subspaces) only
  std::ptrdiff_t v_stride = 0;
  std::ptrdiff_t stride = 0;  ///< of pose, subspace, bias
  S* pose = nullptr;
  S* subspace = nullptr;  ///< null for all shapes but dense
  S* bias = nullptr;      ///< 6 components, null unless dense and v is given
};

/// Configuration-space functions of one batch, laid out as a JointBatch is. Which arrays are set depends on the function.
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

  /// Judges parameters (already of the right kinds) and fills `out`. On refusal writes the reason into `message` and returns false.
  virtual bool prepare(const ParameterArgument* parameters, JointInstance& out, char* message, int message_size) const noexcept = 0;
  /// Writes `constant_count` numbers for the joint of these parameters.
  virtual void constants(const ParameterArgument* parameters, double* out) const noexcept = 0;

  /// Poses, subspaces and bias of the core motion.
  virtual void kinematics(const JointBatch<double>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<float>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<Dual<double>>& batch) const noexcept = 0;
  virtual void kinematics(const JointBatch<Dual<Dual<double>>>& batch) const noexcept = 0;
  /// False if the type's functions cannot be traced; then nothing is written.
  virtual bool kinematics(const JointBatch<Traced>& batch) const noexcept = 0;

  /// q_out = the configuration at which the joint is "at zero".
  virtual void neutral(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// q_out = q0 (+) v, and if asked J_q, J_v.
  virtual void integrate(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// v_out = q1 (-) q0, and if asked J_q (w.r.t. q0), J_v (w.r.t. q1).
  virtual void difference(const ConfigurationBatch<double>& batch) const noexcept = 0;
  /// q_out = q0 brought back onto the configuration space; v_out[0] = distance from it before.
  virtual void normalize(const ConfigurationBatch<double>& batch) const noexcept = 0;

  /// q_out = dq/dt at q0 for velocities v. Asked of types with own_rates only.
  virtual void rates(const ConfigurationBatch<Dual<double>>& batch) const noexcept = 0;
  /// False if it cannot be traced; then nothing is written.
  virtual bool rates(const ConfigurationBatch<Traced>& batch) const noexcept = 0;

 protected:
  ~JointType() = default;  // owned by the plugin, never deleted through this interface
};

/// A relation that makes one coordinate a function of another (mimic, cams, gears): y = f(x) with both derivatives.
class CouplingType {
 public:
  virtual const JointTypeInfo& info() const noexcept = 0;
  virtual bool prepare(const ParameterArgument* parameters, int& constant_count, char* message, int message_size) const noexcept = 0;
  virtual void constants(const ParameterArgument* parameters, double* out) const noexcept = 0;
  /// f[0..3] = f(x) and its first three derivatives.
  virtual void evaluate(const double* constants, int constant_count, double x, double* f) const noexcept = 0;

 protected:
  ~CouplingType() = default;
};

}  // namespace dyn
