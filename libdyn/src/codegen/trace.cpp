// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "codegen/schedule.hpp"
#include "codegen/traced_bodies.hpp"
#include "compile/compact_impl.hpp"
#include "kernels/body/dissipation.hpp"
#include "kernels/derivative/aba_derivatives.hpp"
#include "kernels/derivative/centroidal.hpp"
#include "kernels/derivative/minverse.hpp"
#include "kernels/derivative/rnea_derivatives.hpp"
#include "kernels/recursion/aba.hpp"
#include "kernels/recursion/crba.hpp"
#include "kernels/recursion/jacobians.hpp"
#include "kernels/recursion/rnea.hpp"

#include <dyn/catalogue/algorithm.hpp>
#include <dyn/codegen/differentiate.hpp>
#include <dyn/codegen/trace.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <deque>
#include <memory>

namespace dyn {

namespace {

using T = Traced;

/// Holds the recursions' memory in traced numbers and evaluates the joints into it.
class Tracer {
 public:
  Tracer(const CompactImpl& m, bool packable) : limbs(m, packable), bodies(m, w, limbs), m_(m) {
    limbs.builder = &builder;
    w.limbs = &limbs;
    Arena counted(nullptr);
    layOut(counted);
    const std::size_t bytes = counted.used() + Arena::alignment;
    memory_ = std::make_unique<char[]>(bytes);  // zero bytes are numbers that are known to be zero
    const auto address = reinterpret_cast<std::uintptr_t>(memory_.get());
    Arena arena(memory_.get() + (Arena::alignment - address % Arena::alignment) % Arena::alignment);
    layOut(arena);
    atRest(static_cast<Workspace<T>&>(w));
  }

  Traced* input(int size) {
    std::vector<T>& in = inputs_.emplace_back();
    for (int i = 0; i < size; ++i) in.push_back(builder.input());
    return in.data();
  }

  /// Evaluates the poses, subspaces and, unless v is null, biases of all joints.
  void evaluate(const T* q, const T* v) {
    for (std::size_t b = 0; b < m_.batches.size(); ++b) {
      const TypeBatch& batch = m_.batches[b];
      const JointMemory<T>& memory = w.joints[b];
      std::vector<T> q_of(at(batch.nq * batch.count)), v_of(at(batch.nv * batch.count));
      JointBatch<T> call = callOf(batch);
      gather(batch, q, v, q_of, v_of);
      call.q = q_of.data();
      call.q_stride = call.v_stride = batch.count;
      call.stride = memory.stride;
      call.pose = memory.pose;
      call.subspace = memory.subspace;
      if (memory.bias && v) {
        call.v = v_of.data();
        call.bias = memory.bias;
      }
      evaluateBatch(batch, call);
    }
  }

  /// Differentiates the graphs of varying subspaces and biases along each of the joint's own degrees of freedom.
  void evaluateSubspaceDerivatives(const T* q, const T* v) {
    for (std::size_t b = 0; b < m_.batches.size(); ++b) {
      const TypeBatch& batch = m_.batches[b];
      if (batch.shape != Shape::dense) continue;
      const kernels::SubspaceDerivatives<T>& out = d.subspaces[b];
      for (int k = 0; k < batch.count; ++k) {
        const JacobianGraph changes = differentiate(traceFunction(batch.nq + batch.nv, 6 * batch.nv + 6, [&](const T* in, T* result) {
          T pose[12];
          JointBatch<T> call = callOf(batch);
          call.count = 1;
          call.constants += k;
          call.q = in;
          call.v = in + batch.nq;
          call.q_stride = call.v_stride = call.stride = 1;
          call.pose = pose;
          call.subspace = result;
          call.bias = result + 6 * batch.nv;
          evaluateBatch(batch, call);
        }));
        const BodyIndex& x = m_.index[at(batch.bodies[at(k)])];
        std::vector<T> in(q + x.idx_q, q + x.idx_q + batch.nq);
        in.insert(in.end(), v + x.idx_v, v + x.idx_v + batch.nv);
        const std::vector<T> entries = replay<T>(changes.graph, in);
        const auto place = [&](int row, int along) -> T& {
          return row < 6 * batch.nv ? out.columns[(6 * batch.nv * along + row) * out.stride + k]
                                    : out.bias[(6 * along + row - 6 * batch.nv) * out.stride + k];
        };
        const std::vector<T> rates = batch.curved ? ratesOf(batch, k, in) : std::vector<T>();
        for (int along = 0; along < batch.nv && batch.curved; ++along)
          for (int row = 0; row < 6 * batch.nv + 6; ++row) place(row, along) = T(0);
        for (std::size_t e = 0; e < entries.size(); ++e) {
          const int row = changes.sparsity.row[e], coordinate = changes.sparsity.column[e];
          if (coordinate >= batch.nq) continue;  // derivatives by v are not needed
          if (!batch.curved) place(row, coordinate) = entries[e];
          for (int along = 0; along < batch.nv && batch.curved; ++along) place(row, along) += rates[at(batch.nq * along + coordinate)] * entries[e];
        }
      }
    }
  }

