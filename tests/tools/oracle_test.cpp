// SPDX-License-Identifier: BSD-2-Clause
// The fifty-digit reference agrees with the shared data, which independent code with other methods has made.
#include "oracle.hpp"

#include "errors.hpp"
#include "integrate/problems.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"
#include "support/truth_model.hpp"

#include <dyn/compile/compile.hpp>
#include <dyn/parsers/urdf.hpp>

using namespace dyn;
using namespace dyn::test;
using dyn::tool::TruthSample;

namespace {

/// Returns max |a - b| / max |b|.
double apart(const std::vector<long double>& a, const std::vector<long double>& b) {
  if (a.size() != b.size()) return HUGE_VAL;
  long double worst = 0, size = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    worst = std::max(worst, std::abs(a[k] - b[k]));
    size = std::max(size, std::abs(b[k]));
  }
  // Data made by differences has noise where the truth is zero.
  return size > 1e-30L ? static_cast<double>(worst / size) : static_cast<double>(worst);
}

void compare(const Model& description, const std::string& data, bool derivatives, double bound) {
  CompileOptions options;
  options.dissipation = options.armature = false;
  const CompactModel model = compile(description, registry(), options);
  const tool::Oracle oracle(description, model);
  std::size_t samples = 0;
  for (const auto& [state, entry] : tool::readSamples(sharedFolder() + "/truth/data/" + data + ".json", model)) {
    if (++samples > 2) break;  // each sample takes seconds
    const TruthSample ours = oracle.evaluate(state, derivatives);
    for (const auto& [key, numbers] : ours.truth) {
      if (!entry["truth"].contains(key)) continue;
      INFO(data << ", sample " << samples << ", " << key);
      const std::vector<long double> theirs = tool::flatten(entry["truth"][key]);
      if (key == "rnea_scale" || key == "aba_scale") {
        // Both are bounds of the same kind, whose digits do not matter. Ours may be sharper but not much wider.
        for (std::size_t k = 0; k < theirs.size(); ++k) {
          CHECK(numbers[k] <= 4 * theirs[k]);
          CHECK(numbers[k] > 0);
        }
      } else {
        const double off = apart(numbers, theirs);
        INFO("off by " << off);
        CHECK(off < bound);
      }
    }
  }
  CHECK(samples > 0);
}

}  // namespace

TEST_CASE("the reference has all the digits of the shared data, where models are described exactly", "[oracle]") {
  DYN_NEEDS_SHARED();
  // The inertias of free_body_a differ by nine orders of magnitude, so differences lose twice nine digits.
  for (const char* name : {"pendulum_double", "rope_10", "free_body_a", "free_body_c"})
    compare(readTruthModel(readJson(sharedFolder() + "/truth/models/" + name + ".json")), name, true, 1e-16);
}

TEST_CASE("the reference agrees for robots to what their placements are rounded to", "[oracle]") {
  DYN_NEEDS_SHARED();
  const auto robot = [](const std::string& name, const std::string& root) {
    urdf::Options options;
    options.root = root;
    return urdf::load(sharedFolder() + "/models/" + name + ".urdf", options);
  };
  // Where M is inverted, its condition number (4e3 to 9e4) multiplies the rounding errors of the placements' rotations.
  for (const char* name : {"joint_translation", "chain_2"})
    compare(readTruthModel(readJson(sharedFolder() + "/truth/models/" + name + ".json")), name, true, 1e-14);
  compare(robot("lwr", "fixed"), "lwr", true, 1e-10);
  compare(robot("hyq", "free_flyer"), "hyq", false, 1e-10);
}

TEST_CASE("joints without definition are refused by name", "[oracle]") {
  // The x direction of a planar joint about another axis than z is the plugin's own choice.
  Model model;
  JointDescription joint;
  joint.name = "table";
  joint.type = "planar";
  joint.parameters["axis"] = std::vector<double>{1, 0, 0};
  model.addBody("body", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  CHECK_THROWS_WITH(tool::Oracle(model, compile(model, registry())), containing("joint 'table'") && containing("planar"));
}

TEST_CASE("the reference moves as closed forms and others' series say", "[oracle]") {
  DYN_NEEDS_SHARED();
  const auto moved = [](const Model& description, const tool::State& start, double time, int steps) {
    const CompactModel model = compile(description, registry());
    return tool::Oracle(description, model).move(start, time, steps);
  };
  const auto largest = [](const Eigen::VectorXd& x) { return x.cwiseAbs().maxCoeff(); };
  // Results are rounded to doubles at the end, so they agree only to the spacing of doubles of that size.
  for (const bool chaotic : {false, true}) {
    // The chaotic motion is compared at an earlier time, because one second of it takes as long as ten seconds of the other.
    const std::vector<State> reference = pendulumReference(chaotic);
    const State& truth = reference[chaotic ? 1 : 2];
    tool::State start;
    start.q = reference[0].q;
    start.v = reference[0].v;
    const tool::State end = moved(tool::pendulum(2), start, truth.time, chaotic ? 100 : 250);
    CHECK(largest(end.q - truth.q) < 1e-15);
    CHECK(largest(end.v - truth.v) < 2e-15);
  }
  const std::vector<State> top = rigidReference("heavy_top");
  tool::State start;
  start.q = top[0].q;
  start.v = top[0].v;
  const tool::State end = moved(tool::heavyTop(), start, 1, 200);
  CHECK(largest(end.q - top[1].q) < 1e-15);
  CHECK(largest(end.v - top[1].v) < 1e-14);
}
