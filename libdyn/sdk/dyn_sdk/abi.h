/* SPDX-License-Identifier: BSD-2-Clause */
/* The handshake between libdyn and a plugin: a C descriptor that the function "dyn_plugin_descriptor_v1" returns. */
#ifndef DYN_SDK_ABI_H
#define DYN_SDK_ABI_H

#include <stdint.h>

#define DYN_PLUGIN_MAGIC 0x64796e6au /* "dynj" */
/* Raised whenever JointType, CouplingType or a struct they use changes. */
#define DYN_PLUGIN_ABI_VERSION 6u

/* What the library compares before it uses a plugin. */
struct dyn_plugin_stamp {
  uint32_t magic;
  uint32_t abi_version;
  uint32_t descriptor_size;
  uint32_t layout;       /* sizes of all that crosses the boundary, folded into one number: dyn::sdk::layoutStamp */
  char compiler_abi[32]; /* e.g. "itanium-x86_64-lp64" */
};

struct dyn_plugin_descriptor {
  struct dyn_plugin_stamp stamp;
  uint32_t joint_type_count;
  uint32_t coupling_type_count;
  const void* const* joint_types;    /* const dyn::JointType* */
  const void* const* coupling_types; /* const dyn::CouplingType* */
};

/* The exported function: const struct dyn_plugin_descriptor* dyn_plugin_descriptor_v1(void); */
#define DYN_PLUGIN_ENTRY "dyn_plugin_descriptor_v1"

#endif