  GraphBuilder builder;
  Limbs limbs;
  TracedWorkspace w;
  kernels::DerivativeWorkspace<T> d;
  const kernels::TracedBodies bodies;

 private:
  void layOut(Arena& arena) {
    dyn::layOut(static_cast<Workspace<T>&>(w), m_, arena);
    kernels::layOut(d, m_, arena);
  }
  static JointBatch<T> callOf(const TypeBatch& batch) {
    JointBatch<T> call;
    call.count = batch.count;
    call.constants = batch.constants.data();
    call.constant_count = batch.constant_count;
    call.constants_stride = batch.count;
    return call;
  }
  void gather(const TypeBatch& batch, const T* q, const T* v, std::vector<T>& q_of, std::vector<T>& v_of) const {
    for (int k = 0; k < batch.count; ++k) {
      const BodyIndex& x = m_.index[at(batch.bodies[at(k)])];
      for (int c = 0; c < batch.nq; ++c) q_of[at(c * batch.count + k)] = q[x.idx_q + c];
      for (int c = 0; c < batch.nv && v; ++c) v_of[at(c * batch.count + k)] = v[x.idx_v + c];
    }
  }
  /// Returns dq/dt of joint k for each of its unit velocities, one after the other; `in` begins with the joint's q.
  static std::vector<T> ratesOf(const TypeBatch& batch, int k, const std::vector<T>& in) {
    std::vector<T> rates(at(batch.nq * batch.nv)), unit(at(batch.nv));
    ConfigurationBatch<T> call = batch.placeOf(k).question<T>();
    call.q0 = in.data();
    call.v = unit.data();
    for (int along = 0; along < batch.nv; ++along) {
      std::fill(unit.begin(), unit.end(), T(0));
      unit[at(along)] = T(1);
      call.q_out = rates.data() + batch.nq * along;
      if (!batch.type->rates(call)) refuse(batch);
    }
    return rates;
  }
  static void evaluateBatch(const TypeBatch& batch, const JointBatch<T>& call) {
    if (!batch.type->kinematics(call)) refuse(batch);
  }
  [[noreturn]] static void refuse(const TypeBatch& batch) {
    throw Error(ErrorCode::joint_type, std::string("type '") + batch.type->info().name +
                                           "' cannot be traced: its plugin has pose maps with branches on q. Write them with select() and set "
                                           "branch_free = true in the type, then build the plugin again");
  }

