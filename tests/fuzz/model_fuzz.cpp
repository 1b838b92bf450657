// SPDX-License-Identifier: BSD-2-Clause
// Compiles random descriptions and runs every algorithm.
#include "exercise.hpp"
#include "fuzz.hpp"
#include "support/random_model.hpp"

using namespace dyn;

namespace {

Vec3<double> vector(fuzz::Choices& choices) { return {choices.number(), choices.number(), choices.number()}; }

SE3<double> pose(fuzz::Choices& choices) { return {exp3(vector(choices)), vector(choices)}; }

JointDescription joint(fuzz::Choices& choices, const JointRegistry& registry, int number) {
  const auto& types = registry.jointTypes();
  JointDescription out;
  const JointTypeInfo& info = types[static_cast<std::size_t>(choices.below(static_cast<int>(types.size())))]->info();
  out.name = "j" + std::to_string(number);
  out.type = info.name;
  out.parameters = exampleParameters(info, choices.byte());
  for (auto& [name, value] : out.parameters)
    if (auto* numbers = std::get_if<std::vector<double>>(&value); numbers && choices.below(8) == 0)
      for (double& x : *numbers) x = choices.number();
  if (choices.below(2)) out.placement = pose(choices);
  if (choices.below(4) == 0) out.damping.assign(1, choices.number());
  if (choices.below(4) == 0) out.armature.assign(1, choices.number());
  if (choices.below(8) == 0) out.friction.assign(1, choices.number());
  if (choices.below(6) == 0 && number > 0)
    out.coupling = {
        "mimic", "j" + std::to_string(choices.below(number)), {{"coefficients", std::vector<double>{choices.number(), choices.number()}}}};
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const JointRegistry registry = JointRegistry::standard();
  fuzz::Choices choices(data, size);
  Model model;
  model.gravity = choices.below(4) ? Vec3<double>{0, 0, -9.81} : vector(choices);
  const int bodies = 1 + choices.below(12);
  for (int i = 0; i < bodies && !choices.empty(); ++i) {
    JointDescription j = joint(choices, registry, i);
    Inertia<double> inertia;
    if (choices.below(6)) {
      inertia = test::Random(choices.byte()).inertia();
    } else {
      inertia = {choices.number(),
                 vector(choices),
                 {choices.number(), choices.number(), choices.number(), choices.number(), choices.number(), choices.number()}};
    }
    model.addBody("b" + std::to_string(i), choices.below(3) ? i : choices.below(i + 1), std::move(j), inertia);
  }
  CompileOptions options;
  options.lane_groups = choices.below(2) != 0;
  if (choices.below(8) == 0) options.lock.push_back({"j0", {}});
  fuzz::succeeds([&] { fuzz::exercise(model, compile(model, registry, options), size); });
  return 0;
}
