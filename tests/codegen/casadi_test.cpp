// SPDX-License-Identifier: BSD-2-Clause
// The C interface of casadi.external, called as CasADi calls it.
#include "support/folder.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/codegen/casadi.hpp>
#include <dyn/parsers/urdf.hpp>

#include <dlfcn.h>

using namespace dyn;
using namespace dyn::test;

namespace {

using Int = long long;

/// Compiles C source to a shared object and loads it. The folder is removed with this object.
struct External {
  Folder folder;
  void* handle = nullptr;
  explicit External(const std::string& source) {
    const std::string code = folder.write("external.c", source), object = (folder.path / "external.so").string();
    const std::string command = "cc -std=c99 -O1 -Wall -Werror -shared -fPIC -fvisibility=hidden -o '" + object + "' '" + code + "' -lm";
    REQUIRE(std::system(command.c_str()) == 0);
    handle = dlopen(object.c_str(), RTLD_NOW | RTLD_LOCAL);
    REQUIRE(handle != nullptr);
  }
  ~External() { dlclose(handle); }
  template <class F>
  F* symbol(const std::string& name) const {
    void* found = dlsym(handle, name.c_str());
    INFO(name);
    REQUIRE(found != nullptr);
    return reinterpret_cast<F*>(found);
  }
};

using Evaluate = int(const double** arg, double** res, Int* iw, double* w, int mem);

/// The dense matrix of numbers in CasADi's compressed pattern. The pattern means a dense matrix if its third number is 1.
Eigen::MatrixXd dense(const Int* pattern, const double* numbers) {
  const Int rows = pattern[0], columns = pattern[1];
  if (pattern[2] == 1) return Eigen::Map<const Eigen::MatrixXd>(numbers, rows, columns);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(rows, columns);
  const Int *begin = pattern + 2, *row = begin + columns + 1;
  for (Int c = 0; c < columns; ++c)
    for (Int e = begin[c]; e < begin[c + 1]; ++e) M(row[e], c) = numbers[e];
  return M;
}

}  // namespace

TEST_CASE("rnea as a CasADi external, with its Jacobian", "[codegen]") {
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/arm.urdf"), registry());
  const External external(writeCasadiSource({trace(model, "rnea"), trace(model, "crba")}));
  CHECK(external.symbol<Int()>("rnea_n_in")() == 3);
  CHECK(external.symbol<Int()>("rnea_n_out")() == 1);
  CHECK(std::string(external.symbol<const char*(Int)>("rnea_name_in")(1)) == "v");
  CHECK(std::string(external.symbol<const char*(Int)>("crba_name_out")(0)) == "M");
  const Int* square = external.symbol<const Int*(Int)>("crba_sparsity_out")(0);
  CHECK(square[0] == 7);
  CHECK(square[1] == 7);

  Random random(1);
  const Eigen::VectorXd q = random.vector(7, 2), v = random.vector(7, 1), a = random.vector(7, 2), zero = Eigen::VectorXd::Zero(7);
  Data data(model, Need::derivatives);
  const auto evaluate = [&](const std::string& name, std::vector<const double*> arg, std::vector<double*> res) {
    Int args = 0, results = 0, integers = 0, numbers = 0;
    CHECK(external.symbol<int(Int*, Int*, Int*, Int*)>(name + "_work")(&args, &results, &integers, &numbers) == 0);
    arg.resize(static_cast<std::size_t>(args));
    std::vector<double> work(static_cast<std::size_t>(numbers));
    CHECK(external.symbol<Evaluate>(name)(arg.data(), res.data(), nullptr, work.data(), 0) == 0);
  };
  Eigen::VectorXd tau(7);
  evaluate("rnea", {q.data(), v.data(), a.data()}, {tau.data()});
  CHECK((tau - rnea(model, data, q, v, a)).norm() < 1e-13 * tau.norm());
  evaluate("rnea", {q.data(), nullptr, nullptr}, {tau.data()});
  CHECK((tau - rnea(model, data, q, zero, zero)).norm() < 1e-13 * tau.norm());
  evaluate("rnea", {q.data(), v.data(), a.data()}, {nullptr});

  CHECK(external.symbol<Int()>("jac_rnea_n_in")() == 4);
  CHECK(external.symbol<Int()>("jac_rnea_n_out")() == 3);
  const auto pattern = external.symbol<const Int*(Int)>("jac_rnea_sparsity_out");
  std::vector<std::vector<double>> blocks(3, std::vector<double>(49));
  evaluate("jac_rnea", {q.data(), v.data(), a.data(), nullptr}, {blocks[0].data(), blocks[1].data(), blocks[2].data()});
  const auto expected = computeRNEADerivatives(model, data, q, v, a);
  const Eigen::MatrixXd analytic[] = {expected.dtau_dq, expected.dtau_dv, expected.dtau_da};
  for (Int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    CHECK((dense(pattern(k), blocks[i].data()) - analytic[i]).norm() < 1e-12 * analytic[i].norm());
  }
}
