// SPDX-License-Identifier: BSD-2-Clause
// The algorithms of the catalogue as functions: rnea(model, data, q, v, a, out=None), for one state and for batches.
//
// They use C's calling convention of Python directly: a call through pybind11's converters costs more than the algorithm of a small robot.
#include "arrays.hpp"
#include "objects.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/compute.hpp>
#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/rnea.hpp>

#include <structseq.h>

#include <array>
#include <cctype>
#include <cstring>
#include <deque>
#include <string>

namespace dyn::python {

namespace {

enum Slot : std::size_t { model, data, q, v, last, fext, out, slot_count };

/// A function of the module and what its calls need.
struct Function {
  const AlgorithmInfo* algorithm;
  std::string name, doc;
  std::array<const char*, slot_count> names = {"model", "data", nullptr, nullptr, nullptr, nullptr, "out"};
  std::array<PyObject*, slot_count> keywords = {};  ///< the names as Python's own strings, of which there is one each
  std::array<Slot, 5> positional = {model, data, q};
  Py_ssize_t required = 3;
  PyTypeObject* results = nullptr;  ///< the named tuple of several results
  int outputs = 0;
  PyMethodDef definition{};

  bool hasForces() const { return names[fext] != nullptr; }
};

/// Puts the arguments of a call into their slots. Returns false with a Python error for arguments that the function has not.
bool arrange(const Function& f, PyObject* const* arguments, Py_ssize_t count, PyObject* keywords, PyObject** slots) {
  if (count > f.required) {
    PyErr_Format(PyExc_TypeError, "%s takes %zd positional arguments but %zd were given", f.name.c_str(), f.required, count);
    return false;
  }
  for (Py_ssize_t k = 0; k < count; ++k) slots[f.positional[static_cast<std::size_t>(k)]] = arguments[k];
  const Py_ssize_t named = keywords ? PyTuple_GET_SIZE(keywords) : 0;
  for (Py_ssize_t k = 0; k < named; ++k) {
    PyObject* const keyword = PyTuple_GET_ITEM(keywords, k);
    // A keyword in a program's text is Python's own string; others are compared by letters.
    std::size_t slot = 0;
    while (slot < slot_count && f.keywords[slot] != keyword) ++slot;
    if (slot == slot_count)
      for (slot = 0; slot < slot_count && !(f.names[slot] && PyUnicode_CompareWithASCIIString(keyword, f.names[slot]) == 0);) ++slot;
    if (slot == slot_count || slots[slot] != nullptr) {
      PyErr_Format(PyExc_TypeError, slot == slot_count ? "%s has no argument '%U'" : "%s got two values for argument '%U'", f.name.c_str(), keyword);
      return false;
    }
    slots[slot] = arguments[count + k];
  }
  for (Py_ssize_t k = 0; k < f.required; ++k) {
    const Slot slot = f.positional[static_cast<std::size_t>(k)];
    if (slots[slot] == nullptr) {
      PyErr_Format(PyExc_TypeError, "%s misses the argument '%s'", f.name.c_str(), f.names[slot]);
      return false;
    }
  }
  if (slots[out] == Py_None) slots[out] = nullptr;
  if (slots[fext] == Py_None) slots[fext] = nullptr;
  return true;
}

/// Returns what resultOf(k) gives for each result: one array, or a named tuple of them. resultOf returns null on failure.
template <class ResultOf>
PyObject* collect(const Function& f, ResultOf&& resultOf) {
  if (f.outputs == 1) return resultOf(0);
  PyObject* const all = PyStructSequence_New(f.results);
  for (int k = 0; all != nullptr && k < f.outputs; ++k) {
    PyObject* const one = resultOf(k);
    if (one == nullptr) {
      Py_DECREF(all);
      return nullptr;
    }
    PyStructSequence_SetItem(all, k, one);
  }
  return all;
}

bool takesForces(Algorithm a) {
  return a == Algorithm::rnea || a == Algorithm::aba || a == Algorithm::rnea_derivatives || a == Algorithm::aba_derivatives;
}

/// Runs static_torque, or an algorithm that takes external forces beside q, v and a or tau.
detail::AlgorithmViews runWithForces(const CompactModel& model, Data& data, Algorithm algorithm, VectorView q, VectorView v, VectorView a,
                                     const ExternalForces& forces) {
  const Force<double>* const first = forces.data();
  const std::size_t count = forces.size();
  if (algorithm == Algorithm::static_torque) return detail::staticTorque(model, data, q, first, count);
  if (algorithm == Algorithm::rnea) return detail::rnea(model, data, q, v, a, first, count);
  if (algorithm == Algorithm::aba) return detail::aba(model, data, q, v, a, first, count);
  if (algorithm == Algorithm::rnea_derivatives) {
    const detail::DerivativeViews x = detail::rneaDerivatives(model, data, q, &v, &a, first, count);
    return {x.by_q, x.by_v, x.inertia};
  }
  const detail::DerivativeViews x = detail::abaDerivatives(model, data, q, v, a, first, count);
  return {x.by_q, x.by_v, x.inertia, x.ddq};
}

PyObject* callSingle(const Function& f, const CompactModel& model, PyObject* const* slots) {
  const char* const name = f.name.c_str();
  Data* const data = pointerTo<Data>(slots[Slot::data], name, "data");
  VectorInput vectors[3];
  if (data == nullptr) return nullptr;
  for (std::size_t k = 0; k < 3; ++k)
    if (slots[q + k] != nullptr && !vectors[k].read(slots[q + k], name, f.names[q + k])) return nullptr;
  const Algorithm algorithm = f.algorithm->algorithm;
  detail::AlgorithmViews views;
  if (slots[fext] != nullptr) {
    ExternalForces forces;
    if (!readForces(slots[fext], name, forces)) return nullptr;
    views = runWithForces(model, *data, algorithm, vectors[0].view(), vectors[1].view(), vectors[2].view(), forces);
  } else {
    views = detail::runAlgorithm(model, *data, algorithm, vectors[0].view(), vectors[1].view(), vectors[2].view());
  }
  const AlgorithmResults results(model, algorithm, views);
  const bool view = slots[out] != nullptr && PyUnicode_Check(slots[out]) && PyUnicode_CompareWithASCIIString(slots[out], "view") == 0;
  if (slots[out] == nullptr || view)
    return collect(f, [&](int k) {
      const MatrixResult x = results(static_cast<std::size_t>(k));
      return view ? viewArray(x.data(), x.rows(), x.cols(), slots[Slot::data]) : newArray(x.data(), x.rows(), x.cols());
    });
  if (f.outputs == 1) {
    const MatrixResult x = results(0);
    if (!writeTo(slots[out], name, x.data(), x.rows(), x.cols())) return nullptr;
  } else {
    if (!PyTuple_Check(slots[out]) || PyTuple_GET_SIZE(slots[out]) != f.outputs) {
      PyErr_Format(PyExc_TypeError, "%s: out must be a tuple of %d arrays", name, f.outputs);
      return nullptr;
    }
    for (int k = 0; k < f.outputs; ++k) {
      const MatrixResult x = results(static_cast<std::size_t>(k));
      if (!writeTo(PyTuple_GET_ITEM(slots[out], k), name, x.data(), x.rows(), x.cols())) return nullptr;
    }
  }
  Py_INCREF(slots[out]);
  return slots[out];
}

/// Throws Error(size) unless the arguments have a state a row, as many rows as each other, and no more than the batch has room for.
template <class T>
void checkShapes(const Function& f, const CompactModel& model, int capacity, const StatesInput<T>* states, PyObject* const* slots) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (slots[q + k] == nullptr) continue;
    const auto view = states[k].view(), first = states[0].view();
    const std::ptrdiff_t size = k == 0 ? model.nq() : model.nv();
    if (view.rows == size && view.cols == first.cols && view.cols >= 1 && view.cols <= capacity) continue;
    const bool as_many = k > 0 && first.cols >= 1 && first.cols <= capacity;
    throw Error(ErrorCode::size, f.name + ": " + f.names[q + k] + " has the shape (" + std::to_string(view.cols) + ", " + std::to_string(view.rows) +
                                     "); it must be (" + (as_many ? std::to_string(first.cols) : "1 to " + std::to_string(capacity)) + ", " +
                                     std::to_string(size) + "), a state a row");
  }
}

