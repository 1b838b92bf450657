// A plugin with nothing in it.
#include <dyn_sdk/joint_plugin.hpp>

DYN_EXPORT_JOINTS()
