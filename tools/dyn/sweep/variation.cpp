// SPDX-License-Identifier: BSD-2-Clause
#include "variation.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/named_configuration.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::tool::sweep {

namespace {

constexpr std::int64_t most_cells = std::int64_t{1} << 40;
using Kind = Quantity::Kind;

struct OptionRange {
  const char* name;
  double MotionOptions::*member;
  double low, high;
  const char* rule;
};
constexpr OptionRange option_ranges[] = {{"dt", &MotionOptions::dt, 1e-300, 1e300, "positive"},
                                         {"friction", &MotionOptions::friction, 0, 1e300, "0 or more"},
                                         {"ground_height", &MotionOptions::height, -1e300, 1e300, "finite"},
                                         {"restitution", &MotionOptions::restitution, 0, 1, "in 0 to 1"},
                                         {"tolerance", &MotionOptions::tolerance, 1e-300, 1e300, "positive"}};

void requireInside(const std::string& name, double x, double low, double high, const char* rule) {
  if (!(x >= low && x <= high)) throw Error(ErrorCode::argument, name + " is " + CLI::detail::to_string(x) + " and must be " + rule);
}

/// Uniform within -bound and bound, which must be finite.
Distribution within(const json::Value& value, const double* low, const double* high, int size) {
  Distribution out;
  out.kind = Distribution::Kind::uniform;
  out.size = size;
  out.rows = {{low, low + size}, {high, high + size}};
  for (int k = 0; k < size; ++k)
    if (!std::isfinite(low[k]) || !std::isfinite(high[k])) value.fail("the model has no limit for entry " + std::to_string(k) + "; give [low, high]");
  return out;
}

bool asksForLimits(const json::Value& value) {
  return value.json().is_object() && value.json().size() == 1 && value.has("uniform") && value["uniform"].json() == "limits";
}

/// The names of the joints, without the world.
std::vector<std::string> jointNames(const CompactModel& model) {
  std::vector<std::string> names = namesOf(model.joints());
  names.erase(names.begin());
  return names;
}

/// The numbers of one draw of a value whose size nothing else tells: as many as the longest list has that stands for one.
int longestIn(const json::Value& value) {
  const auto length = [](const nlohmann::json& x) { return x.is_array() ? static_cast<int>(std::min(x.size(), std::size_t{1} << 20)) : 1; };
  if (!value.json().is_object() || value.json().empty()) return std::max(length(value.json()), 1);
  int most = 1;
  if (const nlohmann::json& inside = value.json().begin().value(); inside.is_array())
    for (const nlohmann::json& x : inside) most = std::max(most, length(x));
  return most;
}

Distribution ofState(const json::Value& value, Kind kind, const CompactModel& model, int first, int size) {
  if (!asksForLimits(value)) return readDistribution(value, size);
  const ModelLimits& limits = model.limits();
  if (kind == Kind::a) value.fail("a model has no limits of accelerations");
  if (kind == Kind::kp || kind == Kind::kd) value.fail("a model has no limits of gains");
  if (kind == Kind::q || kind == Kind::target) {
    const auto joint = std::find_if(model.joints().begin(), model.joints().end(), [&](const JointRecord& j) { return j.idx_v == first && j.nv > 0; });
    if (joint->nq != joint->nv) value.fail("give [low, high] for this joint: its coordinates are not its displacements");
    return within(value, limits.lower.data() + joint->idx_q, limits.upper.data() + joint->idx_q, size);
  }
  const std::vector<double>& most = kind == Kind::v ? limits.velocity : limits.effort;
  std::vector<double> low(most.size());
  std::transform(most.begin(), most.end(), low.begin(), [](double x) { return -x; });
  return within(value, low.data() + first, most.data() + first, size);
}

}  // namespace

