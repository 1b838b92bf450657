// SPDX-License-Identifier: BSD-2-Clause
// libdyn's MJCF reader and writer compared with MuJoCo itself, which shares no code with them: poses, sites, mass matrix, bias forces and gravity.
#include "support/folder.hpp"
#include "support/random_mjcf.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"
#include "support/skip.hpp"

#include <dyn/dyn.hpp>
#include <dyn/file.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn/parsers/load.hpp>
#include <dyn/parsers/mjcf.hpp>
#include <dyn/spatial/eigen.hpp>

#include <Eigen/Geometry>

#include <mujoco/mujoco.h>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <memory>
#include <unordered_map>

using namespace dyn;
using namespace dyn::test;

namespace {

using MjModel = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using MjData = std::unique_ptr<mjData, void (*)(mjData*)>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The largest differences, relative to the largest entry of each quantity.
struct Differences {
  int nq = 0, nv = 0, bodies = 0;
  double inertias = 0;  ///< of single bodies: mass, centre of mass, rotational inertia
  double poses = 0, mass = 0, bias = 0, gravity = 0;
  double worst() const { return std::max({poses, mass, bias, gravity}); }
};

MjModel loadMujoco(const std::string& path, std::string& why) {
  char error[1000] = "";
  MjModel model(mj_loadXML(path.c_str(), nullptr, error, sizeof error), mj_deleteModel);
  why = error;
  return model;
}

double relative(const Eigen::MatrixXd& x, const Eigen::MatrixXd& expected) {
  if (x.size() == 0) return 0;
  return (x - expected).cwiseAbs().maxCoeff() / std::max(1e-300, expected.cwiseAbs().maxCoeff());
}

/// MuJoCo's joints in order, with the places of their numbers. libdyn's are the same, but quaternions are x, y, z, w and a free joint's velocity is
/// in the body's axes.
class Translation {
 public:
  Translation(const mjModel& m, const Eigen::VectorXd& qpos) : m_(m), T(Eigen::MatrixXd::Identity(m.nv, m.nv)), q(qpos) {
    for (int j = 0; j < m.njnt; ++j) {
      const int a = m.jnt_qposadr[j], type = m.jnt_type[j], quaternion = type == mjJNT_FREE ? a + 3 : (type == mjJNT_BALL ? a : -1);
      if (quaternion < 0) continue;
      q.segment(quaternion, 3) = qpos.segment(quaternion + 1, 3);
      q[quaternion + 3] = qpos[quaternion];
      if (type == mjJNT_FREE) T.block(m.jnt_dofadr[j], m.jnt_dofadr[j], 3, 3) = rotation(quaternion).transpose();
    }
  }
  /// Accelerations in libdyn's coordinates while MuJoCo's are zero: those of the turning axes in which a free joint's velocity is given.
  Eigen::VectorXd stillAcceleration(const Eigen::VectorXd& v) const {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(m_.nv);
    for (int j = 0; j < m_.njnt; ++j)
      if (m_.jnt_type[j] == mjJNT_FREE) {
        const int d = m_.jnt_dofadr[j];
        const Eigen::Vector3d w = v.segment<3>(d + 3), u = v.segment<3>(d);
        a.segment<3>(d) = -w.cross(u);
      }
    return a;
  }

 private:
  Eigen::Matrix3d rotation(int at) const { return Eigen::Quaterniond(q[at + 3], q[at], q[at + 1], q[at + 2]).normalized().toRotationMatrix(); }
  const mjModel& m_;

