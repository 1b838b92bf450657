// SPDX-License-Identifier: BSD-2-Clause
// The project's own references can be made again.
#include "references.hpp"

#include "truth/data_sets.hpp"

#include <dyn/file.hpp>

using namespace dyn;
using namespace dyn::test;

TEST_CASE("the references are what the definitions give, byte for byte", "[oracle]") {
  for (const std::string& name : ownSets()) {
    const Set set = load(name);
    if (set.model.nv() > 8) continue;  // larger models take minutes in debug builds; tools/nightly makes them again
    const std::string path = DYN_SOURCE_DIR "/tests/truth/" + name + ".json";
    const auto samples = readSamples(path, set.model);
    std::string again =
        referenceFile({set.document["file"], set.document["root"], set.document["mimic"]}, set.description, set.model, {samples.at(0).first});
    again.resize(again.size() - 4);  // a file of more samples goes on after the first
    INFO(name << ": run tools/references");
    CHECK(readFile(path).starts_with(again));
  }
}
