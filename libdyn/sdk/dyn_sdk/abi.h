/* SPDX-License-Identifier: BSD-2-Clause */
/* The handshake between libdyn and a plugin: a C descriptor that the function "dyn_plugin_descriptor_v1" returns. */
#ifndef DYN_SDK_ABI_H
#define DYN_SDK_ABI_H

#include <stdint.h>

#define DYN_PLUGIN_MAGIC 0x64796e6au /**< "dynj": marks a descriptor */
/** Raised whenever JointType, CouplingType or a struct they use changes. */
#define DYN_PLUGIN_ABI_VERSION 6u

/** What the library compares before it uses a plugin. */
struct dyn_plugin_stamp {
  uint32_t magic;           /**< DYN_PLUGIN_MAGIC */
  uint32_t abi_version;     /**< DYN_PLUGIN_ABI_VERSION */
  uint32_t descriptor_size; /**< bytes of dyn_plugin_descriptor */
  uint32_t layout;          /**< sizes of all that crosses the boundary, folded into one number: dyn::sdk::layoutStamp */
  char compiler_abi[32];    /**< e.g. "itanium-x86_64-lp64" */
};

/** What a plugin exports. It lives as long as the plugin is loaded. */
struct dyn_plugin_descriptor {
  struct dyn_plugin_stamp stamp;     /**< comes first, so that it can be read in every version */
  uint32_t joint_type_count;         /**< entries of joint_types */
  uint32_t coupling_type_count;      /**< entries of coupling_types */
  const void* const* joint_types;    /**< const dyn::JointType* */
  const void* const* coupling_types; /**< const dyn::CouplingType* */
};

/** The name of the exported function: const struct dyn_plugin_descriptor* dyn_plugin_descriptor_v1(void); */
#define DYN_PLUGIN_ENTRY "dyn_plugin_descriptor_v1"

#endif