 public:
  Eigen::MatrixXd T;  ///< maps MuJoCo's velocities to libdyn's
  Eigen::VectorXd q;  ///< libdyn's coordinates
};

Eigen::MatrixXd symmetric(const double* M, int n) {
  const Eigen::MatrixXd full = Eigen::Map<const Eigen::MatrixXd>(M, n, n);
  return full.selfadjointView<Eigen::Upper>();
}

std::string nameOf(const mjModel& m, int body) {
  const char* name = mj_id2name(&m, mjOBJ_BODY, body);
  return name && *name ? name : "body_" + std::to_string(body);
}

/// Returns the inertia of one body in MuJoCo.
Inertia<double> inertiaOf(const mjModel& m, int body) {
  Inertia<double> Y;
  const double *I = m.body_inertia + 3 * body, *q = m.body_iquat + 4 * body, *p = m.body_ipos + 3 * body;
  Y.mass = m.body_mass[body];
  Y.rotational = {I[0], 0, 0, I[1], 0, I[2]};
  return Y.transformed({Quaternion<double>{q[1], q[2], q[3], q[0]}.matrix(), {p[0], p[1], p[2]}});
}

/// Returns the difference of two inertias, and replaces the first by the second.
double exchange(Inertia<double>& ours, const Inertia<double>& theirs) {
  const Eigen::Matrix3d I = toEigen(ours.rotational), J = toEigen(theirs.rotational);
  const double radius = std::sqrt(J.cwiseAbs().maxCoeff() / std::max(1e-300, theirs.mass));
  const double out = std::max({std::fabs(ours.mass - theirs.mass) / std::max(1e-300, theirs.mass), relative(I, J),
                               (toEigen(ours.com) - toEigen(theirs.com)).norm() / std::max(radius, toEigen(theirs.com).norm())});
  ours = theirs;
  return theirs.mass > 0 ? out : 0;
}

/// Compares inertias, and all else at random states with MuJoCo's inertias. Throws Error where libdyn does not read the file.
Differences compare(const std::string& path, const mjModel& m) {
  Model description = mjcf::load(path);
  std::unordered_map<std::string, std::size_t> bodies;
  for (std::size_t i = 0; i < description.bodies.size(); ++i) bodies.emplace(description.bodies[i].name, i);
  double inertias = 0;
  for (int b = 1; b < m.nbody; ++b) inertias = std::max(inertias, exchange(description.bodies[bodies.at(nameOf(m, b))].inertia, inertiaOf(m, b)));
  CompileOptions options;
  options.dissipation = false;
  const CompactModel model = compile(description, registry(), options);
  // MuJoCo's bias forces know nothing of armature, which a free joint's turning axes would bring in.
  options.armature = false;
  const CompactModel bare = compile(description, registry(), options);
  Differences out{model.nq(), model.nv(), m.nbody - 1, inertias};
  REQUIRE(model.nq() == m.nq);
  REQUIRE(model.nv() == m.nv);
  Data data(model, Need::mass_matrix), bare_data(bare);
  const MjData d(mj_makeData(&m), mj_deleteData);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int states = m.nv > 200 ? 1 : 5;
  for (int state = 0; state < states; ++state) {
    Eigen::VectorXd qpos(m.nq), qvel(m.nv);
    for (int i = 0; i < m.nq; ++i) qpos[i] = uniform(random);
    for (int i = 0; i < m.nv; ++i) qvel[i] = uniform(random);
    mj_normalizeQuat(&m, qpos.data());
    std::copy_n(qpos.data(), m.nq, d->qpos);
    std::copy_n(qvel.data(), m.nv, d->qvel);
    mj_kinematics(&m, d.get());
    mj_comPos(&m, d.get());
    mj_crb(&m, d.get());
    mj_comVel(&m, d.get());
    Eigen::VectorXd bias(m.nv), gravity(m.nv);
    mj_rne(&m, d.get(), 0, bias.data());
    Rows M(m.nv, m.nv);
    mj_fullM(&m, M.data(), d->qM);
    std::fill_n(d->qvel, m.nv, 0.0);
    mj_comVel(&m, d.get());
    mj_rne(&m, d.get(), 0, gravity.data());

    const Translation to(m, qpos);
    forwardKinematics(model, data, to.q);
    double size = 1;
    for (int i = 0; i < 3 * m.nbody; ++i) size = std::max(size, std::fabs(d->xpos[i]));
    for (int b = 1; b < m.nbody; ++b) {
      const SE3<double> X = framePlacement(model, data, model.frameId(nameOf(m, b)));
      for (int i = 0; i < 3; ++i) out.poses = std::max(out.poses, std::fabs(X.p[i] - d->xpos[3 * b + i]) / size);
      for (int i = 0; i < 9; ++i) out.poses = std::max(out.poses, std::fabs(X.R.m[i] - d->xmat[9 * b + i]));
    }
    for (int s = 0; s < m.nsite; ++s) {
      const char* name = mj_id2name(&m, mjOBJ_SITE, s);
      const int frame = name && *name ? model.findFrame(name) : -1;
      // A site may be called as a body is; its frame then has another name.
      if (frame < 0 || description.findBody(name) >= 0) continue;
      const SE3<double> X = framePlacement(model, data, frame);
      for (int i = 0; i < 3; ++i) out.poses = std::max(out.poses, std::fabs(X.p[i] - d->site_xpos[3 * s + i]) / size);
      for (int i = 0; i < 9; ++i) out.poses = std::max(out.poses, std::fabs(X.R.m[i] - d->site_xmat[9 * s + i]));
    }
    const Eigen::VectorXd v = to.T * qvel;
    out.mass = std::max(out.mass, relative(to.T.transpose() * symmetric(crba(model, data, to.q).data(), m.nv) * to.T, M));
    const Eigen::VectorXd tau = rnea(bare, bare_data, to.q, v, to.stillAcceleration(v));
    out.bias = std::max(out.bias, relative(to.T.transpose() * tau, bias));
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(m.nv), g = rnea(bare, bare_data, to.q, zero, zero);
    if (gravity.cwiseAbs().maxCoeff() > 0) out.gravity = std::max(out.gravity, relative(to.T.transpose() * g, gravity));
  }
  return out;
}

Differences larger(const Differences& a, const Differences& b) {
  return {std::max(a.nq, b.nq),       std::max(a.nv, b.nv),     std::max(a.bodies, b.bodies), std::max(a.inertias, b.inertias),
          std::max(a.poses, b.poses), std::max(a.mass, b.mass), std::max(a.bias, b.bias),     std::max(a.gravity, b.gravity)};
}

/// Writes a model as MJCF. Efforts are left out, because MuJoCo 2.2.2 does not know actuatorfrcrange.
Written written(Model description) {
  for (BodyDescription& body : description.bodies) body.joint.limits.effort.clear();
  return mjcf::write(description);
}

/// Compares what MuJoCo and libdyn make of the MJCF that libdyn writes.
Differences compareWritten(const Model& description, const Folder& folder) {
  const std::string path = folder.write("written.xml", written(description).text);
  std::string why;
  const MjModel m = loadMujoco(path, why);
  INFO(why);
  REQUIRE(m);
  CHECK(m->nexclude == static_cast<int>(description.disabled_collisions.size()));
  CHECK(m->neq >= static_cast<int>(description.constraints.size()));
  CHECK(m->nkey >= static_cast<int>(description.configurations.size()) - 1);  // qpos0 is in the poses of bodies
  return compare(path, *m);
}

void printHead() {
  std::cout << std::left << std::setw(34) << "model" << std::right << std::setw(7) << "bodies" << std::setw(6) << "nq" << std::setw(6) << "nv"
            << std::setw(10) << "inertias" << std::setw(10) << "poses" << std::setw(10) << "M" << std::setw(10) << "bias" << std::setw(10)
            << "gravity"
            << "  remark\n";
}

void printRow(const std::string& name, const Differences& d, const std::string& remark) {
  std::cout << std::left << std::setw(34) << name << std::right << std::setw(7) << d.bodies << std::setw(6) << d.nq << std::setw(6) << d.nv
            << std::scientific << std::setprecision(1) << std::setw(10) << d.inertias << std::setw(10) << d.poses << std::setw(10) << d.mass
            << std::setw(10) << d.bias << std::setw(10) << d.gravity << std::defaultfloat << "  " << remark << "\n";
}

const char* samples = "/usr/share/mujoco/model";
const char* inexact_axes = "MuJoCo's principal axes of several geoms are exact to 1.4e-6 rad";

}  // namespace

