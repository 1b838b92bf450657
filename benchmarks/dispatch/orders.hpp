// SPDX-License-Identifier: BSD-2-Clause
// Four ways from a body to the code of its joint. Each is an order of bodies, as the kernels expect it, with its own evaluation of the joints.
#pragma once

#include "dispatch/joints.hpp"
#include "kernels/body/evaluate.hpp"

#include <array>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

namespace dyn::benchmark {

using kernels::Slot;

/// The data that all ways share: the model's arrays, and where each joint's values are in them.
struct Scene {
  const CompactImpl& m;
  Workspace<double>& w;
  std::vector<AnyJoint> members;               ///< by body; [0] unused
  std::vector<Place> places;                   ///< by body
  std::vector<const JointType*> batched;       ///< by batch
  bool floating_base = false, uniform = true;  ///< joint 1 is a free flyer; all other joints (or all) are revolute
  std::set<std::string> outside;               ///< types that the closed set lacks
};

/// libdyn's own way: one virtual call a batch of joints, one switch a run of bodies.
struct PerBatch : kernels::Bodies<double> {
  explicit PerBatch(const Scene& s) : Bodies<double>{s.m, s.w}, scene(s) {}
  const Scene& scene;
  void evaluate(const double* q, const double* v) const { kernels::evaluateJoints(m, w, q, v, scene.batched.data()); }
};

/// The step of a pass for one joint: calls the body with what it reads from the parent or sums over the children.
template <class Order, class Body, class... T>
auto eachForward(const Order& order, std::tuple<T*...> arrays, Body& body) {
  return [&, arrays](const auto& joint, int i, int iv) {
    std::apply([&](T*... x) { body(joint, i, iv, kernels::FromParent<Order, T>(order, x, i)...); }, arrays);
  };
}
template <class Order, class Body, class... T>
auto eachBackward(const Order& order, std::tuple<T*...> arrays, Body& body) {
  return [&, arrays](const auto& joint, int i, int iv) {
    std::apply([&](T*... x) { body(joint, i, iv, kernels::FromChildren<Order, T>(order, x, i)...); }, arrays);
  };
}

/// The step of a pass for one joint, behind a virtual call.
template <class Body>
struct Step {
  virtual void run(Body& body, const Slot<double>& slot, int i, int iv) const = 0;

 protected:
  ~Step() = default;
};
template <class Body, class Joint>
struct StepOf final : Step<Body> {
  DYN_FLATTEN __attribute__((noinline)) void run(Body& body, const Slot<double>& slot, int i, int iv) const override { body(Joint(slot), i, iv); }
};

struct Evaluation {
  virtual void run(const Place& at, const double* q, const double* v) const = 0;

 protected:
  ~Evaluation() = default;
};
template <class Type>
struct EvaluationOf final : Evaluation {
  void run(const Place& at, const double* q, const double* v) const override { Type::evaluate(at, q, v); }
};

/// One object per joint type, from Make<Type>::object(), as pointers to Base in the order of the variant.
template <class Base, template <class> class Make>
const Base* const* objectsByType() {
  static const auto table = []<class... Type>(std::type_identity<std::variant<Type...>>) {
    return std::array<const Base*, sizeof...(Type)>{Make<Type>::object()...};
  }(std::type_identity<AnyJoint>());
  return table.data();
}

struct PerJointVirtual : kernels::Bodies<double> {
  explicit PerJointVirtual(const Scene& s) : Bodies<double>{s.m, s.w}, scene(s) {}
  const Scene& scene;

  void evaluate(const double* q, const double* v) const {
    const Evaluation* const* objects = objectsByType<Evaluation, MakeEvaluation>();
    for (int i = 1; i < m.bodies(); ++i) objects[type(i)]->run(scene.places[static_cast<std::size_t>(i)], q, v);
  }
  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    const auto each = eachForward<PerJointVirtual>(*this, arrays, body);
    const Step<decltype(each)>* const* objects = steps<decltype(each)>();
    for (int i = 1; i < m.bodies(); ++i) objects[type(i)]->run(each, slotOf(i), i, index(i).idx_v);
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    const auto each = eachBackward<PerJointVirtual>(*this, arrays, body);
    const Step<decltype(each)>* const* objects = steps<decltype(each)>();
    for (int i = m.bodies() - 1; i > 0; --i) objects[type(i)]->run(each, slotOf(i), i, index(i).idx_v);
  }

