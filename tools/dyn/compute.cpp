// SPDX-License-Identifier: BSD-2-Clause
// dyn compute: reads states and writes their dynamics, as JSON with the keys of the golden data.
#include "commands.hpp"
#include "condition.hpp"
#include "contacts.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "states.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <iterator>
#include <memory>
#include <set>

namespace dyn::tool {

namespace {

/// One key of the output. `write` puts it, and related keys, into the sample.
struct Quantity {
  const char* key;
  std::function<void(const CompactModel&, Data&, const State&, Json&)> write;
  Need need = Need::mass_matrix;  ///< derivatives need several more nv x nv matrices
};

/// Writes a result. It is null, and KEY_error says why, where the mass matrix is singular or the model has no mass.
template <class Compute>
void writeRegular(const char* key, Json& out, Compute&& compute) {
  try {
    out[key] = flat(compute());
  } catch (const Error& e) {
    if (e.code() != ErrorCode::singular) throw;
    out[key] = nullptr;
    out[std::string(key) + "_error"] = e.what();
  }
}

/// One key of one result, null where M is singular or the model has no mass.
template <class Compute>
Quantity regular(const char* key, Compute compute, Need need = Need::mass_matrix) {
  return {key, [key, compute](auto& m, auto& d, auto& s, Json& out) { writeRegular(key, out, [&] { return compute(m, d, s); }); }, need};
}

/// A result about the centre of mass, which does not exist for a model without mass.
template <class Compute>
Quantity ofMass(const char* key, Compute compute) {
  return regular(key, [compute](auto& m, auto& d, auto& s) {
    if (!(m.mass() > 0)) throw Error(ErrorCode::singular, "the model has no mass, so no centre of mass; give its bodies inertias");
    return compute(m, d, s);
  });
}

/// Output k of an algorithm of the catalogue.
Quantity catalogued(const AlgorithmInfo& algorithm, std::size_t k) {
  const char* key = algorithm.outputs[k].key;
  const auto write = [key, &algorithm, k](const CompactModel& m, Data& d, const State& s, Json& out) {
    writeRegular(key, out, [&] { return runAlgorithm(m, d, algorithm.algorithm, s.q, s.v, algorithm.reads('t') ? s.tau : s.a)(k); });
  };
  return {key, write, algorithm.need | Need::mass_matrix};  // aba of models with dependent joints takes M, too
}

std::vector<Quantity> allQuantities() {
  std::vector<Quantity> all;
  for (const AlgorithmInfo& algorithm : algorithms())
    for (std::size_t k = 0; k < algorithm.outputs.size(); ++k)
      if (algorithm.outputs[k].key != nullptr) all.push_back(catalogued(algorithm, k));
  const Quantity others[] = {
      ofMass("com", [](auto& m, auto& d, auto& s) { return centerOfMass(m, d, s.q).position; }),
      ofMass("vcom", [](auto& m, auto& d, auto& s) { return centerOfMass(m, d, s.q, s.v).velocity; }),
      ofMass("acom", [](auto& m, auto& d, auto& s) { return centerOfMass(m, d, s.q, s.v, s.a).acceleration; }),
      ofMass("Jcom", [](auto& m, auto& d, auto& s) { return jacobianCenterOfMass(m, d, s.q); }),
      {"kinetic_energy", [](auto& m, auto& d, auto& s, Json& out) { out["kinetic_energy"] = computeKineticEnergy(m, d, s.q, s.v); }},
      {"potential_energy", [](auto& m, auto& d, auto& s, Json& out) { out["potential_energy"] = computePotentialEnergy(m, d, s.q); }},
      {"oMf",
       [](auto& m, auto& d, auto& s, Json& out) {
         forwardKinematics(m, d, s.q);
         Json frames = Json::array();
         for (std::size_t f = 1; f < m.frames().size(); ++f) {
           const SE3<double> X = framePlacement(m, d, static_cast<int>(f));
           frames.push_back({{"name", m.frames()[f].name}, {"R", flat(X.R)}, {"p", flat(X.p)}});
         }
         out["oMf"] = frames;
       }},
  };
  all.insert(all.end(), std::begin(others), std::end(others));
  return all;
}

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = allQuantities();
  return all;
}

/// One key of the output that depends on the contacts of the command line.
struct ContactQuantity {
  const char* key;
  std::function<void(const CompactModel&, Data&, ConstraintData&, const State&, Json&)> write;
};

const std::vector<ContactQuantity>& contactQuantities() {
  static const std::vector<ContactQuantity> all = [] {
    std::vector<ContactQuantity> made = {
        {"contact_ddq", [](auto& m, auto& d, auto& c, auto& s,
                           Json& out) { writeRegular("contact_ddq", out, [&] { return constraintDynamics(m, d, s.q, s.v, s.tau, c).ddq; }); }},
        {"contact_lambda",
         [](auto& m, auto& d, auto& c, auto& s, Json& out) {
           writeRegular("contact_lambda", out, [&] { return constraintDynamics(m, d, s.q, s.v, s.tau, c).lambda; });
         }},
        {"contact_J", [](auto& m, auto& d, auto& c, auto& s, Json& out) { out["contact_J"] = flat(computeConstraintJacobian(m, d, s.q, c)); }},
        {"contact_gamma",
         [](auto& m, auto& d, auto& c, auto& s, Json& out) { out["contact_gamma"] = flat(computeConstraintMotion(m, d, s.q, s.v, c).bias); }},
    };
    static const std::pair<double, std::pair<const char*, const char*>> impacts[] = {
        {0.0, {"impulse_v_after", "impulse_lambda"}}, {0.5, {"impulse_restitution_0.5_v_after", "impulse_restitution_0.5_lambda"}}};
    for (const auto& [restitution, keys] : impacts) {
      made.push_back({keys.first, [e = restitution, key = keys.first](auto& m, auto& d, auto& c, auto& s, Json& out) {
                        writeRegular(key, out, [&] { return impulseDynamics(m, d, s.q, s.v, e, c).v_after; });
                      }});
      made.push_back({keys.second, [e = restitution, key = keys.second](auto& m, auto& d, auto& c, auto& s, Json& out) {
                        writeRegular(key, out, [&] { return impulseDynamics(m, d, s.q, s.v, e, c).impulse; });
                      }});
    }
    return made;
  }();
  return all;
}

template <class Quantities>
bool isKeyOf(const Quantities& quantities, const std::string& key) {
  return std::any_of(quantities.begin(), quantities.end(), [&](const auto& q) { return key == q.key; });
}

/// Writes the Jacobians of a frame, under keys frame<index>_...
void writeFrame(const CompactModel& m, Data& d, const State& s, int frame, const std::string& prefix, Json& out) {
  const std::pair<const char*, ReferenceFrame> references[] = {
      {"local", ReferenceFrame::LOCAL}, {"local_world_aligned", ReferenceFrame::LOCAL_WORLD_ALIGNED}, {"world", ReferenceFrame::WORLD}};
  Eigen::MatrixXd J(6, m.nv());
  for (const auto& [name, reference] : references) {
    computeFrameJacobian(m, d, s.q, frame, reference, J);
    out[prefix + "J_" + name] = flat(J);
  }
  for (const auto& [name, reference] : references) {
    computeFrameJacobianTimeVariation(m, d, s.q, s.v, frame, reference, J);
    out[prefix + "dJ_" + name] = flat(J);
  }
  forwardKinematics(m, d, s.q, s.v, s.a);
  out[prefix + "velocity_local"] = flat(frameVelocity(m, d, frame, ReferenceFrame::LOCAL));
  out[prefix + "acceleration_local_spatial"] = flat(frameAcceleration(m, d, frame, ReferenceFrame::LOCAL));
  out[prefix + "acceleration_world_aligned_classical"] = flat(frameClassicalAcceleration(m, d, frame, ReferenceFrame::LOCAL_WORLD_ALIGNED));
}

Json describe(const CompactModel& model, const std::string& root) {
  Json out;
  out["robot"] = model.name();
  out["root"] = root;
  out["nq"] = model.nq();
  out["nv"] = model.nv();
  out["gravity"] = flat(model.gravity());
  out["joints"] = Json::array();
  for (std::size_t j = 1; j < model.joints().size(); ++j) {
    const JointRecord& r = model.joints()[j];
    out["joints"].push_back({{"name", r.name},
                             {"type", r.type},
                             {"parent", model.joints()[static_cast<std::size_t>(r.parent)].name},
                             {"idx_q", r.idx_q},
                             {"idx_v", r.idx_v},
                             {"nq", r.nq},
                             {"nv", r.nv}});
  }
  return out;
}

/// Writes JSON with 17 significant digits.
void print(const Json& value, std::string& out) {
  if (value.is_object()) {
    const char* separator = "{";
    for (const auto& [key, entry] : value.items()) {
      out += separator + Json(key).dump() + ":";
      print(entry, out);
      separator = ",";
    }
    out += *separator == '{' ? "{}" : "}";
  } else if (value.is_array()) {
    out += "[";
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (i) out += ",";
      print(value[i], out);
    }
    out += "]";
  } else if (value.is_number_float()) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value.get<double>());
    out += text;
  } else {
    out += value.dump();
  }
}