TEST_CASE("models of MuJoCo's samples have MuJoCo's poses, mass matrix, bias forces and gravity", "[mjcf]") {
  namespace fs = std::filesystem;
  if (!fs::is_directory(samples)) DYN_SKIP("the models of libmujoco-samples are not installed");
  std::vector<std::string> paths;
  for (const fs::directory_entry& e : fs::recursive_directory_iterator(samples))
    if (e.path().extension() == ".xml") paths.push_back(e.path().string());
  std::sort(paths.begin(), paths.end());
  const Folder folder;
  printHead();
  int compared = 0;
  for (const std::string& path : paths) {
    INFO(path);
    std::string why;
    const MjModel m = loadMujoco(path, why);
    const std::string name = fs::relative(path, samples).string();
    // Parts that others include are no models by themselves.
    if (!m || m->nv == 0) continue;
    std::string file = path, remark;
    const std::vector<Error> errors = mjcf::check(path);
    if (!errors.empty()) {
      // Composites make bodies. MuJoCo saves the model with all of them listed.
      REQUIRE_THAT(errors[0].what(), containing("<composite> makes bodies"));
      const fs::path copy = folder.path / std::to_string(compared);
      fs::copy(fs::path(path).parent_path(), copy, fs::copy_options::recursive);
      file = (copy / "saved.xml").string();
      char error[1000] = "";
      REQUIRE(mj_saveLastXML(file.c_str(), m.get(), error, sizeof error) == 1);
      remark = "composite, compared as MuJoCo saves it";
    }
    if (m->nmesh > 0) {
      const fs::path copy = folder.path / std::to_string(compared);
      fs::copy(fs::path(path).parent_path(), copy, fs::copy_options::recursive);
      file = (copy / "exact.xml").string();
      std::string text = readFile(path);
      text.insert(text.find("<asset>"), "<compiler exactmeshinertia=\"true\"/>");
      std::ofstream(file) << text;
      remark = "with exactmeshinertia, since MuJoCo 2.2.2 takes the volume of a mesh's inertia box; MuJoCo rounds its vertices to single precision";
    }
    const MjModel again = loadMujoco(file, why);
    INFO(why);
    REQUIRE(again);
    const Differences d = compare(file, *again);
    // Inertias of bodies with several geoms are diagonalised.
    bool diagonalised = false;
    for (int b = 1; b < again->nbody; ++b) diagonalised = diagonalised || again->body_geomnum[b] > 1;
    if (diagonalised && d.inertias >= 1e-12) remark += std::string(remark.empty() ? "" : "; ") + inexact_axes;
    printRow(name, d, remark);
    CHECK(d.worst() < 1e-12);
    CHECK(d.inertias < (diagonalised || again->nmesh > 0 ? 2e-6 : 1e-12));
    ++compared;
  }
  CHECK(compared >= 12);
}

