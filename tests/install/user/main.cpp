// A user's program: a robot from a file, its dynamics there and back. Prints a result that must not depend on how it was compiled.
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const dyn::CompactModel model = dyn::compile(dyn::urdf::load(argv[1]), dyn::JointRegistry::standard());
    dyn::Data data(model, dyn::Need::mass_matrix);
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(model.nq(), 0.6);
    const Eigen::Matrix<double, 1, 1> v(0.3);  // of fixed size, aligned as this program's flags say
    Eigen::MatrixXd a = Eigen::MatrixXd::Constant(model.nv(), 2, -0.8);
    const Eigen::VectorXd tau = dyn::rnea(model, data, q, v, 2 * a.col(1) - a.col(0));
    const Eigen::VectorXd back = dyn::aba(model, data, q, v, tau);
    const Eigen::MatrixXd M = dyn::crba(model, data, q);
    if ((back - a.col(0)).norm() > 1e-12 || M(0, 0) <= 0) {
      std::fprintf(stderr, "rnea and aba disagree\n");
      return 1;
    }
    std::printf("tau %.15g M %.15g\n", tau[0], M(0, 0));
  } catch (const dyn::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
