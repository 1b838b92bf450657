// SPDX-License-Identifier: BSD-2-Clause
// Support of the tests of dyn sweep: a folder with a study, and skips where dyn cannot sweep.
#pragma once

#include "command.hpp"
#include "support/skip.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A folder with a study of an arm. Its sweeps take a moment, in many chunks.
struct Sweep : Folder {
  Json study = {{"model", DYN_SOURCE_DIR "/models/arm.urdf"},
                {"task", "simulate"},
                {"time", 0.05},
                {"samples", 120},
                {"seed", 7},
                {"chunk", 4},
                {"vary", {{"q", {{"uniform", "limits"}}}, {"v", {{"uniform", {-1, 1}}}}}},
                {"keep", {"final"}}};

  std::string file() const { return write("study.json", study.dump()); }
  std::string out(const std::string& name) const { return (path / name).string(); }
  Answer sweep(const std::string& name, const std::string& options = "") const {
    return run("sweep '" + file() + "' --out '" + out(name) + "' " + options);
  }
  /// Runs a sweep to its end. Returns the digest of its results.
  std::string digest(const std::string& name, const std::string& options = "") const {
    const Answer answer = sweep(name, options);
    INFO(answer.err);
    REQUIRE(answer.code == 0);
    return digestOf(name);
  }
  std::string digestOf(const std::string& name) const {
    const Answer answer = run("sweep --digest '" + out(name) + "'");
    INFO(answer.err);
    REQUIRE(answer.code == 0);
    REQUIRE(answer.out.size() == 65);
    return answer.out;
  }
  Json replay(const std::string& name, int sample) const {
    return Json::parse(run("sweep --replay '" + out(name) + "' " + std::to_string(sample)).out);
  }
  std::size_t chunks(const std::string& name) const {
    std::size_t count = 0;
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(path / name / "chunks", none))
      count += entry.path().filename().string().find(".part") == std::string::npos;
    return count;
  }
};

inline const std::string mpi_environment = "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 ";

/// Runs a line of the shell, as run() does a line of dyn.
inline Answer shell(const std::string& line) {
  const Folder folder;
  const std::string out = (folder.path / "out").string(), err = (folder.path / "err").string();
  const int status = std::system(("( " + line + " ) >'" + out + "' 2>'" + err + "' </dev/null").c_str());
  REQUIRE(WIFEXITED(status));
  return {WEXITSTATUS(status), textOf(out), textOf(err)};
}

inline bool hasResults() { return run("sweep none.json --out /nowhere/at/all").err.find("without HDF5") == std::string::npos; }
inline bool hasRanks() {
  return shell(mpi_environment + "mpirun -n 2 '" DYN_BINARY_DIR "/bin/dyn' sweep none.json --out /nowhere/at/all").err.find("none.json") !=
         std::string::npos;
}

/// The largest difference of two lists of numbers, relative to the largest number.
inline double off(const Json& x, const Json& y) {
  if (x.size() != y.size()) return 1e300;
  double most = 0, scale = 1e-300;
  for (std::size_t k = 0; k < x.size(); ++k) {
    most = std::max(most, std::abs(x[k].get<double>() - y[k].get<double>()));
    scale = std::max(scale, std::abs(y[k].get<double>()));
  }
  return most / scale;
}

#define NEEDS_RESULTS() \
  if (!hasResults()) DYN_SKIP("dyn was built without HDF5 (Debian's libhdf5-dev)")
#define NEEDS_RANKS() \
  NEEDS_RESULTS();    \
  if (!hasRanks()) DYN_SKIP("mpirun is missing, or dyn was built without MPI (Debian's libopenmpi-dev and openmpi-bin)")

}  // namespace dyn::test