 private:
  template <class Type>
  struct MakeEvaluation {
    static const Evaluation* object() {
      static const EvaluationOf<Type> one;
      return &one;
    }
  };
  template <class Body>
  struct Steps {
    template <class Type>
    struct Make {
      static const Step<Body>* object() {
        static const StepOf<Body, typename Type::Kernel> one;
        return &one;
      }
    };
  };
  template <class Body>
  static const Step<Body>* const* steps() {
    return objectsByType<Step<Body>, Steps<Body>::template Make>();
  }
  std::size_t type(int i) const { return scene.members[static_cast<std::size_t>(i)].index(); }
  Slot<double> slotOf(int i) const {
    const BodyIndex& x = index(i);
    const TypeBatch& batch = m.batches[static_cast<std::size_t>(x.batch)];
    return Bodies<double>::slotOf({batch.shape, batch.nv, i, 1, x.batch, x.slot}, 0);
  }
};

/// Calls std::visit for each joint in each pass.
struct PerJointVariant : kernels::Bodies<double> {
  explicit PerJointVariant(const Scene& s) : Bodies<double>{s.m, s.w}, scene(s) {}
  const Scene& scene;

  void evaluate(const double* q, const double* v) const {
    for (int i = 1; i < m.bodies(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      std::visit([&](const auto& member) { member.evaluate(scene.places[k], q, v); }, scene.members[k]);
    }
  }
  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    const auto each = eachForward<PerJointVariant>(*this, arrays, body);
    for (int i = 1; i < m.bodies(); ++i) visit(each, i);
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    const auto each = eachBackward<PerJointVariant>(*this, arrays, body);
    for (int i = m.bodies() - 1; i > 0; --i) visit(each, i);
  }

 private:
  template <class Body>
  void visit(Body& body, int i) const {
    const BodyIndex& x = index(i);
    std::visit(
        [&]<class Type>(const Type&) DYN_FLATTEN __attribute__((noinline)) {
          const Slot<double> slot = slotOf({Type::shape, Type::nv, i, 1, x.batch, x.slot}, 0);
          body(typename Type::Kernel(slot), i, x.idx_v);
        },
        scene.members[static_cast<std::size_t>(i)]);
  }
};

/// All types are known at compile time: a floating base if there is one, then revolute joints.
struct Monomorphic : kernels::Bodies<double> {
  explicit Monomorphic(const Scene& s) : Bodies<double>{s.m, s.w}, scene(s) {}
  const Scene& scene;
  using Root = Member<standard::FreeFlyer>;
  using Other = Member<standard::Revolute>;

  int first() const { return scene.floating_base ? 2 : 1; }
  void evaluate(const double* q, const double* v) const {
    if (scene.floating_base) Root::evaluate(scene.places[1], q, v);
    for (int i = first(); i < m.bodies(); ++i) Other::evaluate(scene.places[static_cast<std::size_t>(i)], q, v);
  }
  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    const auto each = eachForward<Monomorphic>(*this, arrays, body);
    if (scene.floating_base) run<Root>(each, 1);
    others(each, first(), m.bodies(), 1);
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    const auto each = eachBackward<Monomorphic>(*this, arrays, body);
    others(each, m.bodies() - 1, first() - 1, -1);
    if (scene.floating_base) run<Root>(each, 1);
  }

 private:
  template <class Body>
  DYN_FLATTEN __attribute__((noinline)) void others(Body& body, int from, int to, int step) const {
    for (int i = from; i != to; i += step) run<Other>(body, i);
  }
  template <class Type, class Body>
  void run(Body& body, int i) const {
    const BodyIndex& x = index(i);
    const Slot<double> slot = slotOf({Type::shape, Type::nv, i, 1, x.batch, x.slot}, 0);
    body(typename Type::Kernel(slot), i, x.idx_v);
  }
};

}  // namespace dyn::benchmark
