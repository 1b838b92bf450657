// Where joint types come from: shared objects, opened local and never unloaded.
#pragma once

#include <dyn/error.hpp>
#include <dyn/joint/joint_type.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

/// A plugin file, its folder, and folders of links to it must belong to this process's user or to root, and neither their group nor everyone may
/// write them: others could replace what is loaded. Refused unless `any` is said.
enum class Trust { owner_only, any };

struct PluginRecord {
  std::string path;
  std::vector<std::string> types;  ///< names of joint and coupling types; empty if it failed
  std::string problem;             ///< why it was not loaded; empty if it was
  std::string remark;              ///< what is wrong with it though it was; else empty
  std::string fast;                ///< the file beside it that is built for this processor and used by compiled models; else empty
};

/// Name -> type. Reading is safe from several threads; loading is not.
class DYN_API JointRegistry {
 public:
  JointRegistry();
  ~JointRegistry();
  JointRegistry(const JointRegistry&);
  JointRegistry& operator=(const JointRegistry&);

  /// The plugins beside the library, then those in the folders of DYN_PLUGIN_PATH (separated by ':').
  /// A plugin that cannot be loaded is recorded in plugins() and named when a type is not found.
  static JointRegistry standard(Trust trust = Trust::owner_only);

  /// Loads one shared object (links are followed); throws Error(plugin) and leaves the registry as it was.
  void load(const std::string& path, Trust trust = Trust::owner_only);
  /// Loads every *.so of a folder, in the order of their names; failures are recorded, not thrown.
  void loadDirectory(const std::string& directory, Trust trust = Trust::owner_only);

  /// A joint type of the program itself, which must outlive every copy of the registry. Throws Error(plugin) if its name is taken.
  void add(const JointType& type);

  /// The type of that name; throws Error(joint_type) with every path searched and every problem met.
  const JointType& jointType(const std::string& name, const Where& where = {}) const;
  const CouplingType& couplingType(const std::string& name, const Where& where = {}) const;

  /// The same type built for this processor, if its plugin brings that (avx2/NAME.so and avx512/NAME.so beside NAME.so); else `type`.
  /// For poses, subspaces and biases; DYN_SIMD says which, as for the library's own kernels. load() refuses a plugin whose two builds describe
  /// a type differently, compile() a joint of which they say different sizes.
  const JointType& forProcessor(const JointType& type) const;

  const std::vector<const JointType*>& jointTypes() const;
  const std::vector<const CouplingType*>& couplingTypes() const;
  const std::vector<PluginRecord>& plugins() const;
  const std::vector<std::string>& searched() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dyn
