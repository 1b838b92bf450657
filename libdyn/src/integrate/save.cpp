// A simulation's time, state and step as text: numbers in hexadecimal, which loses nothing and no locale changes.
#include "integrate/simulator_impl.hpp"

#include <dyn/error.hpp>

#include <charconv>
#include <cmath>
#include <sstream>

namespace dyn {

namespace {

constexpr const char* family = "libdyn-simulation-";
constexpr const char* heading = "libdyn-simulation-2";

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

}  // namespace

std::string Simulator::save() const {
  const Impl& x = *impl_;
  std::string out = std::string(heading) + ' ' + infoOf(x.options.integrator).name + '\n' + std::to_string(x.steps) + '\n';
  const auto put = [&](const Eigen::VectorXd& values) {
    out += std::to_string(values.size()) + '\n';
    for (const double value : values) write(out, value);
  };
  for (const double value : {x.options.dt, x.now.time, x.anchor, x.trial}) write(out, value);
  put(x.now.q);
  put(x.now.v);
  // Accelerations that the last step has left are those of its own evaluation, to the last bit.
  out += x.now.has_acceleration ? "1\n" : "0\n";
  if (x.now.has_acceleration) put(x.now.a);
  return out;
}

void Simulator::resume(const std::string& saved) {
  Impl& x = *impl_;
  Reader in(saved);
  const std::string found = in.word("heading");
  if (found != heading) {
    const bool other_version = found.rfind(family, 0) == 0;
    refuseText(other_version ? "it is a '" + found + "', this library reads '" + heading + "'; simulate from the start"
                             : "this is no saved simulation");
  }
  const std::string integrator = in.word("integrator"), own = infoOf(x.options.integrator).name;
  if (integrator != own) refuseText("saved by the integrator '" + integrator + "', this one is '" + own + "'");
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
  in.end();
  x.start(std::move(state));
  x.trial = trial;
  // Whole steps of another length have a grid of their own, from here on.
  if (dt != x.options.dt) return;
  x.anchor = anchor;
  x.steps = steps;
}

}  // namespace dyn
