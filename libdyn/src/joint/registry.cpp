// SPDX-License-Identifier: BSD-2-Clause
#include "joint/loader.hpp"
#include "joint/processor.hpp"

#include <dyn/joint/registry.hpp>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>
#include <string_view>

namespace dyn {

struct JointRegistry::Impl {
  std::vector<const JointType*> joints;
  std::vector<const CouplingType*> couplings;
  std::map<std::string, std::string> origin;  // type name -> file; empty: the program itself
  std::vector<PluginRecord> plugins;
  std::vector<std::string> searched;
  std::map<const JointType*, const JointType*> fast;  // type -> the same type built for this processor

  void add(const std::string& path, Trust trust);
};

namespace {

template <class Type>
std::vector<const Type*> typesOf(const void* const* types, std::uint32_t count) {
  std::vector<const Type*> result;
  for (std::uint32_t i = 0; i < count; ++i) result.push_back(static_cast<const Type*>(types[i]));
  return result;
}

template <class Type>
const Type* find(const std::vector<const Type*>& types, const std::string& name) {
  for (const Type* type : types)
    if (name == type->info().name) return type;
  return nullptr;
}

bool same(const char* a, const char* b) { return a == b || (a && b && std::string_view(a) == b); }

/// Whether two builds describe a type in the same way.
bool same(const JointTypeInfo& a, const JointTypeInfo& b) {
  const auto alike = [](const ParameterSpec& x, const ParameterSpec& y) {
    return same(x.name, y.name) && x.kind == y.kind && x.required == y.required && same(x.unit, y.unit) && same(x.help, y.help) &&
           same(x.example, y.example);
  };
  return same(a.name, b.name) && same(a.summary, b.summary) && a.structure == b.structure && a.closed_forms == b.closed_forms &&
         std::equal(a.parameters, a.parameters + a.parameter_count, b.parameters, b.parameters + b.parameter_count, alike);
}

/// Why files cannot use this name; empty if they can.
std::string nameProblem(const char* name) {
  if (name == nullptr) return "has no name";
  if (*name == '\0') return "has an empty name";
  for (const char* c = name; *c != '\0'; ++c)
    if (static_cast<unsigned char>(*c) <= ' ' || *c == '\x7f' || std::strchr("<>&\"'", *c))
      return std::string("is called '") + name + "', with a character that names must not have: no blanks, no control characters, none of <>&\"'";
  return "";
}

/// Throws Error(plugin) if models cannot name a type or its parameters, two parameters have the same name, or a text that is printed is missing.
void checkInfo(const JointTypeInfo& info, const std::string& path) {
  const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::plugin, what, {path, 0, ""}); };
  if (const std::string problem = nameProblem(info.name); !problem.empty()) refuse("a type of it " + problem);
  const std::string type = std::string("type '") + info.name + "': ";
  if (info.summary == nullptr) refuse(type + "it has no summary");
  for (int i = 0; i < info.parameter_count; ++i) {
    const ParameterSpec& spec = info.parameters[i];
    const std::string which = type + "parameter " + std::to_string(i) + " ";
    if (const std::string problem = nameProblem(spec.name); !problem.empty()) refuse(which + problem);
    if (spec.unit == nullptr || spec.help == nullptr) refuse(which + "has no unit or no help; write \"\" where there is none");
    for (int k = 0; k < i; ++k)
      if (same(spec.name, info.parameters[k].name)) refuse(type + "two parameters are called '" + spec.name + "'");
  }
}

/// A plugin's build for this process's instruction set, from the folder of that name beside the plugin, type by type.
struct FastBuild {
  std::string path;
  std::map<const JointType*, const JointType*> types;
};
FastBuild builtForProcessor(const std::string& path, Trust trust, const std::vector<const JointType*>& joints) {
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::canonical(path, ignored);
  const std::filesystem::path other = file.parent_path() / instructionSet() / file.filename();
  if (!std::filesystem::exists(other, ignored)) return {};
  const dyn_plugin_descriptor& d = openPlugin(other.string(), trust).descriptor;
  const auto fast_joints = typesOf<JointType>(d.joint_types, d.joint_type_count);
  for (const JointType* type : fast_joints) checkInfo(type->info(), other.string());
  FastBuild result{other.string(), {}};
  for (const JointType* type : joints) {
    const JointType* fast = find(fast_joints, type->info().name);
    if (fast == nullptr) continue;
    if (!same(type->info(), fast->info()))
      throw Error(ErrorCode::plugin,
                  std::string("is another build than '") + other.string() + "': they describe joint type '" + type->info().name +
                      "' differently; rebuild both from one source, or remove the second",
                  {path, 0, ""});
    result.types[type] = fast;
  }
  return result;
}

}  // namespace