template <class T>
PyObject* callBatch(const Function& f, const CompactModel& model, PyObject* const* slots) {
  const char* const name = f.name.c_str();
  Batch<T>* const batch = pointerTo<Batch<T>>(slots[data], name, "data");
  if (batch == nullptr) return nullptr;
  if (slots[fext] != nullptr || slots[out] != nullptr) {
    PyErr_Format(PyExc_TypeError, "%s: batches have no '%s'", name, slots[out] ? "out" : "fext");
    return nullptr;
  }
  StatesInput<T> states[3];
  for (std::size_t k = 0; k < 3; ++k)
    if (slots[q + k] != nullptr && !states[k].read(slots[q + k], name, f.names[q + k])) return nullptr;
  checkShapes(f, model, batch->data.capacity(), states, slots);
  const InUse use(batch->busy, name);
  detail::BatchViews<T> views;
  {
    py::gil_scoped_release unlocked;
    views = detail::runBatch<T>(model, batch->data, f.algorithm->algorithm, states[0].view(), states[1].view(), states[2].view());
  }
  return collect(f, [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    const AlgorithmOutput& output = f.algorithm->outputs[i];
    const ModelSizes sizes{model.nv(), model.njoints(), static_cast<int>(model.frames().size())};
    return newArrayOfStates(views.results[i], views.states, sizes.of(output.rows), sizes.of(output.columns));
  });
}

