// SPDX-License-Identifier: BSD-2-Clause
// Files of references: results of every algorithm at a few states of one model, with 25 of fifty digits, or 20 where differences leave 24 or fewer.
#pragma once

#include "oracle.hpp"

#include <functional>
#include <string>
#include <vector>

namespace dyn::tool {

/// The model of a set, as `urdf::load` reads it.
struct ReferenceModel {
  std::string file;  ///< as written to the set
  std::string root = "fixed", mimic = "independent";
};

/// Random states whose numbers are floats, so that computations in single precision start from the same states.
std::vector<State> referenceStates(const CompactModel& model, int count, std::uint64_t seed);

/// Every result of one state, as an entry of "truth" in a truth file: numbers are texts, matrices are row after row.
Json referencesOf(const Oracle& oracle, const Model& description, const State& state);

/// A truth file with these states. Equal states and descriptions give equal texts: the digits come from operations on integers, except the six of
/// scales. Calls `before` with the index of each state before its results are computed; an exception from there ends the work.
std::string referenceFile(
    const ReferenceModel& from, const Model& description, const CompactModel& model, const std::vector<State>& states,
    const std::function<void(std::size_t)>& before = [](std::size_t) {});

}  // namespace dyn::tool
