// SPDX-License-Identifier: BSD-2-Clause
// The pairs of geoms that libdyn checks are those between which MuJoCo finds contacts, for files that are read, and for those that libdyn writes.
#include "support/catch.hpp"
#include "support/folder.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/geometry/collision.hpp>
#include <dyn/parsers/mjcf.hpp>

#include <mujoco/mujoco.h>

#include <memory>
#include <random>
#include <set>
#include <sstream>
#include <string>

using namespace dyn;
using namespace dyn::test;

namespace {

using Pairs = std::set<std::pair<std::string, std::string>>;

/// A tree of bodies with several joints, without joints and with free joints. All of its geoms are balls that touch each other. Bodies that are fixed
/// to the world carry no others: MuJoCo checks these against each other, and libdyn does not.
class RandomPairs {
 public:
  explicit RandomPairs(unsigned seed) : random_(seed) {}

  std::string text() {
    out_ << "<mujoco><compiler boundmass=\"1\" boundinertia=\"1\"/><worldbody>\n";
    geom();
    for (int k = 0; k < 3; ++k) body(0);
    out_ << "</worldbody>\n<contact>\n";
    for (int k = 0; k < 2; ++k) out_ << "<exclude body1=\"b" << pick(bodies_) << "\" body2=\"b" << pick(bodies_) << "\"/>\n";
    out_ << "</contact></mujoco>\n";
    return out_.str();
  }

 private:
  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

  void geom() {
    static constexpr int bits[] = {1, 1, 2, 3, 4};
    out_ << "<geom name=\"g" << geoms_++ << "\" size=\"10\" contype=\"" << bits[pick(5)] << "\" conaffinity=\"" << bits[pick(5)] << "\"/>\n";
  }
  void body(int depth) {
    const bool still = depth == 0 && pick(4) == 0;
    out_ << "<body name=\"b" << bodies_++ << "\" pos=\"0." << pick(9) << " 0 0\">";
    if (depth == 0 && !still && pick(3) == 0) {
      out_ << "<freejoint/>";
    } else if (!still) {
      // MuJoCo wants a ball to be the last joint.
      const int joints = depth == 0 ? 1 + pick(2) : pick(4);
      for (int k = 1; k <= joints; ++k)
        out_ << "<joint type=\"" << (k == joints && pick(4) == 0 ? "ball" : pick(2) ? "hinge" : "slide") << "\" pos=\"0 " << pick(2) << " 0\"/>";
    }
    for (int k = pick(3); k > 0; --k) geom();
    for (int k = pick(3); !still && depth < 3 && k > 0; --k) body(depth + 1);
    out_ << "</body>\n";
  }

  std::minstd_rand random_;
  std::ostringstream out_;
  int bodies_ = 0, geoms_ = 0;
};

Pairs checkedByMujoco(const std::string& path) {
  char error[1000] = "";
  const std::unique_ptr<mjModel, void (*)(mjModel*)> m(mj_loadXML(path.c_str(), nullptr, error, sizeof error), mj_deleteModel);
  INFO(error);
  REQUIRE(m);
  m->nconmax = 2000;
  const std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(m.get()), mj_deleteData);
  mj_kinematics(m.get(), d.get());
  mj_comPos(m.get(), d.get());
  mj_collision(m.get(), d.get());
  Pairs out;
  const auto name = [&](int geom) { return std::string(mj_id2name(m.get(), mjOBJ_GEOM, geom)); };
  for (int k = 0; k < d->ncon; ++k) out.insert(std::minmax(name(d->contact[k].geom1), name(d->contact[k].geom2)));
  return out;
}

Pairs checkedByLibdyn(const std::string& path) {
  const Model description = mjcf::load(path);
  const GeometryModel geometry = compileGeometry(compile(description, registry()), description);
  Pairs out;
  for (const CollisionPair& pair : geometry.pairs())
    out.insert(
        std::minmax(geometry.geometries()[static_cast<std::size_t>(pair.a)].name, geometry.geometries()[static_cast<std::size_t>(pair.b)].name));
  return out;
}

}  // namespace

TEST_CASE("MuJoCo finds contacts between the pairs of geoms that libdyn checks, also after writing", "[mjcf]") {
  const Folder folder;
  std::size_t pairs = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    INFO("seed " << seed);
    const std::string path = folder.write("random.xml", RandomPairs(seed).text());
    const Pairs expected = checkedByMujoco(path);
    CHECK(checkedByLibdyn(path) == expected);
    const Written written = mjcf::write(mjcf::load(path));
    for (const std::string& lost : written.lost) CHECK_THAT(lost, !containing("pairs"));
    const std::string again = folder.write("written.xml", written.text);
    CHECK(checkedByLibdyn(again) == expected);
    CHECK(checkedByMujoco(again) == expected);
    pairs += expected.size();
  }
  CHECK(pairs > 1000);
}