  const CompactImpl& m_;
  std::unique_ptr<char[]> memory_;
  std::deque<std::vector<T>> inputs_;  ///< a deque, as pointers to its elements must stay valid
};

using Numbers = std::vector<T>;

void append(const SE3<T>& X, Numbers& out) {
  out.insert(out.end(), X.R.m, X.R.m + 9);
  out.insert(out.end(), {X.p.x, X.p.y, X.p.z});
}

/// Appends an n x n matrix, column after column. Entries are zero unless one degree of freedom lies on the other's root path.
void append(const CompactImpl& m, const kernels::PathMatrix<T>& from, Numbers& out) {
  const auto n = at(m.nvx);
  Numbers whole(n * n);
  from.assemble<T>(m.dof_end, Rows<T>{whole.data(), m.nvx});
  out.insert(out.end(), whole.begin(), whole.end());
}

/// A function that can be traced. `run` appends the numbers of the results.
struct Recipe {
  using Run = void (*)(const CompactImpl&, Tracer&, const std::vector<T*>& in, Numbers& out);
  const char* name;
  std::vector<const char*> inputs;  ///< "q" has nq numbers, the others have nv
  std::vector<AlgorithmOutput> outputs;
  Run run;
};

/// An algorithm of the catalogue, with its first `count` results.
Recipe fromCatalogue(Algorithm algorithm, Recipe::Run run, std::size_t count = 4) {
  const AlgorithmInfo& entry = info(algorithm);
  Recipe out{entry.traced, {}, {}, run};
  for (const char* input : entry.inputs)
    if (input != nullptr) out.inputs.push_back(input);
  for (std::size_t k = 0; k < count && entry.outputs[k].symbol != nullptr; ++k) out.outputs.push_back(entry.outputs[k]);
  return out;
}

void inverseDynamics(const CompactImpl& m, Tracer& t, const T* q, const T* v, const T* a, Numbers& out) {
  Numbers tau(at(m.nvx));
  t.evaluate(q, v);
  kernels::rneaOutward(t.bodies, t.w, v, a);
  kernels::rneaInward(t.bodies, t.w, tau.data());
  kernels::addJointForces(m, v, a, tau.data());
  out = tau;
}

void forwardDynamics(const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& ddq) {
  Numbers tau(in[2], in[2] + m.nvx);
  ddq.assign(at(m.nvx), T(0));
  kernels::addDissipation(m, -1.0, static_cast<const T*>(in[1]), tau.data());
  t.evaluate(in[0], in[1]);
  kernels::abaOutward(t.bodies, t.w, static_cast<const T*>(in[1]));
  kernels::abaInward(t.bodies, t.w, static_cast<const T*>(tau.data()));
  kernels::abaSolve(t.bodies, t.w, t.bodies.gravity(), ddq.data());
}

/// Does the work of kernels::downTheTree column by column. Columns begin with zeros or, given `below`, with its negative. Without `below` the product
/// is symmetric, and each entry is computed once.
Numbers downTheTree(const CompactImpl& m, const Tracer& t, const Rows<T>& right, const Rows<T>* below) {
  const auto n = at(m.nvx);
  const kernels::TreeFactors<T>& factors = t.d.factors;
  Numbers out(n * n);
  t.bodies.eachDof(0, m.nvx, [&](int j) {
    Numbers shares(n);
    kernels::alongPath(m, j, [&](int k) {
      t.bodies.goesUp(k);
      shares[at(k)] = factors.inverse[k] * right[k][j];
    });
    const int own = m.index[at(m.dof_body[at(j)])].idx_v;
    for (int i = below ? 0 : j; i < m.nvx; ++i) {
      t.bodies.goesDown(i);
      T sum = below && i >= own ? -(*below)[j][i] : T(0);
      kernels::alongPath(m, i, [&](int k) {
        if (k <= j && j < m.dof_end[at(k)]) sum += factors.U[k][i] * shares[at(k)];
      });
      out[n * at(j) + at(i)] = sum;
      if (!below) out[n * at(i) + at(j)] = sum;
    }
  });
  return out;
}

void abaDerivatives(const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
  Numbers tau(in[2], in[2] + m.nvx), ddq(at(m.nvx));
  kernels::addDissipation(m, -1.0, static_cast<const T*>(in[1]), tau.data());
  t.evaluate(in[0], in[1]);
  t.evaluateSubspaceDerivatives(in[0], in[1]);
  kernels::abaDerivativesSweep<T>(kernels::recursion(m, static_cast<Workspace<T>&>(t.w), t.d), t.w, t.d, static_cast<const T*>(in[1]),
                                  static_cast<const T*>(tau.data()), ddq.data());
  const Numbers inverse = downTheTree(m, t, t.d.factors.U, nullptr), by_q = downTheTree(m, t, t.d.by_q.right, &t.d.by_q.below),
                by_v = downTheTree(m, t, t.d.by_v.right, &t.d.by_v.below);
  for (const Numbers* part : {&by_q, &by_v, &inverse}) out.insert(out.end(), part->begin(), part->end());
}

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all = [] {
    using A = Algorithm;
    Recipe centroidal_map = fromCatalogue(A::centroidal_map, [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
      out.resize(6 * at(m.nvx));
      if (m.bodies() == 1) return;  // no body moves, so there is no root
      const Numbers zero(at(m.nvx));
      t.evaluate(in[0], nullptr);
      kernels::CentroidalMaps<T> maps;
      maps.Ag = out.data();
      kernels::centroidal<T>(m, t.w, t.d, zero.data(), zero.data(), maps);
    });
    centroidal_map.inputs = {"q"};
    centroidal_map.outputs = {info(A::centroidal_map).outputs[1]};
    return std::vector<Recipe>{
        fromCatalogue(A::rnea, [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in,
                                  Numbers& out) { inverseDynamics(m, t, in[0], in[1], in[2], out); }),
        fromCatalogue(A::nle, [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in,
                                 Numbers& out) { inverseDynamics(m, t, in[0], in[1], Numbers(at(m.nvx)).data(), out); }),
        fromCatalogue(A::gravity,
                      [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
                        const Numbers zero(at(m.nvx));
                        inverseDynamics(m, t, in[0], zero.data(), zero.data(), out);
                      }),
        fromCatalogue(A::mass_matrix,
                      [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
                        out.resize(at(m.nvx) * at(m.nvx));
                        t.evaluate(in[0], nullptr);
                        kernels::massMatrix(t.bodies, t.w, out.data());
                      }),
        fromCatalogue(A::aba, forwardDynamics),
        fromCatalogue(A::minverse,
                      [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
                        t.evaluate(in[0], nullptr);
                        kernels::treeFactors<T>(m, t.w, t.d);
                        out = downTheTree(m, t, t.d.factors.U, nullptr);
                      }),
        fromCatalogue(A::placements,
                      [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
                        t.evaluate(in[0], nullptr);
                        kernels::forwardKinematics(t.bodies, t.w, static_cast<const T*>(nullptr), static_cast<const T*>(nullptr));
                        for (std::size_t j = 0; j < m.joints.size(); ++j) append(t.w.oM[m.body_of_joint[j]] * cast<T>(m.user_frame[j]), out);
                      }),
        {"frames",
         {"q"},
         {{"oMf", nullptr, Extent::twelve, Extent::frames}},
         [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
           t.evaluate(in[0], nullptr);
           kernels::forwardKinematics(t.bodies, t.w, static_cast<const T*>(nullptr), static_cast<const T*>(nullptr));
           for (std::size_t f = 0; f < m.frames.size(); ++f) append(t.w.oM[m.frame_body[f]] * cast<T>(m.frame_placement[f]), out);
         }},
        fromCatalogue(A::joint_jacobians,
                      [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
                        out.resize(6 * at(m.nvx));
                        t.evaluate(in[0], nullptr);
                        kernels::jointJacobians(t.bodies, t.w, out.data());
                      }),
        fromCatalogue(A::rnea_derivatives,
                      [](const CompactImpl& m, Tracer& t, const std::vector<T*>& in, Numbers& out) {
                        t.evaluate(in[0], in[1]);
                        t.evaluateSubspaceDerivatives(in[0], in[1]);
                        kernels::derivativesOutward(t.bodies, t.d, t.bodies.gravity(), static_cast<const T*>(in[1]), static_cast<const T*>(in[2]));
                        kernels::derivativesInward(t.bodies, t.d);
                        t.bodies.neighboursPackable(t.d.dof_force);
                        kernels::derivativesSweep<T>(kernels::recursion(m, static_cast<Workspace<T>&>(t.w), t.d), t.d);
                        append(m, t.d.by_q, out);
                        append(m, t.d.by_v, out);
                        append(m, t.d.by_a, out);
                      }),
        fromCatalogue(A::aba_derivatives, abaDerivatives, 3),
        centroidal_map,
    };
  }();
  return all;
}

}  // namespace

