// SPDX-License-Identifier: BSD-2-Clause
// The registry of joint types. They come from shared objects, which are opened with local symbols and never unloaded.
#pragma once

#include <dyn/error.hpp>
#include <dyn/joint/joint_type.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

/// With `owner_only`, a plugin file, its folder and the folders of links to it must belong to root, this process's user or the owner of libdyn's
/// file, and neither their group nor everyone may write to them: others could replace what is loaded. `any` skips this check.
enum class Trust { owner_only, any };

/// One plugin file that a registry loaded or could not load, or one folder that it could not read.
struct PluginRecord {
  std::string path;                ///< the file or folder, as it was named
  std::vector<std::string> types;  ///< names of joint and coupling types; empty if loading failed
  std::string problem;             ///< why the plugin was not loaded; empty if it was
  std::string remark;              ///< what is wrong with a plugin that was loaded; else empty
  std::string fast;                ///< the file with its build for this processor, which compiled models use; empty if there is none
};

/// Maps names to joint and coupling types. Reading is safe from several threads; loading is not. Copies know the same types. Loaded plugins stay
/// loaded until the process ends.
class DYN_API JointRegistry {
 public:
  /// Makes a registry without types.
  JointRegistry();
  ~JointRegistry();
  JointRegistry(const JointRegistry&);
  JointRegistry& operator=(const JointRegistry&);

  /// Loads the plugins beside the library, then those in the folders of DYN_PLUGIN_PATH (separated by ':').
  /// A plugin that cannot be loaded is recorded in plugins(), and named in the error when a type is not found.
  static JointRegistry standard(Trust trust = Trust::owner_only);

  /// Loads one shared object (follows links). Throws Error(plugin | file), and leaves the registry unchanged then. Loading a file again changes
  /// nothing.
  void load(const std::string& path, Trust trust = Trust::owner_only);
  /// Loads every *.so of a folder, in the order of their names. Records failures in plugins() instead of throwing.
  void loadDirectory(const std::string& directory, Trust trust = Trust::owner_only);

  /// Adds a joint type of the program itself, which must outlive every copy of the registry. Throws Error(plugin) if its name is taken or cannot be a
  /// name, or if its description is incomplete.
  void add(const JointType& type);

  /// Makes the registry forget a joint type, so that another can take its name. Models that are compiled keep the type. Throws Error(joint_type) if
  /// there is none.
  void remove(const std::string& name);

  /// Returns the type of that name. Throws Error(joint_type), with every path searched and every problem met, if there is none. The error has `where`
  /// as its place. O(types).
  /// @{
  const JointType& jointType(const std::string& name, const Where& where = {}) const;
  const CouplingType& couplingType(const std::string& name, const Where& where = {}) const;
  /// @}

  /// Returns the same type built for this processor if its plugin has such a build (SET/NAME.so beside NAME.so, with the name of the instruction
  /// set), else `type`. It computes poses, subspaces and biases. DYN_SIMD can choose the instruction set, as for the library's own kernels. load()
  /// refuses a plugin whose two builds describe a type differently; compile() refuses a joint for which they differ in size or motion.
  const JointType& forProcessor(const JointType& type) const;

  /// Return all types, in the order of loading.
  /// @{
  const std::vector<const JointType*>& jointTypes() const;
  const std::vector<const CouplingType*>& couplingTypes() const;
  /// @}
  /// Returns a record of each plugin that was loaded, and of each failure of loadDirectory().
  const std::vector<PluginRecord>& plugins() const;
  /// Returns the folders that loadDirectory() was given.
  const std::vector<std::string>& searched() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dyn
