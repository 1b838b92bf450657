// Strips: joints of one type that advance together, one in each lane of a pack.
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

/// A body's place in the lanes. The universe is in all of them.
struct Seat {
  int strip = 0, lane = 0;
  unsigned lanes = 0;  ///< that show it, a bit each
  int strip_dof = 0;   ///< the strip's first degree of freedom
};

/// Some lanes of a strip, and the strip that has their parents.
struct StripParents {
  int strip = 0;
  int lane = -1;       ///< of the parent of all these lanes; -1: each has its parent in the lane of its own
  unsigned lanes = 0;  ///< a bit each
  unsigned given = 0;  ///< those that hand over what their bodies add to their parents
  bool first = false;  ///< the first to hand anything to that strip, children before parents
};
/// Where one lane finds its parent.
struct LaneParent {
  int strip = 0, lane = 0;
  bool given = false;  ///< what its body adds
};

/// Up to four bodies. A lane without a body of its own may mirror another's, in the lane of limbs that hang on it, so that these find their
/// parent where they are: it moves as that body does. Where limbs part, the body's inertia is in one lane, and the sum of all lanes becomes
/// that of each; before, along a trunk that is mirrored as a whole, every lane has it all. The other lanes have someone's pose, and nothing
/// comes of them.
struct Strip {
  int body[strip_lanes] = {-1, -1, -1, -1};
  int shown[strip_lanes] = {-1, -1, -1, -1};  ///< the body, or the mirrored one
  unsigned united[2] = {0, 0};                ///< lanes that show the same body, on which limbs of several lanes hang; a bit each
  StripParents parents[strip_lanes];          ///< of lanes with a body and of those that mirror one
  int parents_count = 0;
  bool aligned = true;    ///< one entry of `parents`, lane by lane, or the universe: lanes go on as they are
  bool gives_all = true;  ///< and so is what they hand over
  bool apart = false;     ///< many parents: lanes are read and written one by one
  LaneParent lane_parents[strip_lanes];
  unsigned bodies = 0;              ///< lanes with a body of their own
  unsigned ways[strip_lanes] = {};  ///< these by how they go up to the root: those that are in the same strips, lane by lane until they meet
  int depth = 0;
  bool leaf = true;  ///< no strip's parent
  int batch = 0, slot = 0;
  int dof = 0;  ///< of its first degree of freedom, four numbers each
  Shape shape = Shape::dense;
  int nv = 0;
};

/// Strips that follow one another and have one shape.
struct StripRun {
  int first = 0, end = 0;
  Shape shape = Shape::dense;
  int nv = 0;
};

struct StripBatch {
  int slots = 0;                               ///< strips
  std::vector<int> bodies;                     ///< four a slot: whose pose the lanes have
  std::vector<double> constants;               ///< of the joint type, component-major, stride 4 * slots
  std::vector<std::int64_t> q_index, v_index;  ///< of each of the bodies
  std::vector<std::int64_t> pose_index;        ///< where each has its place in the batch
};

/// Algorithms of single states that take joints in lanes, because the compiler judged that faster than one body after the other.
struct StripUses {
  bool rnea = false;  ///< if not, no other either
  bool aba = false;
  bool mass_matrix = false;
  bool derivatives = false;  ///< and the factors of M^-1
  bool centroidal_map = false;
};

struct StripPlan {
  StripUses uses;
  int count = 0;              ///< strips without the universe; all there is where nobody uses them
  std::vector<Strip> strips;  ///< [0]: the universe; parents first
  std::vector<Seat> seats;    ///< by body
  std::vector<StripRun> runs;
  std::vector<StripBatch> batches;
  int dofs = 0;
  int shared_dofs = 0;                  ///< the first ones, which all lanes have: the root's
  std::vector<std::int64_t> dof_index;  ///< four a degree of freedom: where its lanes are in v and tau
  std::vector<std::int64_t> dof_row;    ///< the same times nvx: where their rows and columns begin
  std::vector<std::int64_t> dof_place;  ///< the other way: where v and tau are among the lanes of all degrees of freedom
  PackMemory constants;                 ///< BodyConstants of packs, a strip each
  std::vector<double> armature;         ///< four a degree of freedom; 1 in lanes of nobody, which keeps their pivots from zero
};

/// Only which bodies share a strip, of any model and on any machine: Strip::body, and seats.
StripPlan seatStrips(const CompactImpl& m);
/// Groups the bodies of a packed model. Models with couplings, or with joints of constant dense subspaces, have no strips.
StripPlan planStrips(const CompactImpl& m);

}  // namespace dyn
