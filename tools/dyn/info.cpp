// SPDX-License-Identifier: BSD-2-Clause
// dyn info: the plugins and types that were loaded, the model compiler's report, and the tree.
#include "commands.hpp"
#include "messages.hpp"
#include "model_options.hpp"

#include <map>
#include <memory>

namespace dyn::tool {

namespace {

void printTree(const CompactModel& model) {
  const auto& joints = model.joints();
  std::vector<std::vector<std::size_t>> children(joints.size());
  for (std::size_t j = 1; j < joints.size(); ++j) children[static_cast<std::size_t>(joints[j].parent)].push_back(j);
  // Chains may be long, so a stack of (joint, prefix, last child) replaces recursion.
  struct Entry {
    std::size_t joint;
    std::string prefix;
    bool last;
  };
  std::vector<Entry> stack{{0, "", true}};
  while (!stack.empty()) {
    const Entry e = stack.back();
    stack.pop_back();
    const JointRecord& r = joints[e.joint];
    const bool root = e.joint == 0;
    std::printf("%s%s%s", e.prefix.c_str(), root ? "" : (e.last ? "`- " : "|- "), r.name.c_str());
    if (!root && r.nv == 0)
      std::printf("  (%s, dependent)", r.type.c_str());
    else if (!root)
      std::printf("  (%s, q %d..%d, v %d..%d)", r.type.c_str(), r.idx_q, r.idx_q + r.nq - 1, r.idx_v, r.idx_v + r.nv - 1);
    std::printf("\n");
    const std::string below = root ? "" : (e.prefix.size() > 200 ? e.prefix : e.prefix + (e.last ? "   " : "|  "));
    const auto& c = children[e.joint];
    for (std::size_t k = c.size(); k-- > 0;) stack.push_back({c[k], below, k + 1 == c.size()});
  }
}

void printTypes(const CompactModel& model, const JointRegistry& registry) {
  std::map<std::string, int> count;
  for (std::size_t j = 1; j < model.joints().size(); ++j) ++count[model.joints()[j].type];
  for (const auto& [type, n] : count) {
    const std::uint32_t closed = registry.jointType(type).info().closed_forms;
    std::printf("  %-14s %3d  subspace %s, bias %s, configuration %s\n", type.c_str(), n, closed & closed_subspace ? "closed form" : "derived",
                closed & closed_bias ? "closed form" : "derived", closed & closed_configuration ? "closed form" : "flat");
  }
}

/// Prints all frames. Each link has one, a link behind a fixed joint too; its frame need not coincide with a joint's.
void printFrames(const CompactModel& model) {
  for (std::size_t f = 1; f < model.frames().size(); ++f) {
    const auto& frame = model.frames()[f];
    std::printf("  %s  (joint %s)\n", frame.name.c_str(), model.joints()[static_cast<std::size_t>(frame.joint)].name.c_str());
  }
}

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// Prints the parts of the robot that planners name, and its named states.
void printGroups(const Model& description) {
  if (!description.groups.empty()) std::printf("\n%s\n", heading("groups and their joints").c_str());
  for (const GroupDescription& group : description.groups)
    std::printf("  %s: %s\n", group.name.c_str(), joined(description.jointsOf(group.name)).c_str());
  if (!description.end_effectors.empty()) std::printf("\n%s\n", heading("end effectors").c_str());
  for (const EndEffectorDescription& e : description.end_effectors)
    std::printf("  %s: group %s on %s%s%s\n", e.name.c_str(), e.group.c_str(), e.body.c_str(), e.parent_group.empty() ? "" : ", moved by ",
                e.parent_group.c_str());
  if (!description.passive_joints.empty()) std::printf("\n%s\n  %s\n", heading("passive joints").c_str(), joined(description.passive_joints).c_str());
  if (!description.devices.empty()) std::printf("\n%s\n", heading("devices, kept and not used").c_str());
  for (const DeviceDescription& device : description.devices) std::printf("  %s %s\n", device.type.c_str(), device.name.c_str());
  if (!description.configurations.empty()) std::printf("\n%s\n", heading("named states").c_str());
  for (const ConfigurationDescription& state : description.configurations)
    std::printf("  %s%s%s: %zu joints\n", state.group.c_str(), state.group.empty() ? "" : "/", state.name.c_str(), state.joints.size());
}

void runInfo(const ModelOptions& o) {
  const JointRegistry registry = o.registry();
  const Model description = o.description();
  const CompactModel model = o.compile(description, registry);
  std::printf("%s: %d joints, nq %d, nv %d, %zu frames, %.6g kg\n", model.name().c_str(), model.njoints() - 1, model.nq(), model.nv(),
              model.frames().size(), model.mass());
  std::printf("\n%s\n", heading("plugins").c_str());
  for (const PluginRecord& p : registry.plugins()) {
    if (p.problem.empty()) {
      std::printf("  %s: %zu types\n", p.path.c_str(), p.types.size());
    } else {
      std::printf("  not loaded: %s\n", p.problem.c_str());
    }
  }
  std::printf("\n%s\n", heading("joint types").c_str());
  printTypes(model, registry);
  std::printf("\n%s\n", heading("compiler").c_str());
  for (const std::string& line : model.report().passes) std::printf("  %s\n", line.c_str());
  const Data data(model);
  std::printf("  data: %zu bytes\n", data.bytes());
  for (const std::string& line : model.report().warnings) std::printf("  %s %s\n", styled(stdout, Style::warning, "warning:").c_str(), line.c_str());
  if (!description.notes.empty()) std::printf("\n%s\n", heading("notes of the parser").c_str());
  for (const std::string& line : description.notes) std::printf("  %s\n", line.c_str());
  printGroups(description);
  std::printf("\n%s\n", heading("tree").c_str());
  printTree(model);
  std::printf("\n%s\n", heading("frames, each with the joint that moves it").c_str());
  printFrames(model);
}

}  // namespace

void addInfo(CLI::App& app) {
  CLI::App* sub = addCommand(app, "info", "what a model is made of, and what the compiler made of it");
  auto o = std::make_shared<ModelOptions>();
  o->add(*sub);
  sub->callback([o] { runInfo(*o); });
}

}  // namespace dyn::tool
