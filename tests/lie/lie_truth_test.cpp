// SPDX-License-Identifier: BSD-2-Clause
// SO(3) and SE(3) compared with 25-digit references, at angles from 5e-324 to 1e8 and around pi and 2 pi.
#include "errors.hpp"
#include "support/shared.hpp"

#include <dyn/lie/se3.hpp>

#include <iostream>
#include <map>
#include <random>

using namespace dyn;
using namespace dyn::test;
using namespace dyn::tool;

namespace {

Vec3<double> vec3(const nlohmann::json& x) { return {x[0].get<double>(), x[1].get<double>(), x[2].get<double>()}; }
std::vector<double> flat(const Vec3<double>& x) { return {x.x, x.y, x.z}; }
std::vector<double> flat(const Mat3<double>& M) { return {M.m, M.m + 9}; }
std::vector<double> flat(const Quaternion<double>& q) { return {q.x, q.y, q.z, q.w}; }
std::vector<double> flat(const Motion<double>& m) { return {m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z}; }

/// Worst errors by quantity. The destructor prints them if DYN_SHOW_ERRORS is set.
class Worst {
 public:
  ~Worst() {
    if (!std::getenv("DYN_SHOW_ERRORS")) return;
    for (const auto& [key, error] : errors_) std::cout << key << " " << error.first << " u, |w| = " << error.second << "\n";
  }
  void check(const std::string& key, double angle, double error, double bar) {
    if (auto& worst = errors_[key]; error > worst.first) worst = {error, angle};
    INFO(key << " at |w| = " << angle << " is off by " << error << " u, the bar is " << bar << " u");
    CHECK(error <= bar);
  }

 private:
  std::map<std::string, std::pair<double, double>> errors_;
};

/// Returns max |x - x*| / scale, in u.
double absoluteError(const std::vector<double>& x, const std::vector<long double>& truth, long double scale) {
  return scaledError(x, truth, std::vector<long double>(truth.size(), scale));
}

/// Tells whether a case has this value. The reference lacks values that it could not compute (a block at 5e-324, the logarithm where it has two
/// values).
bool given(const nlohmann::json& c, const char* key) {
  return c.contains(key) && c[key].is_array() && std::none_of(c[key].begin(), c[key].end(), [](const nlohmann::json& x) { return x.is_null(); });
}

/// Gives the reference's rotation part the sign of x, because at pi both w and -w are logarithms.
std::vector<long double> nearerSign(std::vector<long double> truth, const std::vector<double>& x, std::size_t rotation) {
  long double product = 0;
  for (std::size_t i = rotation; i < rotation + 3; ++i) product += truth[i] * static_cast<long double>(x[i]);
  if (product < 0)
    for (std::size_t i = rotation; i < rotation + 3; ++i) truth[i] = -truth[i];
  return truth;
}

}  // namespace

TEST_CASE("exponentials, logarithms and their Jacobians are exact to a few roundings at every angle", "[lie]") {
  DYN_NEEDS_SHARED();
  const nlohmann::json cases = readJson(sharedFolder() + "/truth/data/lie.json")["cases"];
  REQUIRE(cases.size() > 300);
  constexpr long double pi = 3.14159265358979323846L;
  Worst worst;
  for (const nlohmann::json& c : cases) {
    const Vec3<double> w = vec3(c["w"]), v = vec3(c["v"]);
    const double angle = c["angle"].get<double>();
    // One rounding of a large |w| causes a large absolute error of the angle.
    const double exp_bar = std::max(4.0, angle / 2 + 3), jacobian_bar = std::max(10.0, angle / 2 + 3);
    worst.check("exp_quat", angle, relativeError(flat(expQuaternion(w)), flatten(c["exp_quat"])), exp_bar);
    worst.check("exp_R", angle, relativeError(flat(exp3(w)), flatten(c["exp_R"])), exp_bar);
    worst.check("exp6_p", angle, relativeError(flat(exp6(Motion<double>{v, w}).p), flatten(c["exp6_p"])), exp_bar);
    worst.check("Jexp3", angle, relativeError(flat(Jexp3(w)), flatten(c["Jexp3"])), jacobian_bar);
    if (given(c, "Jexp6_Q"))
      worst.check("Jexp6_Q", angle, relativeError(flat(Jexp6(Motion<double>{v, w}).upper), flatten(c["Jexp6_Q"])), jacobian_bar);
    // Jlog3 is used at logarithms, which are at most half a turn. Towards 2 pi it grows without bound.
    if (given(c, "Jlog3") && angle < 3.2) worst.check("Jlog3", angle, relativeError(flat(Jlog3(w)), flatten(c["Jlog3"])), 10);

    if (!given(c, "log_quat")) continue;
    const nlohmann::json& q = c["log_in_quat"];
    const Quaternion<double> quaternion = Quaternion<double>{q[0], q[1], q[2], q[3]}.normalized();
    const std::vector<double> log = flat(log3(quaternion));
    const auto log_truth = nearerSign(flatten(c["log_quat"]), log, 0);
    worst.check("log_quat", angle, relativeError(log, log_truth), 4);
    const std::vector<double> log_se3 = flat(log6(log3(quaternion), vec3(c["log_in_p"])));
    const auto se3_truth = nearerSign(flatten(c["log6"]), log_se3, 3);
    worst.check("log6", angle, relativeError(log_se3, se3_truth), 5);
    Mat3<double> R;
    for (int i = 0; i < 9; ++i) R.m[i] = c["log_in_R"][static_cast<std::size_t>(i)].get<double>();
    const std::vector<double> log_matrix = flat(log3(R));
    // Each entry of the given matrix is rounded by half an ulp, up to u/2. So its angle differs by up to about 2 u from the stated logarithm.
    worst.check("log_R", angle,
                absoluteError(log_matrix, nearerSign(flatten(c["log_R"]), log_matrix, 0), std::max(1.0L, std::min<long double>(angle, pi))), 4);
  }
}

