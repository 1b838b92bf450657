// SPDX-License-Identifier: BSD-2-Clause
#include "references.hpp"

#include "exact_quantities.hpp"

namespace dyn::tool {

namespace {

/// The largest nv for which second derivatives are written: they are four tensors of nv^3 numbers.
constexpr int most_with_second = 8;

/// How the numbers under a key are written. Numbers below `noise` times the largest one are noise of differences, and are written as 0.
struct Format {
  int digits;
  double noise;
};
Format formatOf(const std::string& key) {
  if (key.ends_with("_scale")) return {6, 1e-28};                                 // computed in doubles
  if (key.starts_with("d2tau_") || key.starts_with("loop_")) return {20, 1e-20};  // differences of differences
  return {25, 1e-28};
}

/// The numbers of a matrix, row after row, or one array for each row.
Json textsOf(const MatrixR& x, const Format& format, bool nested) {
  Real largest(0);
  for (Eigen::Index k = 0; k < x.size(); ++k) largest = std::max(largest, abs(x[k]));
  const Real noise = std::max(largest * Real(format.noise), Real(1e-30));
  Json out = Json::array();
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < x.cols(); ++j) row.push_back(abs(x(i, j)) < noise ? "0" : x(i, j).text(format.digits));
    if (nested)
      out.push_back(row);
    else
      out.insert(out.end(), row.begin(), row.end());
  }
  return out;
}

void put(const Quantities& quantities, Json& out) {
  for (const auto& [key, value] : quantities) out[key] = textsOf(value, formatOf(key), key == "oMi");  // one pose for each joint
}

/// The last two bodies that move and carry no other.
std::vector<std::size_t> leaves(const ExactBodies& x) {
  std::vector<bool> carries(x.bodies.size());
  for (const ExactBody& body : x.bodies) carries[static_cast<std::size_t>(body.parent)] = true;
  std::vector<std::size_t> out;
  for (std::size_t i = x.bodies.size(); --i > 0 && out.size() < 2;)
    if (!carries[i] && x.bodies[i].moves) out.push_back(i);
  return out;
}

}  // namespace

std::vector<State> referenceStates(const CompactModel& model, int count, std::uint64_t seed) {
  std::vector<State> states = randomStates(model, count, seed);
  for (State& state : states)
    for (Eigen::VectorXd* x : {&state.q, &state.v, &state.a, &state.tau}) *x = x->cast<float>().cast<double>();
  return states;
}

Json referencesOf(const Oracle& oracle, const Model& description, const State& state) {
  const ExactBodies& x = oracle.bodies();
  Json out;
  put(dynamicsOf(x, state, true), out);
  put(jointsOf(x, state), out);
  put(centroidalOf(x, state), out);
  put(regressorsOf(x, state), out);
  put(loopsOf(x, description, state), out);
  if (x.nv <= most_with_second && !x.follows()) put(secondDerivativesOf(x, state), out);
  out["frames"] = Json::array();
  for (const std::size_t body : leaves(x)) {
    Json frame{{"link", x.bodies[body].name}};
    put(frameOf(x, state, body), frame);
    out["frames"].push_back(frame);
  }
  return out;
}

std::string referenceFile(const ReferenceModel& from, const Model& description, const CompactModel& model, const std::vector<State>& states,
                          const std::function<void(std::size_t)>& before) {
  const Oracle oracle(description, model);
  // One line for each quantity, so that changes show where they are.
  const Json head{{"file", from.file}, {"root", from.root}, {"mimic", from.mimic}, {"nq", model.nq()}, {"nv", model.nv()}};
  std::string out = head.dump();
  out.back() = ',';
  out += "\n\"samples\": [";
  for (const State& state : states) {
    before(static_cast<std::size_t>(&state - states.data()));
    out += &state == states.data() ? "\n{" : ",\n{";
    for (const char* argument : {"q", "v", "a", "tau"}) out += '"' + std::string(argument) + "\": " + flat(state.argument(argument)).dump() + ",\n";
    out += "\"truth\": {";
    const char* separator = "\n";
    const Json truth = referencesOf(oracle, description, state);
    for (const auto& [key, value] : truth.items()) {
      out += separator + ('"' + key + "\": ") + value.dump();
      separator = ",\n";
    }
    out += "\n}}";
  }
  return out + "\n]}\n";
}

}  // namespace dyn::tool
