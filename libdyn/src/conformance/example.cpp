// SPDX-License-Identifier: BSD-2-Clause
// Makes up parameters from a schema.
#include "conformance/support.hpp"

#include <charconv>
#include <cstring>

namespace dyn {

namespace {

using conformance::Random;

std::vector<double> toNumbers(const Vec3<double>& x) { return {x.x, x.y, x.z}; }

/// Returns a direction that is not nearly parallel to any of the others (|cosine| < 0.9).
Vec3<double> newDirection(Random& random, const std::vector<Vec3<double>>& others) {
  while (true) {
    const Vec3<double> n = random.direction();
    bool apart = true;
    for (const Vec3<double>& m : others) apart = apart && std::fabs(dot(m, n)) < 0.9;
    if (apart) return n;
  }
}

JointDescription part(const char* type, Random& random) {
  JointDescription joint;
  joint.name = type;
  joint.type = type;
  joint.parameters["axis"] = toNumbers(random.direction());
  joint.placement.p = random.direction();
  return joint;
}

/// Returns the example that the type's author gave. Throws Error(parameter) if it should be numbers and is not.
ParameterValue exampleValue(const ParameterSpec& spec) {
  if (spec.kind == ParameterKind::text) return std::string(spec.example);
  std::vector<double> numbers;
  for (const char *p = spec.example, *end = p + std::strlen(p); p != end;) {
    double x = 0;
    const auto [next, error] = std::from_chars(p, end, x);
    if (error != std::errc()) throw Error(ErrorCode::parameter, std::string("the example of parameter '") + spec.name + "' is not made of numbers");
    numbers.push_back(x);
    p = next;
    while (p != end && *p == ' ') ++p;
  }
  return numbers;
}

}  // namespace

Parameters exampleParameters(const JointTypeInfo& info, std::uint64_t seed) {
  Random random(seed);
  Parameters parameters;
  std::vector<Vec3<double>> directions;
  const auto size = [&] { return random.uniform(0.1, 0.5); };
  for (int i = 0; i < info.parameter_count; ++i) {
    const ParameterSpec& spec = info.parameters[i];
    if (spec.example) {
      if (*spec.example != '\0') parameters[spec.name] = exampleValue(spec);
      continue;
    }
    if (!spec.required && seed % 2 == 1) continue;
    switch (spec.kind) {
      case ParameterKind::number:
        parameters[spec.name] = std::vector<double>{size()};
        break;
      case ParameterKind::vector3:
        // A vector with a unit is not a direction but three sizes, which may have to be positive (radii).
        if (*spec.unit != '\0') {
          parameters[spec.name] = std::vector<double>{size(), size(), size()};
        } else if (directions.size() < 3) {
          directions.push_back(newDirection(random, directions));
          parameters[spec.name] = toNumbers(directions.back());
        } else {
          parameters[spec.name] = toNumbers(random.direction());
        }
        break;
      case ParameterKind::numbers:
        parameters[spec.name] = std::vector<double>{size(), size(), size()};
        break;
      case ParameterKind::text:
        parameters[spec.name] = std::string("example");
        break;
      case ParameterKind::joints:
        parameters[spec.name] = std::vector<JointDescription>{part("revolute", random), part("prismatic", random)};
        break;
    }
  }
  return parameters;
}

}  // namespace dyn
