// SPDX-License-Identifier: BSD-2-Clause
// The file of all results: HDF5, a dataset for each result, samples along the first axis.
#pragma once

#include "histogram.hpp"
#include "store.hpp"
#include "task.hpp"

namespace dyn::tool::sweep {

/// Throws Error(argument) if this program was built without HDF5.
void requireResults();

/// Merges all chunks into results.h5 and failures.jsonl, and counts the numbers of the histograms. Each file is written beside its place and renamed.
/// The bytes do not depend on chunks. Throws Error.
void merge(const Store& store, const Manifest& manifest, const std::vector<Field>& fields, const std::vector<double>& times,
           const Variation& variation, std::vector<Histogram> histograms);

/// Returns a SHA-256 of names, types, shapes and numbers of all datasets. Throws Error(file | syntax).
std::string digestOf(const std::string& file);

}  // namespace dyn::tool::sweep