Variation::Variation(const Study& study, const Model& description, const CompactModel& model) : model_(model), seed_(study.seed) {
  if (!study.document.contains("vary")) return;
  const json::Value vary = study.value()["vary"];
  std::vector<std::string> known{"q", "v", "a", "tau", "gravity", "bodies", "joints"};
  if (study.task == TaskKind::simulate) {
    known.erase(known.begin() + 2);
    known.emplace_back("pd");
    for (const OptionRange& option : option_ranges) known.emplace_back(option.name);
  } else if (study.task == TaskKind::collide) {
    known = {"q"};
  } else if (study.task == TaskKind::python) {
    known.emplace_back("values");
  }
  if (!vary.json().is_object()) vary.fail("must be an object");
  // Sorted by name, so that the order within the file does not matter.
  vary.eachMember([&](const std::string& name, const json::Value& value) {
    if (std::find(known.begin(), known.end(), name) == known.end()) unknownName(vary, "quantity", name, known);
    if (name == "q") return readState(value, Kind::q, name, description);
    if (name == "v") return readState(value, Kind::v, name, description);
    if (name == "a") return readState(value, Kind::a, name, description);
    if (name == "tau") return readState(value, Kind::tau, name, description);
    if (name == "bodies") return readBodies(value, description);
    if (name == "joints") return readJoints(value, description, study);
    if (name == "pd") return readController(value, description);
    if (name == "values") return readValues(value);
    const int size = name == "gravity" ? 3 : 1;
    const auto option = std::find_if(std::begin(option_ranges), std::end(option_ranges), [&](const OptionRange& o) { return name == o.name; });
    add({name,
         size == 3 ? Kind::gravity : Kind::option,
         static_cast<int>(option - std::begin(option_ranges)),
         size,
         {{0, readDistribution(value, size)}}});
  });
  if (study.effort_limits && !controls_) study.value()["effort_limits"].fail("there are no torques to limit; give 'tau' or 'pd' in 'vary'");
  placeCells();
}

void Variation::add(Quantity quantity) {
  changes_model_ |= quantity.kind >= Kind::gravity && quantity.kind < Kind::option;
  changes_others_ |= quantity.kind == Kind::gravity || (quantity.kind >= Kind::damping && quantity.kind < Kind::option);
  changes_limits_ |= quantity.isLimit();
  changes_options_ |= quantity.kind == Kind::option;
  controls_ |= quantity.kind == Kind::tau || quantity.kind == Kind::kp || quantity.kind == Kind::kd;
  quantities_.push_back(std::move(quantity));
}

void Variation::readState(const json::Value& value, Kind kind, const std::string& name, const Model& description) {
  Quantity quantity{name, kind, 0, 0, {}};
  quantity.size = quantity.isConfiguration() ? model_.nq() : model_.nv();
  if (quantity.isConfiguration() && asksForLimits(value)) {
    quantity.limits = true;
    return add(std::move(quantity));
  }
  if (value.json().is_object() && value.has("joints")) {
    if (value.json().size() != 1) value.fail("with 'joints' it has no other member");
    value["joints"].eachMember([&](const std::string& joint, const json::Value& entry) {
      const int index = model_.findJoint(joint);
      if (index < 1) unknownName(value["joints"], "moving joint", joint, jointNames(model_));
      const JointRecord& record = model_.joints()[static_cast<std::size_t>(index)];
      if (record.nv == 0) entry.fail("the joint depends on another one");
      quantity.parts.push_back({record.idx_v, ofState(entry, kind, model_, record.idx_v, record.nv)});
    });
    return add(std::move(quantity));
  }
  const nlohmann::json& given = value.json();
  if (quantity.isConfiguration() && (!given.is_object() || given.contains("list"))) {
    quantity.coordinates = true;
    quantity.parts.push_back({0, readDistribution(value, model_.nq(), [&](const json::Value& point) {
                                std::vector<double> x = [&] {
                                  if (!point.json().is_string()) return readNumbers(point, model_.nq());
                                  const Eigen::VectorXd q = namedConfiguration(model_, description, point.text());
                                  return std::vector<double>(q.begin(), q.end());
                                }();
                                const Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(x.data(), model_.nq());
                                if (!isNormalized(model_, q, 1e-6))
                                  point.fail("is no configuration: a quaternion or a point of the unit circle is not of length 1");
                                return x;
                              })});
  } else {
    quantity.parts.push_back({0, ofState(value, kind, model_, 0, model_.nv())});
  }
  add(std::move(quantity));
}

