// SPDX-License-Identifier: BSD-2-Clause
// Keyframes, and the configuration in which a file puts its bodies, as named configurations.
#include "scene.hpp"

#include <dyn/lie/so3.hpp>

#include <cmath>
#include <cstring>
#include <set>

namespace dyn::mjcf {

namespace {

/// Returns a quaternion x, y, z, w of a file's w, x, y, z, normalised as MuJoCo does it.
std::vector<double> quaternion(const double* wxyz) {
  const Quaternion<double> q = Quaternion<double>{wxyz[1], wxyz[2], wxyz[3], wxyz[0]}.normalized();
  if (!std::isfinite(q.w)) return {0, 0, 0, 1};
  return {q.x, q.y, q.z, q.w};
}

class Keyframes {
 public:
  Keyframes(const Context& context, Scene& scene, const Guard& guard) : c_(context), s_(scene), guard_(guard) {
    for (const JointRecord& j : s_.joints) {
      nq_ += static_cast<std::size_t>(j.nq);
      nv_ += static_cast<std::size_t>(j.nq == 7 ? 6 : (j.nq == 4 ? 3 : 1));
    }
  }

  void run() {
    home();
    std::size_t count = 0;
    c_.source.forEach(c_.source.root(), [&](const XMLElement& e) {
      if (std::strcmp(e.Name(), "keyframe") != 0) return;
      c_.source.forEach(e, [&](const XMLElement& key) {
        if (std::strcmp(key.Name(), "key") == 0) guard_([&] { read(Values(c_.source, key, nullptr), count++); });
      });
    });
    // A keyframe of the file keeps its name.
    for (; has_home_ && names_.count(s_.model.configurations[0].name); s_.model.configurations[0].name += '_') {
    }
  }

 private:
  const std::string& nameOf(const JointRecord& j) const { return s_.model.bodies[j.body].joint.name; }

  /// Adds the configuration in which the file puts the bodies, if it is not the neutral one.
  void home() {
    home_.name = "qpos0";
    home_.where = c_.source.where(c_.source.root());
    bool neutral = true;
    for (const JointRecord& j : s_.joints) {
      JointState state{nameOf(j), {}, {}};
      if (j.nq == 7) {
        const SE3<double> X = cast<double>(s_.bodies[j.record].home);
        const Quaternion<double> q = quaternionOf(X.R);
        state.q = {X.p.x, X.p.y, X.p.z, q.x, q.y, q.z, q.w};
        neutral = false;
      } else if (j.nq == 4) {
        state.q = {0, 0, 0, 1};
      } else {
        state.q = {j.ref};
        neutral = neutral && j.ref == 0;
      }
      home_.joints.push_back(std::move(state));
    }
    has_home_ = !neutral;
    if (has_home_) s_.model.configurations.push_back(home_);
  }

  void read(const Values& v, std::size_t index) {
    ConfigurationDescription key = home_;
    key.name = v.text("name");
    if (key.name.empty()) key.name = "key_" + std::to_string(index);
    if (!names_.insert(key.name).second) v.fail("two keyframes are called '" + key.name + "'");
    key.where = c_.source.where(v.element());
    if (v.has("qpos")) {
      const std::vector<double> qpos = sized(v, "qpos", nq_);
      std::size_t at = 0;
      for (std::size_t k = 0; k < s_.joints.size(); ++k) {
        const int nq = s_.joints[k].nq;
        std::vector<double>& q = key.joints[k].q;
        q.assign(qpos.begin() + static_cast<std::ptrdiff_t>(at), qpos.begin() + static_cast<std::ptrdiff_t>(at + static_cast<std::size_t>(nq)));
        if (nq == 1) q = {qpos[at]};
        if (nq >= 4) {
          const std::vector<double> r = quaternion(qpos.data() + at + (nq == 7 ? 3 : 0));
          std::copy(r.begin(), r.end(), q.end() - 4);
        }
        at += static_cast<std::size_t>(nq);
      }
    }
    if (v.has("qvel")) velocities(sized(v, "qvel", nv_), key);
    s_.model.configurations.push_back(std::move(key));
  }

  std::vector<double> sized(const Values& v, const char* attribute, std::size_t size) const {
    if (size == 0) v.fail(v.described() + " has " + attribute + ", but the model has no joints");
    return v.numbers(attribute, size, size);
  }

  void velocities(const std::vector<double>& qvel, ConfigurationDescription& key) const {
    std::size_t at = 0;
    for (JointState& state : key.joints) {
      const std::size_t nv = state.q.size() == 7 ? 6 : (state.q.size() == 4 ? 3 : 1);
      state.v.assign(qvel.begin() + static_cast<std::ptrdiff_t>(at), qvel.begin() + static_cast<std::ptrdiff_t>(at + nv));
      if (nv == 6) {
        // The linear velocity of a free joint is in the world's axes in the file, and in the body's in libdyn.
        const std::vector<double>& q = state.q;
        const Vec3<double> linear =
            transposeTimes(Quaternion<double>{q[3], q[4], q[5], q[6]}.matrix(), Vec3<double>{state.v[0], state.v[1], state.v[2]});
        for (int i = 0; i < 3; ++i) state.v[static_cast<std::size_t>(i)] = linear[i];
      }
      at += nv;
    }
  }

  const Context& c_;
  Scene& s_;
  const Guard& guard_;
  std::size_t nq_ = 0, nv_ = 0;
  ConfigurationDescription home_;
  bool has_home_ = false;
  std::set<std::string> names_;
};

}  // namespace

void readKeyframes(const Context& context, Scene& scene, const Guard& guard) { Keyframes(context, scene, guard).run(); }

}  // namespace dyn::mjcf
