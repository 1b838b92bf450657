// SPDX-License-Identifier: BSD-2-Clause
// The Delassus matrix computed in three ways, and loops read from files.
#include "constraint/support.hpp"

#include <dyn/parsers/urdf.hpp>

#include <Eigen/Cholesky>

using namespace dyn;
using namespace dyn::test;

namespace {
double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff()); }

Model fourBar() { return urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"); }

std::string refusalOf(const std::string& text) {
  std::string body =
      R"(<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>)";
  try {
    urdf::parse(body + text + "</robot>", "file.urdf");
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}
}  // namespace

TEST_CASE("the Delassus matrix is J M^-1 J^T, formed or not", "[constraint]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 15)));
  Subject s = randomScene(seed, 10, 3);
  s.constraints.push_back(lockJoint(s.model.joints()[2].name));
  Data data(s.model, Need::derivatives);
  ConstraintData c(ConstraintSet(s.model, s.constraints));
  const Eigen::MatrixXd J = computeConstraintJacobian(s.model, data, s.q, c);
  const Eigen::MatrixXd wanted = J * crba(s.model, data, s.q).ldlt().solve(J.transpose());
  const Eigen::MatrixXd D = computeDelassusMatrix(s.model, data, s.q, c);
  CHECK(distance(D, wanted) <= 1e-11);
  CHECK(D == D.transpose());
  const DelassusOperator product(s.model, data, s.q, c);
  Random random(seed);
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd x = random.vector(J.rows(), 1);
    Eigen::VectorXd out(J.rows());
    product.apply(x, out);
    CHECK(distance(out, D * x) <= 1e-12);
    out = x;
    product.apply(out, out);
    CHECK(distance(out, D * x) <= 1e-12);
  }
  const Eigen::MatrixXd inertia = computeOperationalSpaceInertia(s.model, data, s.q, c);
  CHECK(distance(D * inertia * D, D) <= 1e-8);
  CHECK(distance(inertia * D * inertia, inertia) <= 1e-8);
}

TEST_CASE("a model with followers has the same", "[constraint]") {
  Model description = randomTree(registry(), 20, 5);
  addDependent(description);
  const CompactModel model = compile(description, registry());
  Data data(model, Need::derivatives);
  ConstraintData c(ConstraintSet(model, {frameContact("tool"), pointContact("followed")}));
  const Eigen::VectorXd q = integrate(model, neutral(model), Random(3).vector(model.nv(), 1));
  const Eigen::MatrixXd J = computeConstraintJacobian(model, data, q, c);
  Eigen::MatrixXd frame(6, model.nv());
  computeFrameJacobian(model, data, q, model.frameId("tool"), ReferenceFrame::LOCAL, frame);
  CHECK(distance(J.topRows(6), frame) <= 1e-12);
  computeFrameJacobian(model, data, q, model.frameId("followed"), ReferenceFrame::LOCAL, frame);
  CHECK(distance(J.bottomRows(3), frame.topRows(3)) <= 1e-12);
  const Eigen::MatrixXd wanted = J * crba(model, data, q).ldlt().solve(J.transpose());
  CHECK(distance(computeDelassusMatrix(model, data, q, c), wanted) <= 1e-11);
  const DelassusOperator product(model, data, q, c);
  const Eigen::VectorXd x = Random(4).vector(9, 1);
  Eigen::VectorXd out(9);
  product.apply(x, out);
  CHECK(distance(out, wanted * x) <= 1e-11);
}

TEST_CASE("loops of a file close, turn and keep closed", "[constraint]") {
  const CompactModel model = compile(fourBar(), registry());
  const ConstraintSet set(model);
  REQUIRE(set.count() == 1);
  CHECK(set.rows() == 5);
  Data data(model, Need::derivatives);
  ConstraintData c(set);
  Eigen::VectorXd q = neutral(model);
  assemble(model, data, q, c);
  CHECK(computeConstraintMotion(model, data, q, Eigen::VectorXd::Zero(model.nv()), c).error.cwiseAbs().maxCoeff() <= 1e-15);
  // The loop has five rows, of which two are independent in a planar mechanism. One of three degrees of freedom remains.
  const ConstrainedMotion x = constraintDynamics(model, data, q, Eigen::VectorXd::Zero(model.nv()), Eigen::VectorXd::Zero(model.nv()), c);
  CHECK(x.rank == 2);
  CHECK(x.residual <= 1e-12);
  Eigen::VectorXd v = Eigen::VectorXd::Ones(model.nv());
  v = projectVelocity(model, data, q, v, c);
  CHECK(computeConstraintMotion(model, data, q, v, c).velocity.cwiseAbs().maxCoeff() <= 1e-15);
  CHECK(v.norm() > 0.1);
}

TEST_CASE("loops and gears of a file are refused with their line", "[constraint]") {
  CHECK_THAT(refusalOf(R"(<libdyn><loop name="l" link="c"/></libdyn>)"), containing("names link 'c'"));
  CHECK_THAT(refusalOf(R"(<libdyn><loop name="l" link="b" other="c"/></libdyn>)"), containing("names link 'c'"));
  CHECK_THAT(refusalOf(R"(<libdyn><loop name="l" link="b" free="up"/></libdyn>)"), containing("\"up\" is no direction"));
  CHECK_THAT(refusalOf(R"(<libdyn><loop link="b"/></libdyn>)"), containing("name"));
  CHECK_THAT(refusalOf(R"(<libdyn><gear joint="j" type="mimic" master="k"/></libdyn>)"), containing("names joint 'k'"));
  CHECK_THAT(refusalOf(R"(<libdyn><loops/></libdyn>)"), containing("it has <joint>, <loop> and <gear>"));
  CHECK(refusalOf(
            R"(<libdyn><loop name="l" link="b" xyz="1 0 0" other_xyz="1 0 0" free="rx ry rz" position_gain="100" velocity_gain="20"/></libdyn>)") ==
        "accepted");
}

TEST_CASE("models with loops are appended with them", "[constraint]") {
  Model two = fourBar();
  two = append(two, fourBar(), "base", SE3<double>{Mat3<double>::identity(), {0, 1, 0}}, "second_");
  const CompactModel model = compile(two, registry());
  CHECK(ConstraintSet(model).rows() == 10);
  Data data(model, Need::derivatives);
  ConstraintData c((ConstraintSet(model)));
  Eigen::VectorXd q = neutral(model);
  assemble(model, data, q, c);
  CHECK(computeConstraintMotion(model, data, q, Eigen::VectorXd::Zero(model.nv()), c).error.cwiseAbs().maxCoeff() <= 1e-15);
}