void Variation::readBodies(const json::Value& value, const Model& description) {
  value.eachMember([&](const std::string& body, const json::Value& entry) {
    const int index = description.findBody(body);
    if (index < 1) unknownName(value, "body", body, namesOf(description.bodies));
    entry.only({"mass", "com"});
    if (entry.has("mass")) add({"bodies." + body + ".mass", Kind::mass, index, 1, {{0, readDistribution(entry["mass"], 1)}}});
    if (entry.has("com")) add({"bodies." + body + ".com", Kind::com, index, 3, {{0, readDistribution(entry["com"], 3)}}});
  });
}

void Variation::readJoints(const json::Value& value, const Model& description, const Study& study) {
  value.eachMember([&](const std::string& joint, const json::Value& entry) {
    const int body = description.findJoint(joint), index = model_.findJoint(joint);
    if (body < 1 || index < 1) unknownName(value, "moving joint", joint, jointNames(model_));
    const JointRecord& record = model_.joints()[static_cast<std::size_t>(index)];
    if (record.nv == 0) entry.fail("the joint depends on another one");
    entry.only({"armature", "damping", "effort", "friction", "lower", "upper", "velocity"});
    const std::pair<const char*, Kind> kinds[] = {{"armature", Kind::armature}, {"damping", Kind::damping}, {"effort", Kind::effort},
                                                  {"friction", Kind::friction}, {"lower", Kind::lower},     {"upper", Kind::upper},
                                                  {"velocity", Kind::velocity}};
    for (const auto& [name, kind] : kinds) {
      if (!entry.has(name)) continue;
      if ((kind == Kind::damping || kind == Kind::friction) && !study.options.losses) entry[name].fail("acts only with \"losses\": true");
      if (study.task != TaskKind::python) {
        if ((kind == Kind::lower || kind == Kind::upper) && !study.options.limits) entry[name].fail("acts only with \"limits\": true");
        if (kind == Kind::effort && !study.effort_limits) entry[name].fail("acts only with \"effort_limits\": true");
        if (kind == Kind::velocity) entry[name].fail("acts only in the task python");
      }
      const int size = kind == Kind::lower || kind == Kind::upper ? record.nq : record.nv;
      add({"joints." + joint + "." + name, kind, body, size, {{0, readDistribution(entry[name], size)}}});
    }
  });
}

void Variation::readController(const json::Value& value, const Model& description) {
  value.only({"kd", "kp", "target"});
  if (value.has("kd")) readState(value["kd"], Kind::kd, "pd.kd", description);
  if (value.has("kp")) readState(value["kp"], Kind::kp, "pd.kp", description);
  if (value.has("target")) readState(value["target"], Kind::target, "pd.target", description);
  if (!value.has("kd") && !value.has("kp")) value.fail("has neither 'kp' nor 'kd', so that it does nothing");
}

void Variation::readValues(const json::Value& value) {
  value.eachMember([&](const std::string& name, const json::Value& entry) {
    if (name.empty() || name.find('/') != std::string::npos) value.fail("'" + name + "' is no name of a value: a text without /");
    const int size = longestIn(entry);
    add({"values." + name, Kind::value, 0, size, {{0, readDistribution(entry, size)}}});
  });
}

void Variation::placeCells() {
  for (auto quantity = quantities_.rbegin(); quantity != quantities_.rend(); ++quantity)
    for (auto part = quantity->parts.rbegin(); part != quantity->parts.rend(); ++part) {
      part->stride = cells_;
      if (part->distribution.cells() > most_cells / cells_) throw Error(ErrorCode::argument, "lists and grids together have more than 2^40 cells");
      cells_ *= part->distribution.cells();
    }
}

