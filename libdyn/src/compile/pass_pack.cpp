// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "compile/compact_impl.hpp"
#include "compile/draft.hpp"
#include "joint/coordinate.hpp"
#include "joint/processor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace dyn {

namespace {

std::string namesOf(const LaneGroupUses& uses) {
  const std::pair<bool, const char*> all[] = {{uses.rnea, "rnea"},
                                              {uses.aba, "aba"},
                                              {uses.mass_matrix, "crba"},
                                              {uses.derivatives, "minverse"},
                                              {uses.derivatives, "rnea derivatives"},
                                              {uses.centroidal_map, "ccrba"}};
  std::string names;
  for (const auto& [used, name] : all)
    if (used) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

class ModelPacker {
 public:
  ModelPacker(Draft&& draft, const CompileOptions& options) : draft_(std::move(draft)), options_(options), out_(std::make_shared<CompactImpl>()) {}

  std::shared_ptr<CompactImpl> run() {
    out_->name = draft_.name;
    out_->gravity = draft_.gravity;
    out_->report = std::move(draft_.report);
    out_->described = std::move(draft_.described);
    bodies();
    batches();
    runs();
    couplings();
    joints();
    frames();
    writePlacements(*out_, draft_.skeleton.links, draft_.skeleton.frames);
    writeInertias(*out_, draft_.inertias);
    dissipation();
    notePass(out_->report, "pack",
             std::to_string(out_->batches.size()) + " type batches, " + std::to_string(out_->runs.size()) +
                 " runs: " + std::to_string(out_->batches.size() + out_->runs.size()) + " dispatches an evaluation");
    if (options_.lane_groups)
      out_->lane_groups = planLaneGroups(*out_, options_.instruction_set.empty() ? instructionSet() : options_.instruction_set);
    const LaneGroupPlan& lane_groups = out_->lane_groups;
    const std::string counts = std::to_string(out_->bodies() - 1) + " joints in " + std::to_string(lane_groups.count) + " lane groups of 4; ";
    out_->report.passes.push_back("lane groups: " + (lane_groups.count < 1   ? std::string("none, one body after the other")
                                                     : lane_groups.uses.rnea ? counts + "single states take them in " + namesOf(lane_groups.uses)
                                                                             : counts + "one body after the other is faster"));
    return out_;
  }

 private:
  void bodies() {
    const std::size_t n = draft_.bodies.size();
    out_->index.resize(n);
    out_->subspace_offset.assign(n, -1);
    out_->tree_end.resize(n);
    for (std::size_t i = 0; i < n; ++i) out_->tree_end[i] = static_cast<int>(i) + 1;
    for (std::size_t i = 1; i < n; ++i) {
      const DraftBody& b = draft_.bodies[i];
      BodyIndex& x = out_->index[i];
      x.parent = draft_.skeleton.links[i].parent;
      x.depth = out_->index[at(x.parent)].depth + 1;
      x.nq = b.instance.nq;
      x.nv = b.instance.nv;
      x.idx_q = out_->nqx;
      x.idx_v = out_->nvx;
      out_->nqx += x.nq;
      out_->nvx += x.nv;
      x.floating_base = x.parent == 0 && b.instance.shape == Shape::free;
      x.turns_only = turnsOnly(b.instance.shape);
      const int here = static_cast<int>(i), before = x.parent == here - 1 && x.parent > 0 ? out_->index[i - 1].contiguous_from : here;
      x.contiguous_from = x.turns_only && x.nv == 1 ? before : here + 1;
      if (b.instance.shape == Shape::dense_constant) {
        out_->subspace_offset[i] = static_cast<int>(out_->subspaces.size());
        for (int k = 0; k < 6 * b.instance.nv; ++k) out_->subspaces.push_back(b.instance.subspace[k]);
      }
    }
    for (const double x : std::as_const(out_->subspaces)) out_->subspaces_float.push_back(static_cast<float>(x));
    for (std::size_t i = n - 1; i >= 1; --i) {
      int& end = out_->tree_end[at(out_->index[i].parent)];
      end = std::max(end, out_->tree_end[i]);
    }
    for (std::size_t i = 1; i < n; ++i) {
      const int end = out_->tree_end[i];
      out_->index[i].leaf = at(end) == i + 1;
      out_->index[i].branches = at(end) > i + 1 && out_->tree_end[i + 1] != end;
      out_->index[i].last_child = end == out_->tree_end[at(out_->index[i].parent)];
      const int end_of_tree = at(end) < n ? out_->index[at(end)].idx_v : out_->nvx;
      for (int k = 0; k < out_->index[i].nv; ++k) out_->dof_end.push_back(end_of_tree);
      const BodyIndex &x = out_->index[i], &parent = out_->index[at(x.parent)];
      for (int k = 0; k < x.nv; ++k) {
        const int dof = x.idx_v + k, next = k > 0 ? dof - 1 : parent.idx_v + parent.nv - 1;
        out_->dof_body.push_back(static_cast<int>(i));
        out_->dof_parent.push_back(next);
        out_->dof_segment.push_back(next >= 0 && next == dof - 1 ? out_->dof_segment[at(next)] : dof);
        out_->dof_depth.push_back(next >= 0 ? out_->dof_depth[at(next)] + 1 : 0);
        out_->path_room = std::max(out_->path_room, out_->dof_depth.back() + 1);
        // If the parent has other children, its subtree ends elsewhere than this one's, or it is not the neighbour in the numbers.
        if (dof > 0 && next == dof - 1 && out_->dof_end[at(next)] == end_of_tree) {
          out_->chains.back().end = dof + 1;
        } else {
          out_->chains.push_back({dof, dof + 1, out_->dof_depth.back()});
        }
      }
    }
    // By degree of freedom: the depth from which on all subtrees along its path end with its own.
    std::vector<int> alone(at(out_->nvx));
    for (DofChain& chain : out_->chains) {
      const int end = out_->dof_end[at(chain.begin)], parent = out_->dof_parent[at(chain.begin)];
      const int from = parent >= 0 && out_->dof_end[at(parent)] == end ? alone[at(parent)] : chain.depth;
      std::fill(alone.begin() + chain.begin, alone.begin() + chain.end, from);
      chain.leaf = end == chain.end;
      chain.first_fresh_depth = chain.leaf ? from : chain.depth;
    }
  }

  void batches() {
    std::map<std::tuple<const JointType*, Shape, int, int, int>, int> known;
    for (std::size_t i = 1; i < draft_.bodies.size(); ++i) {
      const DraftBody& b = draft_.bodies[i];
      const JointInstance& made = b.instance;
      const auto [found, is_new] =
          known.emplace(std::tuple(b.type, made.shape, made.nq, made.nv, made.constant_count), static_cast<int>(out_->batches.size()));
      if (is_new) {
        TypeBatch batch;
        batch.type = b.type;
        batch.fast = b.fast;
        batch.shape = made.shape;
        batch.adds = !(batch.type->info().closed_forms & closed_configuration);
        batch.curved = (batch.type->info().closed_forms & own_rates) != 0;
        batch.nq = made.nq;
        batch.nv = made.nv;
        batch.constant_count = made.constant_count;
        out_->batches.push_back(std::move(batch));
      }
      TypeBatch& batch = out_->batches[at(found->second)];
      out_->index[i].batch = found->second;
      out_->index[i].slot = batch.count++;
      batch.bodies.push_back(static_cast<int>(i));
      batch.q_index.push_back(out_->index[i].idx_q);
      batch.v_index.push_back(out_->index[i].idx_v);
    }
    for (TypeBatch& batch : out_->batches) {
      batch.contiguous = batch.nq == 1 || batch.count == 1;
      for (std::size_t k = 1; k < batch.q_index.size(); ++k) batch.contiguous = batch.contiguous && batch.q_index[k] == batch.q_index[k - 1] + 1;
      batch.constants.resize(at(std::max(batch.constant_count, 1) * batch.count));
      for (int k = 0; k < batch.count; ++k)
        for (int c = 0; c < batch.constant_count; ++c)
          batch.constants[at(c * batch.count + k)] = draft_.bodies[at(batch.bodies[at(k)])].constants[at(c)];
      double q[max_joint_nq];
      for (int k = 0; batch.adds && k < batch.count; ++k) {
        neutralOf(batch.placeOf(k), q);
        batch.adds = std::all_of(q, q + batch.nq, [](double x) { return x == 0; });
      }
    }
  }

  void runs() {
    for (std::size_t i = 1; i < out_->index.size(); ++i) {
      BodyIndex& x = out_->index[i];
      if (out_->runs.empty() || out_->runs.back().batch != x.batch) {
        const TypeBatch& batch = out_->batches[at(x.batch)];
        out_->runs.push_back({batch.shape, batch.nv, static_cast<int>(i), 0, x.batch, x.slot});
      } else {
        x.follows = x.parent == static_cast<int>(i) - 1;
      }
      ++out_->runs.back().count;
    }
  }

  void couplings() {
    std::vector<std::size_t> dependents;
    for (std::size_t i = 1; i < draft_.bodies.size(); ++i)
      if (draft_.bodies[i].coupling) dependents.push_back(i);
    // Masters come first.
    std::stable_sort(dependents.begin(), dependents.end(),
                     [&](std::size_t a, std::size_t b) { return draft_.bodies[a].coupling->rank < draft_.bodies[b].coupling->rank; });
    for (const std::size_t i : dependents) {
      const DraftCoupling& c = *draft_.bodies[i].coupling;
      out_->couplings.push_back({c.type, static_cast<int>(i), c.master, c.constants});
    }
    for (std::size_t i = 1; i < draft_.bodies.size() && !out_->couplings.empty(); ++i) {
      if (draft_.bodies[i].coupling) continue;
      const BodyIndex& x = out_->index[i];
      for (int k = 0; k < x.nq; ++k) out_->q_of_user.push_back(x.idx_q + k);
      for (int k = 0; k < x.nv; ++k) out_->v_of_user.push_back(x.idx_v + k);
    }
    out_->nq = out_->couplings.empty() ? out_->nqx : static_cast<int>(out_->q_of_user.size());
    out_->nv = out_->couplings.empty() ? out_->nvx : static_cast<int>(out_->v_of_user.size());
    if (!out_->couplings.empty()) out_->report.passes.push_back("couple: " + std::to_string(out_->couplings.size()) + " coordinates follow others");
  }

  /// Makes one record for each described joint that still moves. The parts of a composite make one joint.
  void joints() {
    JointRecord universe;
    universe.name = "universe";
    out_->joints.push_back(universe);
    out_->body_of_joint.push_back(0);
    out_->user_frame.emplace_back();
    constexpr double inf = std::numeric_limits<double>::infinity();
    int nq = 0, nv = 0;
    for (std::size_t i = 1; i < draft_.bodies.size(); ++i) {
      const DraftBody& b = draft_.bodies[i];
      const bool continues = i > 1 && draft_.bodies[i - 1].user_joint == b.user_joint;
      if (!continues) {
        JointRecord r;
        r.name = b.user_name;
        r.type = b.user_type;
        r.parent = out_->index[at(out_->index[i].parent)].joint;
        r.idx_q = nq;
        r.idx_v = nv;
        out_->joints.push_back(r);
        out_->body_of_joint.push_back(0);
        out_->user_frame.emplace_back();
      }
      JointRecord& r = out_->joints.back();
      out_->index[i].joint = static_cast<int>(out_->joints.size()) - 1;
      out_->body_of_joint.back() = static_cast<int>(i);
      if (b.coupling) continue;
      const auto append = [](std::vector<double>& to, const std::vector<double>& from, int count, double otherwise) {
        for (int k = 0; k < count; ++k) to.push_back(at(k) < from.size() ? from[at(k)] : otherwise);
      };
      out_->index[i].user_q = nq;
      out_->index[i].user_v = nv;
      r.nq += b.instance.nq;
      r.nv += b.instance.nv;
      nq += b.instance.nq;
      nv += b.instance.nv;
      append(out_->limits.lower, b.joint.limits.lower, b.instance.nq, -inf);
      append(out_->limits.upper, b.joint.limits.upper, b.instance.nq, inf);
      append(out_->limits.velocity, b.joint.limits.velocity, b.instance.nv, inf);
      append(out_->limits.effort, b.joint.limits.effort, b.instance.nv, inf);
    }
  }

  void frames() {
    for (std::size_t k = 0; k < draft_.skeleton.frames.size(); ++k) {
      const int body = draft_.skeleton.frames[k].body;
      out_->frame_body.push_back(body);
      out_->frame_placement.emplace_back();
      out_->frames.push_back({draft_.frame_names[k], out_->index[at(body)].joint, {}});
    }
  }

  void dissipation() {
    const auto collect = [&](std::vector<double> JointDescription::*field) {
      std::vector<double> all(at(out_->nvx), 0.0);
      for (std::size_t i = 1; i < draft_.bodies.size(); ++i) {
        const std::vector<double>& values = draft_.bodies[i].joint.*field;
        for (std::size_t k = 0; k < values.size() && k < at(out_->index[i].nv); ++k) all[at(out_->index[i].idx_v) + k] = values[k];
      }
      return SharedVector<double>(std::move(all));
    };
    DescribedNumbers& described = out_->described;
    described.damping = collect(&JointDescription::damping);
    described.friction = collect(&JointDescription::friction);
    described.armature = collect(&JointDescription::armature);
    described.dissipation_acts = options_.dissipation;
    described.armature_acts = options_.armature;
    writeDissipation(*out_);
  }

  Draft draft_;
  const CompileOptions& options_;
  std::shared_ptr<CompactImpl> out_;
};

}  // namespace

std::shared_ptr<CompactImpl> pack(Draft&& draft, const CompileOptions& options) { return ModelPacker(std::move(draft), options).run(); }

}  // namespace dyn
