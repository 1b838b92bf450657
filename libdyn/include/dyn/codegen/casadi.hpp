// SPDX-License-Identifier: BSD-2-Clause
// Traced functions as CasADi externals. Compile the C source to a shared object and load it with casadi.external("rnea", "./file.so").
#pragma once

#include <dyn/codegen/differentiate.hpp>
#include <dyn/codegen/trace.hpp>

#include <string>
#include <vector>

namespace dyn {

/// Returns C source with the interface of casadi/core/external.hpp (CasADi 3.6) for each function NAME: NAME, NAME_n_in, NAME_n_out, NAME_name_in,
/// NAME_name_out, NAME_sparsity_in, NAME_sparsity_out and NAME_work. With `jacobians` it writes the same for jac_NAME, whose results are the sparse
/// blocks d(output i)/d(input j), output by output, entries column after column. Arguments that CasADi leaves out are zero; results that it leaves
/// out are not written. Throws as writeSource() and, with `jacobians`, as differentiate().
DYN_API std::string writeCasadiSource(const std::vector<TracedFunction>& functions, bool jacobians = true);

/// The blocks of a function's Jacobian, as a function of the same inputs. It has one output per block: the block's entries, column after column.
struct JacobianBlocks {
  TracedFunction function;       ///< named jac_NAME; output jac_OUT_IN has the entries of one block
  std::vector<Sparsity> blocks;  ///< output by output, input by input; entries column after column
};
/// Returns the blocks d(output i)/d(input j) of a function's Jacobian, by forward mode. Throws as differentiate().
DYN_API JacobianBlocks jacobianBlocks(const TracedFunction& function);

}  // namespace dyn