PyObject* call(PyObject* self, PyObject* const* arguments, Py_ssize_t count, PyObject* keywords) {
  const Function& f = *static_cast<const Function*>(PyCapsule_GetPointer(self, nullptr));
  PyObject* slots[slot_count] = {};
  if (!arrange(f, arguments, count, keywords, slots)) return nullptr;
  const CompactModel* const model = pointerTo<CompactModel>(slots[Slot::model], f.name.c_str(), "model");
  if (model == nullptr) return nullptr;
  try {
    if (f.algorithm->batched && PyObject_TypeCheck(slots[data], typeOf<Batch<double>>())) return callBatch<double>(f, *model, slots);
    if (f.algorithm->batched && PyObject_TypeCheck(slots[data], typeOf<Batch<float>>())) return callBatch<float>(f, *model, slots);
    return callSingle(f, *model, slots);
  } catch (...) {
    return fail();
  }
}

/// The C++ name in Python's style: computeRNEADerivatives becomes compute_rnea_derivatives.
std::string pythonName(const std::string& name) {
  std::string out;
  const auto upper = [&name](std::size_t k) { return k < name.size() && std::isupper(static_cast<unsigned char>(name[k])); };
  for (std::size_t k = 0; k < name.size(); ++k) {
    // A capital begins a word, unless it is inside an abbreviation.
    if (k > 0 && upper(k) && (!upper(k - 1) || (k + 1 < name.size() && !upper(k + 1)))) out += '_';
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(name[k])));
  }
  return out;
}

/// Returns the sentence of help() that says what a function computes.
const char* explain(Algorithm algorithm) {
  switch (algorithm) {
    case Algorithm::center_of_mass_jacobian:
      return "Computes the Jacobian of the centre of mass, in world axes.";
    case Algorithm::joint_jacobians:
      return "Computes the columns of all joints' Jacobians in WORLD.";
    case Algorithm::rnea:
      return "Computes the joint forces tau = M(q) a + C(q, v) v + g(q) [N m, N], plus damping and friction.\n"
             "fext has a row (force, moment) for each joint, the world's first, in the joint's frame.";
    case Algorithm::nle:
      return "Computes C(q, v) v + g(q) [N m, N], plus damping and friction.";
    case Algorithm::gravity:
      return "Computes the generalised gravity g(q) [N m, N].";
    case Algorithm::static_torque:
      return "Computes the joint forces that hold the robot still against gravity and external forces.\n"
             "fext has a row (force, moment) for each joint, the world's first, in the joint's frame.";
    case Algorithm::mass_matrix:
      return "Computes the joint-space mass matrix M(q).";
    case Algorithm::aba:
      return "Computes the joint accelerations ddq = M^-1 (tau - C v - g) [rad/s^2, m/s^2].\n"
             "fext has a row (force, moment) for each joint, the world's first, in the joint's frame.";
    case Algorithm::minverse:
      return "Computes the inverse of the mass matrix.";
    case Algorithm::rnea_derivatives:
      return "Computes the derivatives of rnea by q (in tangent vectors) and v, and M, its derivative by a.\n"
             "fext has a row (force, moment) for each joint, the world's first, in the joint's frame; forces turn with the bodies.";
    case Algorithm::aba_derivatives:
      return "Computes the derivatives of aba by q (in tangent vectors) and v, M^-1, its derivative by tau, and ddq.\n"
             "fext has a row (force, moment) for each joint, the world's first, in the joint's frame; forces turn with the bodies.";
    case Algorithm::coriolis:
      return "Computes a Coriolis matrix C(q, v) for which dM/dt - 2 C is skew.";
    case Algorithm::centroidal_map:
      return "Computes the momentum about the centre of mass, and the matrix Ag for which hg = Ag v.";
    case Algorithm::centroidal_rate:
      return "Computes the momentum about the centre of mass, its rate, and Ag with its rate.";
    case Algorithm::centroidal_derivatives:
      return "Computes the derivatives of the momentum about the centre of mass by q, and of its rate by q, v and a.";
    default:
      return "";
  }
}

