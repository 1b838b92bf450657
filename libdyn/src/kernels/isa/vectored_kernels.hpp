// SPDX-License-Identifier: BSD-2-Clause
// The recursions of one state with vectors in registers. They visit bodies, and have scratch memory of their own.
//
// The kernels on single numbers, without lane groups, take 2.1 and 2.3 times as long for rnea (HyQ, ANYmal), 2.2 for aba and 2.4 for crba. To
// measure this, use SingleKernels in place of `vectored` in packed(), dispatch.cpp.
#pragma once

#include "kernels/isa/vectored_crba.hpp"
// Specialisations come before the templates that use them.
#include "kernels/body/dissipation.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/body/scratch.hpp"
#include "kernels/isa/table.hpp"
#include "kernels/recursion/aba.hpp"
#include "kernels/recursion/centroidal_map.hpp"
#include "kernels/recursion/rnea.hpp"

namespace dyn::kernels {

struct VectoredScratch {
  Workspace<Vectored> w;
  BodyConstants<Vectored>* constants = nullptr;

  static std::size_t layOut(VectoredScratch& s, const CompactImpl& m, char* base) {
    Arena arena(base);
    layOutJoints(s.w, m, arena);
    layOutDynamics(s.w, static_cast<std::size_t>(m.bodies()), static_cast<std::size_t>(m.nvx), arena);
    arena.take(s.w.product, static_cast<std::size_t>(m.bodies()));
    arena.take(s.constants, static_cast<std::size_t>(m.bodies()));
    return arena.used();
  }
};

/// For recursions whose constants multiply vectors from the left: the constants are copied to all lanes in advance.
struct TurningBodies : CachedBodies<Vectored> {
  static constexpr bool shared_constants = false;
  const BodyConstants<Vectored>* all;
  const BodyConstants<Vectored>& constants(int i) const { return all[i]; }
};

inline PackedKernels vectoredKernels() {
  using S = Vectored;
  // In memory, a number of S is a double.
  static_assert(sizeof(S) == sizeof(double));
  static constexpr auto in = [](const double* x) { return reinterpret_cast<const S*>(x); };
  static constexpr auto out = [](double* x) { return reinterpret_cast<S*>(x); };
  static constexpr auto scratchOf = [](char* memory) -> VectoredScratch& { return *reinterpret_cast<VectoredScratch*>(memory); };
  static constexpr auto bodies = [](const CompactImpl& m, VectoredScratch& s) { return VectoredBodies{{{m, s.w}}}; };
  static constexpr auto evaluate = [](const CompactImpl& m, VectoredScratch& s, const double* q, const double* v) {
    evaluateJoints(m, s.w, in(q), v ? in(v) : nullptr);
    for (std::size_t b = 0; b < m.batches.size(); ++b)
      if (!posesFinite(m.batches[b], s.w.joints[b])) return false;
    return true;
  };

  PackedKernels k;
  k.bytes = [](const CompactImpl& m) { return scratchBytes<VectoredScratch>(m); };
  k.prepare = [](const CompactImpl& m, char* memory) {
    VectoredScratch& s = makeScratch<VectoredScratch>(memory, m);
    for (int i = 0; i < m.bodies(); ++i) s.constants[i] = broadcast<S>(m.constants[static_cast<std::size_t>(i)]);
    s.w.R[0] = s.w.product[0] = Mat3<S>::identity();
  };
  k.rnea = [](const CompactImpl& m, char* memory, const double* q, const double* v, const double* a, double* tau) {
    VectoredScratch& s = scratchOf(memory);
    const bool finite = evaluate(m, s, q, v);
    const TurningBodies turning{{{m, s.w}}, s.constants};
    rneaOutward(turning, s.w, in(v), in(a));
    rneaInward(turning, s.w, out(tau));
    addJointForces(m, v, a, tau);
    return finite;
  };
  k.massMatrix = [](const CompactImpl& m, char* memory, const double* q, double* M) {
    VectoredScratch& s = scratchOf(memory);
    const bool finite = evaluate(m, s, q, nullptr);
    massMatrixByColumns(bodies(m, s), s.w, out(M));
    return finite;
  };
  k.articulate = [](const CompactImpl& m, char* memory, const double* q, const double* v, const double* tau, int& failed) {
    VectoredScratch& s = scratchOf(memory);
    const bool finite = evaluate(m, s, q, v);
    abaOutward(bodies(m, s), s.w, in(v));
    abaInward(bodies(m, s), s.w, in(tau));
    failed = s.w.failed[0];
    return finite;
  };
  k.accelerate = [](const CompactImpl& m, char* memory, const Vec3<double>& gravity, double* ddq) {
    VectoredScratch& s = scratchOf(memory);
    abaSolve(bodies(m, s), s.w, cast<S>(gravity), out(ddq));
  };
  k.centroidalMap = [](const CompactImpl& m, char* memory, const double* q, const double* v, double* Ag, CentroidalState<double>& state) {
    VectoredScratch& s = scratchOf(memory);
    const bool finite = evaluate(m, s, q, nullptr);
    state = inNumbers<double>(kernels::centroidalMap(bodies(m, s), in(v), BodyMap<S>{out(Ag)}));
    return finite;
  };
  return k;
}

}  // namespace dyn::kernels
