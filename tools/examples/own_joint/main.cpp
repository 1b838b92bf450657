// SPDX-License-Identifier: BSD-2-Clause
// Loads a joint type of one's own from elliptic_track.so, builds a model with this joint in C++, and puts a robot from a file onto its carriage.
// Prints the joints and the pose of the carriage, and checks that the pose is on the ellipse and that aba(rnea(a)) is a.
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

int main(int argc, char** argv) try {
  const std::string robot = argc > 1 ? argv[1] : "models/arm.urdf";
  const std::string plugin = argc > 2 ? argv[2] : std::filesystem::read_symlink("/proc/self/exe").replace_filename("elliptic_track.so").string();

  // The registry has the standard types and the new one. load() refuses files that others may write.
  dyn::JointRegistry registry = dyn::JointRegistry::standard();
  registry.load(plugin);

  // The world, the track, the carriage. A parameter is a list of numbers, even if it has one only.
  const double a = 2, b = 1;
  dyn::Model track;
  track.name = "track";
  dyn::JointDescription joint{.name = "drive", .type = "elliptic_track"};
  joint.parameters = {{"a", std::vector<double>{a}}, {"b", std::vector<double>{b}}};
  joint.damping = {5};
  track.addBody("carriage", 0, joint, {.mass = 20, .com = {0, 0, 0.1}, .rotational = {.xx = 0.4, .yy = 0.5, .zz = 0.6}});

  // The robot stands 0.2 m above the carriage.
  const dyn::SE3<double> mount{dyn::Mat3<double>::identity(), {0, 0, 0.2}};
  const dyn::CompactModel model = dyn::compile(dyn::append(track, dyn::urdf::load(robot), "carriage", mount), registry);
  dyn::Data data(model, dyn::Need::mass_matrix);
  for (const dyn::JointRecord& j : model.joints())
    if (j.nv > 0) std::printf("%-12s %-16s q[%d], v[%d]\n", j.name.c_str(), j.type.c_str(), j.idx_q, j.idx_v);

  // All algorithms know the new joint.
  Eigen::VectorXd q = dyn::randomConfiguration(model, 1);
  const Eigen::VectorXd v = Eigen::VectorXd::Constant(model.nv(), 0.5), ddq = Eigen::VectorXd::LinSpaced(model.nv(), -1, 1);
  const double angle = 0.8;
  q[model.joints()[static_cast<std::size_t>(model.jointId("drive"))].idx_q] = angle;
  const Eigen::VectorXd tau = dyn::rnea(model, data, q, v, ddq);
  const double round_trip = (dyn::aba(model, data, q, v, tau) - ddq).norm() / ddq.norm();

  dyn::forwardKinematics(model, data, q);
  const dyn::Vec3<double> p = dyn::framePlacement(model, data, model.frameId("carriage")).p;
  const double from_ellipse = std::hypot(p.x - a * std::cos(angle), p.y - b * std::sin(angle), p.z);

  std::printf("the carriage is at (%.4f, %.4f, %.4f) m, %.1e m from the ellipse\n", p.x, p.y, p.z, from_ellipse);
  std::printf("|aba(rnea(a)) - a| / |a| = %.1e\n", round_trip);
  const bool good = round_trip < 1e-10 && from_ellipse < 1e-14;
  std::puts(good ? "success" : "FAILURE");
  return good ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "%s\n", problem.what());
  return 1;
}