const char* sizeOf(Extent extent) {
  static constexpr const char* names[] = {"1", "6", "12", "nv", "njoints", "nframes", "3"};
  return names[static_cast<int>(extent)];
}

void describe(Function& f) {
  std::string signature, outputs;
  for (Py_ssize_t k = 0; k < f.required; ++k) signature += std::string(k ? ", " : "") + f.names[f.positional[static_cast<std::size_t>(k)]];
  if (f.hasForces() && f.algorithm->algorithm != Algorithm::static_torque)
    signature += ", *, fext=None, out=None";
  else
    signature += ", *, out=None";
  for (int k = 0; k < f.outputs; ++k) {
    const AlgorithmOutput& output = f.algorithm->outputs[static_cast<std::size_t>(k)];
    outputs += std::string(k ? ", " : "") + output.symbol + " (" + sizeOf(output.rows);
    outputs += output.columns == Extent::one ? ",)" : std::string(", ") + sizeOf(output.columns) + ")";
  }
  f.doc = f.name + "(" + signature + ")\n--\n\n" + explain(f.algorithm->algorithm) + "\n\nReturns " + outputs +
          ". Results go into `out` if it is given" + (f.outputs > 1 ? ", a tuple of arrays" : "") +
          "; 'view' returns views of the data's memory, which its next call overwrites." +
          (f.algorithm->batched ? "\nWith a BatchData, arguments have a state a row, and results have one more dimension, the state." : "");
}

PyTypeObject* tupleOf(const Function& f) {
  static std::deque<std::string> names;
  static std::deque<std::array<PyStructSequence_Field, 5>> fields;
  auto& mine = fields.emplace_back();
  for (std::size_t k = 0; k < static_cast<std::size_t>(f.outputs); ++k) mine[k] = {f.algorithm->outputs[k].symbol, nullptr};
  const std::string& name = names.emplace_back("libdyn." + f.name + "_result");
  PyStructSequence_Desc description{name.c_str(), "Results by name: a tuple of arrays.", mine.data(), f.outputs};
  return PyStructSequence_NewType(&description);
}

/// Whether Python has a function for it that takes or returns other things (kinematics.cpp, batch_kinematics.cpp).
bool hasOwnFunction(const AlgorithmInfo& algorithm) {
  switch (algorithm.algorithm) {
    case Algorithm::placements:
    case Algorithm::frame_jacobian:
    case Algorithm::center_of_mass:
    case Algorithm::energies:
      return true;
    default:
      return algorithm.outputs[0].symbol == nullptr;
  }
}

}  // namespace

void addFunctions(py::module_& m) {
  m.def("_python_name", &pythonName, py::arg("name"));
  static std::deque<Function> functions;
  for (const AlgorithmInfo& algorithm : algorithms()) {
    if (hasOwnFunction(algorithm)) continue;
    Function& f = functions.emplace_back();
    f.algorithm = &algorithm;
    f.name = pythonName(algorithm.function);
    f.names[q] = "q";
    for (std::size_t k = 1; k < algorithm.inputs.size() && algorithm.inputs[k] != nullptr; ++k) {
      const Slot slot = std::strcmp(algorithm.inputs[k], "fext") == 0 ? fext : static_cast<Slot>(q + k);
      f.names[slot] = algorithm.inputs[k];
      f.positional[static_cast<std::size_t>(f.required++)] = slot;
    }
    if (takesForces(algorithm.algorithm)) f.names[fext] = "fext";
    while (f.outputs < 4 && algorithm.outputs[static_cast<std::size_t>(f.outputs)].symbol != nullptr) ++f.outputs;
    for (std::size_t k = 0; k < slot_count; ++k)
      if (f.names[k] != nullptr) f.keywords[k] = PyUnicode_InternFromString(f.names[k]);
    describe(f);
    if (f.outputs > 1) f.results = tupleOf(f);
    f.definition = {f.name.c_str(), reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&call)), METH_FASTCALL | METH_KEYWORDS, f.doc.c_str()};
    const py::capsule self(&f);
    const auto function = py::reinterpret_steal<py::object>(PyCFunction_NewEx(&f.definition, self.ptr(), m.attr("__name__").ptr()));
    if (!function || (f.outputs > 1 && f.results == nullptr)) throw py::error_already_set();
    m.add_object(f.name.c_str(), function);
    if (f.outputs > 1) m.add_object((f.name + "_result").c_str(), py::handle(reinterpret_cast<PyObject*>(f.results)));
  }
}

}  // namespace dyn::python