const std::vector<std::string>& traceableFunctions() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Recipe& r : recipes()) all.emplace_back(r.name);
    return all;
  }();
  return names;
}

namespace {
TracedFunction traced(const CompactImpl& m, const Recipe& recipe, Tracer& tracer) {
  TracedFunction out;
  out.name = recipe.name;
  std::vector<T*> in;
  for (const char* name : recipe.inputs) {
    const int size = std::string(name) == "q" ? m.nqx : m.nvx;
    out.inputs.push_back({name, size});
    in.push_back(tracer.input(size));
  }
  const ModelSizes sizes{m.nv, static_cast<int>(m.joints.size()), static_cast<int>(m.frames.size())};
  for (const AlgorithmOutput& output : recipe.outputs) out.outputs.push_back({output.symbol, sizes.of(output.rows), sizes.of(output.columns)});
  Numbers results;
  recipe.run(m, tracer, in, results);
  try {
    out.graph = tracer.builder.finish(results);
  } catch (const Error& e) {
    throw Error(e.code(), out.name + " of this model: " + e.what());
  }
  return out;
}
}  // namespace

TracedFunction trace(const CompactModel& model, const std::string& function, const TraceOptions& options) {
  const CompactImpl& m = model.impl();
  const auto recipe = std::find_if(recipes().begin(), recipes().end(), [&](const Recipe& r) { return r.name == function; });
  if (recipe == recipes().end()) {
    std::string known;
    for (const std::string& name : traceableFunctions()) known += (known.empty() ? "" : ", ") + name;
    throw Error(ErrorCode::argument, "there is no function '" + function + "' to trace; there are " + known);
  }
  if (!m.couplings.empty())
    throw Error(ErrorCode::model, "joints that follow others cannot be traced; load the model with them independent, or keep them as constraints");
  Tracer tracer(m, options.packable);
  TracedFunction out = traced(m, *recipe, tracer);
  if (tracer.limbs.has_columns && options.packable) {
    Tracer other(m, true);
    other.limbs.columns_by_neighbours = true;
    TracedFunction by_neighbours = traced(m, *recipe, other);
    if (schedule(by_neighbours.graph, true).units.size() < schedule(out.graph, true).units.size()) return by_neighbours;
  }
  return out;
}

}  // namespace dyn
