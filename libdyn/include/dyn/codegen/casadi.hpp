// Traced functions as CasADi externals: C source that, compiled to a shared object, casadi.external("rnea", "./file.so") loads.
#pragma once

#include <dyn/codegen/differentiate.hpp>
#include <dyn/codegen/trace.hpp>

#include <string>
#include <vector>

namespace dyn {

/// For each function NAME the interface of casadi/core/external.hpp (CasADi 3.6): NAME, NAME_n_in, NAME_n_out, NAME_name_in, NAME_name_out,
/// NAME_sparsity_in, NAME_sparsity_out, NAME_work; and with jacobians jac_NAME with the same, whose results are the blocks d(output i)/d(input j),
/// in that order, sparse, by columns. Arguments that CasADi leaves out are zero, results that it leaves out are not written. Throws as
/// writeSource().
DYN_API std::string writeCasadiSource(const std::vector<TracedFunction>& functions, bool jacobians = true);

/// The blocks of a function's Jacobian as a function of the same inputs: outputs are the entries of each block, column after column.
struct JacobianBlocks {
  TracedFunction function;
  std::vector<Sparsity> blocks;  ///< output by output, input by input; entries column after column
};
DYN_API JacobianBlocks jacobianBlocks(const TracedFunction& function);

}  // namespace dyn
