// SPDX-License-Identifier: BSD-2-Clause
// The four algorithms with one way of dispatch. The static and the virtual ways are compiled in separate sources, because the inlined recursions
// take a compiler half a minute each.
#pragma once

#include "dispatch/dispatch.hpp"
#include "dispatch/orders.hpp"
#include "kernels/body/dissipation.hpp"
#include "kernels/recursion/aba.hpp"
#include "kernels/recursion/crba.hpp"
#include "kernels/recursion/kinematics.hpp"
#include "kernels/recursion/rnea.hpp"

#include <dyn/error.hpp>

#include <algorithm>

namespace dyn::benchmark {

struct Memory {
  explicit Memory(const CompactModel& model) : compact(model), scene{model.impl(), w, {}, {}, {}, false, true, {}} {
    const CompactImpl& m = model.impl();
    Arena count(nullptr);
    layOut(w, m, count);
    block.resize(count.used() + Arena::alignment);
    const auto address = reinterpret_cast<std::uintptr_t>(block.data());
    Arena arena(block.data() + (Arena::alignment - address % Arena::alignment) % Arena::alignment);
    layOut(w, m, arena);
    atRest(w);
    tau.resize(static_cast<std::size_t>(m.nv));
    ddq = tau;
    M.resize(tau.size() * tau.size());
    if (!m.couplings.empty())
      throw Error(ErrorCode::argument, "profile: the model has joints that follow others; --mimic independent leaves them free");
    scene.members.resize(static_cast<std::size_t>(m.bodies()));
    scene.places.resize(scene.members.size());
    scene.batched.resize(m.batches.size());
    for (int i = 1; i < m.bodies(); ++i) add(i);
  }

  void add(int i) {
    const CompactImpl& m = scene.m;
    const BodyIndex& x = m.index[static_cast<std::size_t>(i)];
    const TypeBatch& batch = m.batches[static_cast<std::size_t>(x.batch)];
    const std::string name = batch.type->info().name;
    AnyJoint& member = scene.members[static_cast<std::size_t>(i)];
    const JointType*& batched = scene.batched[static_cast<std::size_t>(x.batch)];
    if (!findMember(name, member, batched)) {
      scene.outside.insert(name);
      batched = batch.type;
    }
    const JointMemory<double>& numbers = w.joints[x.batch];
    scene.places[static_cast<std::size_t>(i)] = {batch.constants.data() + x.slot,
                                                 batch.count,
                                                 batch.constant_count,
                                                 x.idx_q,
                                                 x.idx_v,
                                                 numbers.pose + x.slot,
                                                 numbers.subspace ? numbers.subspace + x.slot : nullptr,
                                                 numbers.bias ? numbers.bias + x.slot : nullptr,
                                                 numbers.stride};
    const bool flies = i == 1 && name == standard::FreeFlyer::name;
    scene.floating_base = scene.floating_base || flies;
    scene.uniform = scene.uniform && (flies || name == standard::Revolute::name);
  }

  CompactModel compact;
  Workspace<double> w;
  std::vector<char> block;
  std::vector<double> tau, ddq, M;
  Scene scene;
};

/// Adds the four algorithms over one order. An algorithm with `passes` passes makes evaluation + passes * pass dispatches.
template <class Order>
void addOrder(const std::shared_ptr<Memory>& memory, const char* name, int evaluation, int pass, std::vector<Contender>& out) {
  Memory& x = *memory;
  const CompactImpl& m = x.scene.m;
  const auto order = std::make_shared<Order>(x.scene);
  const auto add = [&](const char* algorithm, int passes, auto run, const double* result, std::size_t size) {
    out.push_back({algorithm, name, evaluation + passes * pass,
                   [memory, order, run](const double* q, const double* v, const double* a) { run(*memory, *order, q, v, a); }, result,
                   static_cast<int>(size)});
  };
  add(
      "fk", 1,
      [](Memory& s, const Order& o, const double* q, const double*, const double*) {
        o.evaluate(q, nullptr);
        kernels::forwardKinematics(o, s.w, static_cast<const double*>(nullptr), static_cast<const double*>(nullptr));
      },
      reinterpret_cast<const double*>(x.w.oM), 12 * static_cast<std::size_t>(m.bodies()));
  add(
      "rnea", 2,
      [](Memory& s, const Order& o, const double* q, const double* v, const double* a) {
        o.evaluate(q, v);
        kernels::rneaOutward(o, s.w, v, a);
        kernels::rneaInward(o, s.w, s.tau.data());
        kernels::addJointForces(s.scene.m, v, a, s.tau.data());
      },
      x.tau.data(), x.tau.size());
  add(
      "crba", 2,
      [](Memory& s, const Order& o, const double* q, const double*, const double*) {
        o.evaluate(q, nullptr);
        kernels::massMatrix(o, s.w, s.M.data());
      },
      x.M.data(), x.M.size());
  add(
      "aba", 3,
      [](Memory& s, const Order& o, const double* q, const double* v, const double* a) {
        o.evaluate(q, v);
        std::copy(a, a + s.scene.m.nv, s.tau.begin());
        kernels::addDissipation(s.scene.m, -1.0, v, s.tau.data());
        kernels::abaOutward(o, s.w, v);
        kernels::abaInward(o, s.w, s.tau.data());
        kernels::abaSolve(o, s.w, o.gravity(), s.ddq.data());
      },
      x.ddq.data(), x.ddq.size());
}

/// Adds the ways that find a joint's code by a virtual call: one call a batch, and one call a joint if the closed set has all types.
void addVirtualDispatch(const std::shared_ptr<Memory>& memory, std::vector<Contender>& out);
/// Adds the ways that know all types: std::variant, and monomorphic code if all joints below the root are revolute.
void addStaticDispatch(const std::shared_ptr<Memory>& memory, std::vector<Contender>& out);

}  // namespace dyn::benchmark