struct Options {
  ModelOptions model;
  std::string states, named;
  std::vector<std::string> only, frames, contacts;
};

/// Quantities that depend on M^-1.
constexpr const char* by_inverse[] = {"aba", "Minv", "ddq_dq", "ddq_dv", "contact_ddq", "contact_lambda"};

/// Warns about the first state where M is nearly singular. A signal ends the search.
void warnOfCondition(const CompactModel& model, const std::vector<State>& states, const Interruption& interruption) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    interruption.end();
    const std::string warning = warningOfCondition(model, states[i].q);
    if (warning.empty()) continue;
    tool::warning("at sample " + std::to_string(i) + " " + warning);
    return;
  }
}

void run(const Options& o) {
  if (o.states.empty() && o.named.empty()) throw CLI::RequiredError("--states or --q");
  const Model description = o.model.description();
  const CompactModel model = o.model.compile(description);
  const std::vector<State> states = o.states.empty() ? std::vector<State>{namedState(model, description, o.named)}
                                                     : timed("read states from " + o.states, [&] { return readStates(o.states, model); });
  std::set<std::string> only(o.only.begin(), o.only.end());
  for (const std::string& key : only) {
    if (o.contacts.empty() && isKeyOf(contactQuantities(), key))
      throw CLI::ValidationError("--only " + key, "name the contacts, as in --contacts left_sole_link:6d,right_sole_link:6d");
  }
  std::vector<int> frames;
  for (const std::string& name : o.frames) frames.push_back(model.frameId(name));
  Need need = Need::mass_matrix;
  for (const Quantity& quantity : quantities())
    if (only.empty() || only.count(quantity.key)) need = need | quantity.need;
  Data data(model, need);
  ConstraintData contacts(ConstraintSet(model, readContacts(o.contacts)));
  std::string out;
  Json head = describe(model, o.model.root);
  head["samples"] = Json::array();
  print(head, out);
  out.resize(out.size() - 2);  // removes "]}": the samples are printed one by one, and it comes last
  const Interruption interruption;
  {
    Progress progress(static_cast<double>(states.size()), "states");
    for (std::size_t i = 0; i < states.size() && !interruption; ++i) {
      progress.at(static_cast<double>(i));
      const State& s = states[i];
      Json sample = {{"q", flat(s.q)}, {"v", flat(s.v)}, {"a", flat(s.a)}, {"tau", flat(s.tau)}};
      for (const Quantity& quantity : quantities())
        if (only.empty() || only.count(quantity.key)) quantity.write(model, data, s, sample);
      for (const ContactQuantity& quantity : contactQuantities())
        if (!o.contacts.empty() && (only.empty() || only.count(quantity.key))) quantity.write(model, data, contacts, s, sample);
      for (std::size_t f = 0; f < frames.size(); ++f) writeFrame(model, data, s, frames[f], "frame" + std::to_string(f) + "_", sample);
      requireFinite(sample, "sample " + std::to_string(i));
      out += i ? ",\n" : "\n";
      print(sample, out);
    }
  }
  out += "]}\n";
  std::fputs(out.c_str(), stdout);
  interruption.end();
  if (only.empty() || std::any_of(std::begin(by_inverse), std::end(by_inverse), [&](const char* key) { return only.count(key) > 0; }))
    warnOfCondition(model, states, interruption);
  for (const std::string& key : only)
    if (out.find("\"" + key + "_error\"") != std::string::npos) {
      error(key + " does not exist at some samples: it is null there, and " + key + "_error says why");
      throw ExitCode{1};
    }
}

}  // namespace

void addCompute(CLI::App& app) {
  CLI::App* sub = addCommand(app, "compute", "dynamics of given states, as JSON");
  auto o = std::make_shared<Options>();
  o->model.add(*sub);
  sub->add_option("--states", o->states, "JSON file {\"samples\":[{\"q\":[],\"v\":[],\"a\":[],\"tau\":[]}, ...]}, or - for standard input")
      ->type_name("FILE");
  addNamedState(*sub, o->named, "--states");
  std::vector<std::string> keys;
  for (const Quantity& q : quantities()) keys.emplace_back(q.key);
  for (const ContactQuantity& q : contactQuantities()) keys.emplace_back(q.key);
  sub->add_option("--only", o->only, "quantities to compute")->delimiter(',')->check(CLI::IsMember(keys));
  sub->add_option("--frames", o->frames, "frames whose Jacobians are wanted")->delimiter(',');
  sub->add_option("--contacts", o->contacts, "frames that rest on the world, FRAME:6d or FRAME:3d (a point): adds the keys contact_ and impulse_")
      ->delimiter(',');
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