void JointRegistry::Impl::add(const std::string& path, Trust trust) {
  const OpenedPlugin opened = openPlugin(path, trust);
  const dyn_plugin_descriptor& d = opened.descriptor;
  const auto new_joints = typesOf<JointType>(d.joint_types, d.joint_type_count);
  const auto new_couplings = typesOf<CouplingType>(d.coupling_types, d.coupling_type_count);
  for (const JointType* type : new_joints) checkInfo(type->info(), path);
  for (const CouplingType* type : new_couplings) checkInfo(type->info(), path);
  PluginRecord record{path, {}, {}, opened.remark, {}};
  for (const JointType* type : new_joints) record.types.emplace_back(type->info().name);
  for (const CouplingType* type : new_couplings) record.types.emplace_back(type->info().name);
  if (record.types.empty()) throw Error(ErrorCode::plugin, "exports no joint types", {path, 0, ""});
  const FastBuild faster = builtForProcessor(path, trust, new_joints);
  record.fast = faster.path;
  for (std::size_t i = 0; i < record.types.size(); ++i) {
    const std::string& name = record.types[i];
    const auto known = origin.find(name);
    std::error_code ignored;
    if (known != origin.end() && std::filesystem::equivalent(known->second, path, ignored)) return;  // the same file by another path
    if (known != origin.end()) {
      const std::string provider = known->second.empty() ? "the program" : known->second;
      throw Error(ErrorCode::plugin, "joint type '" + name + "' is already provided by " + provider + "; rename one of them", {path, 0, ""});
    }
    if (std::count(record.types.begin(), record.types.end(), name) > 1)
      throw Error(ErrorCode::plugin, "exports joint type '" + name + "' twice", {path, 0, ""});
  }
  for (const std::string& name : record.types) origin[name] = path;
  fast.insert(faster.types.begin(), faster.types.end());
  joints.insert(joints.end(), new_joints.begin(), new_joints.end());
  couplings.insert(couplings.end(), new_couplings.begin(), new_couplings.end());
  plugins.push_back(std::move(record));
}

JointRegistry::JointRegistry() : impl_(std::make_unique<Impl>()) {}
JointRegistry::~JointRegistry() = default;
JointRegistry::JointRegistry(const JointRegistry& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
JointRegistry& JointRegistry::operator=(const JointRegistry& other) {
  impl_ = std::make_unique<Impl>(*other.impl_);
  return *this;
}

JointRegistry JointRegistry::standard(Trust trust) {
  JointRegistry registry;
  registry.loadDirectory(builtinPluginDirectory(), trust);
  if (const char* path = secure_getenv("DYN_PLUGIN_PATH")) {
    std::stringstream folders(path);
    for (std::string folder; std::getline(folders, folder, ':');)
      if (!folder.empty()) registry.loadDirectory(folder, trust);
  }
  return registry;
}

void JointRegistry::load(const std::string& path, Trust trust) { impl_->add(path, trust); }

void JointRegistry::add(const JointType& type) {
  checkInfo(type.info(), "");
  const std::string name = type.info().name;
  const auto [known, fresh] = impl_->origin.emplace(name, "");
  if (!fresh)
    throw Error(ErrorCode::plugin, "joint type '" + name + "' is already provided by " +
                                       (known->second.empty() ? std::string("the program") : known->second) + "; rename one of them");
  impl_->joints.push_back(&type);
}

void JointRegistry::remove(const std::string& name) {
  const JointType& type = jointType(name);
  std::erase(impl_->joints, &type);
  impl_->origin.erase(name);
  impl_->fast.erase(&type);
  for (PluginRecord& plugin : impl_->plugins) std::erase(plugin.types, name);
  std::erase_if(impl_->plugins, [](const PluginRecord& plugin) { return plugin.problem.empty() && plugin.types.empty(); });
}

void JointRegistry::loadDirectory(const std::string& directory, Trust trust) {
  impl_->searched.push_back(directory);
  std::vector<std::string> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error))
    if (entry.path().extension() == ".so") files.push_back(entry.path().string());
  if (error) {
    impl_->plugins.push_back({directory, {}, directory + ": cannot read the folder: " + error.message(), {}, {}});
    return;
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    try {
      impl_->add(file, trust);
    } catch (const Error& problem) {
      impl_->plugins.push_back({file, {}, problem.what(), {}, {}});
    }
  }
}

namespace {
[[noreturn]] void notFound(const JointRegistry& registry, const char* kind, const std::string& name, const Where& where) {
  std::string text = std::string(kind) + " type '" + name + "' is provided by no plugin; searched:";
  for (const std::string& path : registry.searched()) text += "\n  " + path;
  if (registry.searched().empty()) text += " nothing (the registry was given no folder)";
  for (const PluginRecord& plugin : registry.plugins())
    if (!plugin.problem.empty()) text += "\n  not loaded: " + plugin.problem;
  text += "\n  set DYN_PLUGIN_PATH to the folder of the plugin that provides it; `dyn plugin list` shows what is known";
  throw Error(ErrorCode::joint_type, text, where);
}
}  // namespace

const JointType& JointRegistry::jointType(const std::string& name, const Where& where) const {
  if (const JointType* type = find(impl_->joints, name)) return *type;
  notFound(*this, "joint", name, where);
}
const CouplingType& JointRegistry::couplingType(const std::string& name, const Where& where) const {
  if (const CouplingType* type = find(impl_->couplings, name)) return *type;
  notFound(*this, "coupling", name, where);
}
const JointType& JointRegistry::forProcessor(const JointType& type) const {
  const auto found = impl_->fast.find(&type);
  return found == impl_->fast.end() ? type : *found->second;
}
const std::vector<const JointType*>& JointRegistry::jointTypes() const { return impl_->joints; }
const std::vector<const CouplingType*>& JointRegistry::couplingTypes() const { return impl_->couplings; }
const std::vector<PluginRecord>& JointRegistry::plugins() const { return impl_->plugins; }
const std::vector<std::string>& JointRegistry::searched() const { return impl_->searched; }

}  // namespace dyn