TEST_CASE("random models have MuJoCo's inertias, poses, mass matrix, bias forces and gravity", "[mjcf]") {
  const Folder folder;
  printHead();
  for (const bool diagonalised : {false, true}) {
    Differences worst;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      INFO("seed " << seed << (diagonalised ? ", bodies of several geoms" : ""));
      const std::string path = folder.write("random.xml", RandomMjcf(seed, diagonalised).text());
      std::string why;
      const MjModel m = loadMujoco(path, why);
      INFO(why);
      REQUIRE(m);
      const Differences d = compare(path, *m);
      INFO("inertias " << d.inertias << ", poses " << d.poses << ", M " << d.mass << ", bias " << d.bias << ", gravity " << d.gravity);
      CHECK(d.worst() < 1e-12);
      CHECK(d.inertias < (diagonalised ? 2e-6 : 1e-12));
      worst = larger(worst, d);
    }
    printRow(diagonalised ? "100 random, several geoms a body" : "100 random, one geom a body", worst, diagonalised ? inexact_axes : "");
  }
}

TEST_CASE("MuJoCo reads what libdyn writes, and sees the same model", "[mjcf]") {
  const Folder folder;
  printHead();
  Differences worst;
  // MuJoCo stores inertias by their principal axes, which it finds to 1.4e-6 rad.
  constexpr double inertias = 2e-6;
  for (unsigned seed = 0; seed < 40; ++seed) {
    INFO("seed " << seed);
    Model model = treeOf(registry(), {"revolute", "spherical", "prismatic", "universal", "translation", "spherical_zyx", "cylindrical"}, 12, seed);
    if (seed % 2) {
      model.bodies[1].joint.type = "free_flyer";
      model.bodies[1].joint.parameters.clear();
      model.bodies[1].joint.armature.clear();
    }
    model.addFrame("tool", 7, Random(seed).pose());
    model.constraints = {coupleJoint("j7", {"mimic", "j2", {{"coefficients", std::vector<double>{0.1, 2, 3}}}}), lockJoint("j9", {0.3})};
    model.constraints[0].baumgarte = {100, 20};
    model.configurations = {{.name = "home", .joints = {{"j1", {0, 0.6, 0, 0.8}, {1, 2, 3}}}}, {.name = "zero"}};
    model.addGeometry("hull", 3, Random(seed).pose(), geometry::ConvexHull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    model.addGeometry("ground", 0, Random(seed).pose(), geometry::HalfSpace{});
    model.disabled_collisions = {{"b0", "b2", ""}};
    const Differences d = compareWritten(model, folder);
    CHECK(d.worst() < 1e-12);
    CHECK(d.inertias < inertias);
    worst = larger(worst, d);
  }
  printRow("40 random trees, written", worst, inexact_axes);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    INFO("seed " << seed);
    const Differences d = compareWritten(mjcf::parse(RandomMjcf(seed).text(), "random.xml"), folder);
    CHECK(d.worst() < 1e-12);
    CHECK(d.inertias < inertias);
    worst = larger(worst, d);
  }
  printRow("20 random MJCF, read and written", worst, inexact_axes);
}

TEST_CASE("MuJoCo reads real robots that libdyn writes, unless the report says that it refuses them", "[mjcf]") {
  DYN_NEEDS_SHARED();
  const Folder folder;
  printHead();
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sharedFolder() + "/models")) {
    if (entry.path().extension() != ".urdf") continue;
    const std::string name = entry.path().filename().string();
    INFO(name);
    Model model = load(entry.path().string(), {.root = "free_flyer", .continuous = Continuous::angle, .inertias = Inertias::any});
    model.geometries.clear();  // their files are not there
    const std::vector<std::string> lost = written(model).lost;
    const auto refused =
        std::find_if(lost.begin(), lost.end(), [](const std::string& line) { return line.find("MuJoCo refuses") != std::string::npos; });
    if (refused != lost.end()) {
      std::string why;
      CHECK_FALSE(loadMujoco(folder.write("refused.xml", written(model).text), why));
      std::cout << name << ": not compared: " << *refused << "\n";
      continue;
    }
    const Differences d = compareWritten(model, folder);
    printRow(name, d, d.inertias >= 1e-12 ? inexact_axes : "");
    CHECK(d.worst() < 1e-12);
    CHECK(d.inertias < 2e-6);
    ++compared;
  }
  CHECK(compared >= 8);
}