Inputs Variation::draw(std::uint64_t sample) const {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model_.nv());
  const Eigen::VectorXd rest = neutral(model_);
  Inputs out{rest, zero, zero, zero, rest, zero, zero, {}, sample};
  const auto cell = static_cast<std::int64_t>(sample % static_cast<std::uint64_t>(cells_));
  for (const Quantity& quantity : quantities_) {
    const RandomNumbers random(seed_, sample, quantity.name);
    const bool displaced = quantity.isConfiguration() && !quantity.coordinates;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(displaced ? model_.nv() : quantity.size);
    for (const Quantity::Part& part : quantity.parts)
      part.distribution.draw(random, static_cast<std::uint32_t>(part.first), cell / part.stride % part.distribution.cells(), x.data() + part.first);
    if (quantity.limits) {
      x = randomConfiguration(model_, random.bits(0));
    } else if (displaced) {
      x = integrate(model_, rest, x);
    }
    out.values.insert(out.values.end(), x.begin(), x.end());
    if (quantity.kind == Kind::q) out.q = x;
    if (quantity.kind == Kind::v) out.v = x;
    if (quantity.kind == Kind::a) out.a = x;
    if (quantity.kind == Kind::tau) out.tau = x;
    if (quantity.kind == Kind::target) out.target = x;
    if (quantity.kind == Kind::kp) out.kp = x;
    if (quantity.kind == Kind::kd) out.kd = x;
  }
  return out;
}

ModelNumbers Variation::apply(const Inputs& inputs, const Model& description, MotionOptions& options) const {
  ModelNumbers out;
  const double* x = inputs.values.data();
  for (const Quantity& quantity : quantities_) {
    if (quantity.kind == Kind::gravity) out.gravity = {x[0], x[1], x[2]};
    if (quantity.kind == Kind::option) {
      const OptionRange& option = option_ranges[quantity.target];
      requireInside(option.name, *x, option.low, option.high, option.rule);
      options.*option.member = *x;
    }
    if (quantity.kind >= Kind::mass && quantity.kind <= Kind::armature) {
      const BodyDescription& body = description.bodies[static_cast<std::size_t>(quantity.target)];
      if (quantity.kind == Kind::mass || quantity.kind == Kind::com) {
        // Quantities of one body follow one another.
        if (out.inertias.empty() || out.inertias.back().body != body.name) out.inertias.push_back({body.name, body.inertia});
        Inertia<double>& inertia = out.inertias.back().inertia;
        if (quantity.kind == Kind::mass) {
          requireInside(quantity.name, *x, 1e-300, 1e300, "a positive factor");
          inertia.mass *= *x;
          inertia.rotational = *x * inertia.rotational;
        } else {
          inertia.com = inertia.com + Vec3<double>{x[0], x[1], x[2]};
        }
      } else {
        const std::vector<double> numbers(x, x + quantity.size);
        for (const double number : numbers) requireInside(quantity.name, number, 0, 1e300, "0 or more");
        (quantity.kind == Kind::damping    ? out.damping
         : quantity.kind == Kind::friction ? out.friction
                                           : out.armature)
            .push_back({body.joint.name, numbers});
      }
    }
    x += quantity.size;
  }
  return out;
}

void Variation::applyLimits(const Inputs& inputs, Model& description) const {
  const double* x = inputs.values.data();
  for (const Quantity& quantity : quantities_) {
    if (quantity.isLimit()) {
      JointLimits& limits = description.bodies[static_cast<std::size_t>(quantity.target)].joint.limits;
      const bool position = quantity.kind == Kind::lower || quantity.kind == Kind::upper;
      for (int k = 0; k < quantity.size; ++k) requireInside(quantity.name, x[k], position ? -1e300 : 0, 1e300, position ? "finite" : "0 or more");
      (quantity.kind == Kind::lower      ? limits.lower
       : quantity.kind == Kind::upper    ? limits.upper
       : quantity.kind == Kind::velocity ? limits.velocity
                                         : limits.effort)
          .assign(x, x + quantity.size);
    }
    x += quantity.size;
  }
}

Json Variation::json(const Inputs& inputs) const {
  Json out = Json::object();
  const double* x = inputs.values.data();
  for (const Quantity& quantity : quantities_) {
    out[quantity.name] = flat(x, quantity.size);
    x += quantity.size;
  }
  return out;
}

}  // namespace dyn::tool::sweep