TEST_CASE("everything is finite at 2 pi, and exp of a logarithm of a half turn comes back", "[lie]") {
  for (const double angle : {std::nextafter(6.283185307179586, 0), 6.283185307179586, std::nextafter(6.283185307179586, 7), 12.566370614359172}) {
    const Vec3<double> w{0, angle * 0.6, angle * 0.8};
    const Jacobian6<double> J = Jexp6(Motion<double>{{1, 2, 3}, w});
    for (int i = 0; i < 9; ++i) {
      CHECK(std::isfinite(J.diagonal.m[i]));
      CHECK(std::isfinite(J.upper.m[i]));
    }
  }
  const double pi = std::acos(-1.0);
  for (const Vec3<double>& axis :
       {Vec3<double>{1, 0, 0}, Vec3<double>{0, 1, 0}, Vec3<double>{0, 0, -1}, Vec3<double>{0.6, 0, 0.8}, Vec3<double>{2.0 / 3, -1.0 / 3, 2.0 / 3}}) {
    const Mat3<double> R = exp3(pi * axis), back = exp3(log3(R));
    for (int i = 0; i < 9; ++i) {
      const double error = std::fabs(back.m[i] - R.m[i]) * 0x1p53;
      CHECK(error <= 5);
    }
  }
}

TEST_CASE("the Jacobians are the derivatives that dual numbers find", "[lie]") {
  using D = Dual<double>;
  for (const double size : {0.0, 1e-9, 1e-3, 0.4, 1.4, 1.6, 1.99, 2.01, 3.0}) {
    const Vec3<double> w{size * 0.48, size * -0.6, size * 0.64}, direction{0.3, -0.5, 0.8};
    Vec3<D> wd;
    for (int i = 0; i < 3; ++i) wd[i] = D(w[i], direction[i]);
    const Mat3<D> R = exp3(wd);
    Mat3<double> value, rate;
    for (int i = 0; i < 9; ++i) {
      value.m[i] = R.m[i].v;
      rate.m[i] = R.m[i].d;
    }
    const Vec3<double> expected = Jexp3(w) * direction, found = vee(transpose(value) * rate);
    const Vec3<D> log = log3(expQuaternion(wd));
    for (int i = 0; i < 3; ++i) {
      CHECK(found[i] == approx(expected[i]).margin(1e-14));
      CHECK(log[i].v == approx(w[i]).margin(1e-15));
      CHECK(log[i].d == approx(direction[i]).margin(1e-14));
    }
    const Vec3<double> one = Jlog3(w) * expected;
    for (int i = 0; i < 3; ++i) CHECK(one[i] == approx(direction[i]).margin(1e-14));
  }
}

TEMPLATE_TEST_CASE("every scalar has the same functions to its own precision", "[lie]", float, double) {
  using S = TestType;
  const S u = std::numeric_limits<S>::epsilon() / 2;
  for (const double angle : {0.0, 1e-20, 1e-6, 1e-3, 0.1, 1.0, 1.49, 1.51, 1.99, 2.01, 3.0, 3.14}) {
    const Vec3<S> w{static_cast<S>(angle * 0.48), static_cast<S>(angle * -0.6), static_cast<S>(angle * 0.64)};
    const Vec3<long double> wl{w.x, w.y, w.z}, vl{0.3L, -1, 0.5L};
    const Vec3<S> v{static_cast<S>(vl.x), static_cast<S>(vl.y), static_cast<S>(vl.z)};
    const Mat3<S> J = Jexp3(w), inverse = Jlog3(w), Q = Jexp6(Motion<S>{v, w}).upper;
    const Mat3<long double> Jl = Jexp3(wl), inverse_l = Jlog3(wl), Ql = Jexp6(Motion<long double>{{v.x, v.y, v.z}, wl}).upper;
    for (int i = 0; i < 9; ++i) {
      CHECK(std::fabs(static_cast<long double>(J.m[i]) - Jl.m[i]) <= 6 * u);
      CHECK(std::fabs(static_cast<long double>(inverse.m[i]) - inverse_l.m[i]) <= 10 * u);
      CHECK(std::fabs(static_cast<long double>(Q.m[i]) - Ql.m[i]) <= 10 * u);
    }
    const Motion<S> back = log6(exp6(Motion<S>{v, w}));
    for (int i = 0; i < 3; ++i) {
      CHECK(std::fabs(back.angular[i] - w[i]) <= 20 * u);
      CHECK(std::fabs(back.linear[i] - v[i]) <= 20 * u);
    }
  }
}

TEMPLATE_TEST_CASE("a sum of four squares is right to rounding, whatever their sizes and signs", "[lie]", float, double) {
  using S = TestType;
  const long double u = std::numeric_limits<S>::epsilon() / 2;
  std::mt19937 generator(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int k = 0; k < 20000; ++k) {
    S x[4];
    long double sum = 0;
    for (S& c : x) {
      c = static_cast<S>(std::ldexp(uniform(generator), k % 7 == 0 ? -static_cast<int>(generator() % 30) : 0));
      sum += static_cast<long double>(c) * c;
    }
    CHECK(std::fabs(sumOfSquares(x[0], x[1], x[2], x[3]) - sum) <= 1.01L * u * sum);
  }
  CHECK(sumOfSquares(S(0), S(0), S(0), S(0)) == 0);
  CHECK(std::isnan(sumOfSquares(std::numeric_limits<S>::quiet_NaN(), S(0), S(0), S(1))));
}
