// SPDX-License-Identifier: BSD-2-Clause
// Checks a coupling's derivatives against finite differences.
#include "compile/parameters.hpp"
#include "conformance/support.hpp"

namespace dyn {

std::vector<ConformanceFinding> checkCouplingType(const CouplingType& type, const Parameters& example, std::uint64_t seed,
                                                  const AllocationCount& allocations) {
  using namespace conformance;
  Findings findings;
  guarded("parameters", findings, [&] {
    const CheckedParameters checked = checkParameters(example, type.info(), {});
    const std::vector<ParameterArgument> arguments = checked.arguments();
    char message[256] = "";
    int count = 0;
    if (!type.prepare(arguments.data(), count, message, sizeof message)) throw Error(ErrorCode::parameter, std::string("refused: ") + message);
    if (count < 0) throw Error(ErrorCode::parameter, "its number of constants is negative");
    std::vector<double> constants(static_cast<std::size_t>(count));
    type.constants(arguments.data(), constants.data());
    findings.push_back({"parameters are accepted", true, 0, 0, std::to_string(count) + " constants"});

    const auto evaluate = [&](double x) {
      Eigen::Vector4d f;
      type.evaluate(constants.data(), count, x, f.data());
      return f;
    };
    Random random(seed);
    Worst first("f' is the derivative of f", 1e-8), second("f'' is the derivative of f'", 1e-8), third("f''' is the derivative of f''", 1e-8);
    for (int i = 0; i < 16; ++i) {
      const double x = random.uniform(-2, 2);
      const std::string where = "x = " + std::to_string(x);
      const Eigen::Vector4d f = evaluate(x);
      const Eigen::VectorXd rates = derivativeAtZero([&](double h) { return Eigen::VectorXd(evaluate(x + h).head(3)); });
      first.compare(f.segment(1, 1), rates.segment(0, 1), where);
      second.compare(f.segment(2, 1), rates.segment(1, 1), where);
      third.compare(f.segment(3, 1), rates.segment(2, 1), where);
    }
    first.into(findings);
    second.into(findings);
    third.into(findings);
    if (allocations) {
      const long before = allocations();
      double f[4];
      type.evaluate(constants.data(), count, 0.5, f);
      const long made = allocations() - before;
      findings.push_back({"no allocation", made == 0, static_cast<double>(made), 0, made == 0 ? "" : "heap allocations in one call"});
    }
  });
  return findings;
}

}  // namespace dyn
