// Strips: joints of one type at equal depth that advance together, one in each lane of a pack.
#pragma once

#include <dyn/joint/shape.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace dyn {

struct CompactImpl;

constexpr int strip_lanes = 4;

/// Memory aligned for packs of every width.
class PackMemory {
 public:
  static constexpr std::size_t alignment = 64;
  PackMemory() : PackMemory(0) {}
  explicit PackMemory(std::size_t bytes);
  char* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_;
  std::unique_ptr<char[]> block_;
  char* data_;
};

/// Four bodies whose parents are all in one strip. Lanes without a body repeat the pose of one that has, without its inertia.
struct Strip {
  int body[strip_lanes] = {-1, -1, -1, -1};
  std::int64_t parent_lane[strip_lanes] = {0, 1, 2, 3};
  int parent = 0;
  bool aligned = true;      ///< every child is in its parent's lane, or the parent is the universe
  bool leaf = true;         ///< no strip's parent
  bool last_child = false;  ///< the last strip of its parent's
  int batch = 0, slot = 0;
  int dof = 0;  ///< of its first degree of freedom, four numbers each
  Shape shape = Shape::dense;
  int nv = 0;
};

struct StripBatch {
  int slots = 0;                               ///< strips
  std::vector<int> bodies;                     ///< four a slot, lanes without a body filled up
  std::vector<double> constants;               ///< of the joint type, component-major, stride 4 * slots
  std::vector<std::int64_t> q_index, v_index;  ///< of each of the bodies
};

struct StripPlan {
  bool used = false;          ///< the compiler judged it faster than one body after the other; if not, `count` is all there is
  int count = 0;              ///< strips without the universe
  std::vector<Strip> strips;  ///< [0]: the universe; parents first, equal shapes side by side
  std::vector<StripBatch> batches;
  int dofs = 0;
  std::vector<std::int64_t> dof_index;  ///< four a degree of freedom: where its lanes are in v and tau
  PackMemory constants;                 ///< BodyConstants of packs, a strip each
  std::vector<double> armature;         ///< four a degree of freedom; 1 in lanes without a body, which keeps their pivots from zero
};

/// Groups the bodies of a packed model. Models with couplings, or with joints of constant dense subspaces, have no strips.
StripPlan planStrips(const CompactImpl& m);

}  // namespace dyn
