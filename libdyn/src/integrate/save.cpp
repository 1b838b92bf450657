// SPDX-License-Identifier: BSD-2-Clause
// Saves a simulation's time, state and step as text. Numbers are hexadecimal, so they lose nothing and do not depend on the locale.
#include "digest.hpp"
#include "integrate/simulator_impl.hpp"
#include "number_text.hpp"

#include <dyn/error.hpp>

#include <charconv>
#include <cmath>
#include <sstream>

namespace dyn {

namespace {

constexpr const char* family = "libdyn-simulation-";
constexpr const char* heading = "libdyn-simulation-3";

void write(std::string& out, double x) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, x, std::chars_format::hex).ptr;
  out.append(text, end);
  out += '\n';
}

[[noreturn]] void refuseText(const std::string& why) { throw Error(ErrorCode::syntax, "Simulator::resume: " + why); }

class Reader {
 public:
  explicit Reader(const std::string& text) : in_(text) {}
  std::string word(const char* what) {
    std::string x;
    if (!(in_ >> x)) refuseText(std::string("the text ends before its ") + what);
    return x;
  }
  double number(const char* what) {
    const std::string x = word(what);
    double value = 0;
    const auto [end, error] = std::from_chars(x.data(), x.data() + x.size(), value, std::chars_format::hex);
    if (error != std::errc{} || end != x.data() + x.size() || !std::isfinite(value)) refuseText(std::string(what) + ": '" + x + "' is no number");
    return value;
  }
  long count(const char* what) {
    const std::string x = word(what);
    long value = 0;
    const auto [end, error] = std::from_chars(x.data(), x.data() + x.size(), value);
    if (error != std::errc{} || end != x.data() + x.size() || value < 0) refuseText(std::string(what) + ": '" + x + "' is no count");
    return value;
  }
  void vector(const char* what, Eigen::VectorXd& out) {
    const long size = count(what);
    if (size != out.size())
      throw Error(ErrorCode::size,
                  std::string("Simulator::resume: ") + what + " has " + std::to_string(size) + " numbers, the model's " + std::to_string(out.size()));
    for (double& x : out) x = number(what);
  }
  void end() {
    std::string x;
    if (in_ >> x) refuseText("'" + x + "' after the end");
  }

 private:
  std::istringstream in_;
};

/// Returns the digest of everything in the model that determines its motion.
std::string digestOf(const CompactModel& model) {
  const CompactImpl& m = model.impl();
  std::string text;
  const auto put = [&](const double* x, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) write(text, x[k]);
  };
  static_assert(sizeof(BodyConstants<double>) % sizeof(double) == 0);
  for (const JointRecord& joint : m.joints)
    text += joint.name + ' ' + joint.type + ' ' + std::to_string(joint.idx_q) + ' ' + std::to_string(joint.idx_v) + '\n';
  for (const BodyConstants<double>& body : m.constants) put(reinterpret_cast<const double*>(&body), sizeof body / sizeof(double));
  for (const TypeBatch& batch : m.batches) put(batch.constants.data(), batch.constants.size());
  for (const PackedCoupling& coupling : m.couplings) put(coupling.constants.data(), coupling.constants.size());
  for (const std::vector<double>* numbers : {&m.subspaces.vector(), &m.damping, &m.friction, &m.armature, &m.limits.lower, &m.limits.upper})
    put(numbers->data(), numbers->size());
  put(&m.gravity.x, 3);
  return digest(text);
}

constexpr const char* seal = "end ";

/// Returns the text before the last line. Throws Error(syntax) unless the last line holds the digest of that text.
std::string unsealed(const std::string& text) {
  const std::size_t last = text.rfind(seal);
  if (last == std::string::npos || last == 0 || text[last - 1] != '\n') refuseText("it was cut short: its last line is missing");
  std::string body = text.substr(0, last), line = text.substr(last);
  if (line != seal + digest(body) + '\n') refuseText("it was changed or cut short since it was saved: its last line does not fit what is before it");
  return body;
}

}  // namespace

std::string Simulator::save() const {
  const Impl& x = *impl_;
  std::string out = std::string(heading) + ' ' + infoOf(x.options.integrator).name + '\n' + digestOf(model()) + '\n' + std::to_string(x.steps) + '\n';
  const auto put = [&](const Eigen::VectorXd& values) {
    out += std::to_string(values.size()) + '\n';
    for (const double value : values) write(out, value);
  };
  for (const double value : {x.options.dt, x.now.time, x.anchor, x.trial}) write(out, value);
  put(x.now.q);
  put(x.now.v);
  // The accelerations that the last step left are saved, so that the resumed simulation has them to the last bit.
  out += x.now.has_acceleration ? "1\n" : "0\n";
  if (x.now.has_acceleration) put(x.now.a);
  out += x.now_closed ? "1\n" : "0\n";
  return out + seal + digest(out) + '\n';
}

void Simulator::resume(const std::string& saved) {
  const Work work(*impl_, "Simulator::resume");
  Impl& x = *impl_;
  const std::string found = Reader(saved).word("heading");
  if (found != heading) {
    const bool other_version = found.rfind(family, 0) == 0;
    refuseText(other_version ? "it is a '" + found + "', this library reads '" + heading + "'; simulate from the start"
                             : "this is no saved simulation");
  }
  const std::string text = unsealed(saved);
  Reader in(text);
  in.word("heading");
  const std::string integrator = in.word("integrator"), own = infoOf(x.options.integrator).name;
  if (integrator != own) refuseText("saved by the integrator '" + integrator + "', this one is '" + own + "'");
  const std::string saved_model = in.word("model");
  const long steps = in.count("number of steps");
  const double dt = in.number("dt");
  Moment state(model());
  state.time = in.number("time");
  const double anchor = in.number("first time"), trial = in.number("step");
  if (!(trial > 0)) refuseText("its step is not positive");
  in.vector("q", state.q);
  in.vector("v", state.v);
  const long known = in.count("accelerations");
  if (known > 1) refuseText("accelerations are there or not, 1 or 0");
  state.has_acceleration = known == 1;
  if (state.has_acceleration) in.vector("a", state.a);
  const long closed = in.count("projection");
  if (closed > 1) refuseText("what it moves has been projected or not, 1 or 0");
  in.end();
  if (saved_model != digestOf(model()))
    throw Error(ErrorCode::argument, "Simulator::resume: it was saved of another model, or of this one with other numbers; simulate from the start");
  if (!infoOf(x.options.integrator).adaptive && !(std::abs(anchor + static_cast<double>(steps) * dt - state.time) <= Impl::slack * dt))
    refuseText("its time is not where " + std::to_string(steps) + " steps of " + dyn::number(dt) + " s from " + dyn::number(anchor) + " s lead");
  x.start(std::move(state));
  x.trial = trial;
  x.now_closed = closed == 1;
  // With another dt, whole steps are counted from here.
  if (dt != x.options.dt) return;
  x.anchor = anchor;
  x.steps = steps;
}

}  // namespace dyn
