#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# subproject.sh BUILD SOURCE [whole]: configures a user's project that contains libdyn, by add_subdirectory and by FetchContent, without network. It
# compiles the project's program and plugin. `whole` also builds libdyn and runs the program, which takes many minutes.
set -euo pipefail
umask 022
build=$1 source=$2 whole=${3:-}
work=$build/subproject-test
rm -rf "$work"
mkdir -p "$work/plain"

# The names of a cache's entries that users see.
names() { sed -nE '/:(INTERNAL|STATIC)=/!s/^([A-Za-z0-9_]+):.*/\1/p' "$1/CMakeCache.txt" | sort; }
# libdyn may enter its own options and what find_package finds. GNUInstallDirs is in the plain project.
permitted='DYN_[A-Z_]+|(Boost|Eigen3|assimp|boost_[a-z]+|ccd|draco|fcl|nlohmann_json|octomap|sdformat12|console_bridge|urdfdom_headers)_DIR|Boost_(INCLUDE_DIR|FILESYSTEM_LIBRARY_[A-Z]+)|PKG_CONFIG_(ARGN|EXECUTABLE)'
permitted+='|pkgcfg_lib_TINYXML2_tinyxml2|QHULL_R_LIBRARY|XSIMD_INCLUDE_DIR|BY_FETCHCONTENT|LIBDYN_(SOURCE|EXAMPLES)|FETCHCONTENT_[A-Z_]+'
printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(user LANGUAGES CXX)' 'include(GNUInstallDirs)' >"$work/plain/CMakeLists.txt"
cmake -S "$work/plain" -B "$work/plain" -G Ninja >/dev/null

for by in OFF ON; do
  folder=$work/fetchcontent-$by
  cmake -S "$source/tests/install/subproject" -B "$folder" -G Ninja -DBY_FETCHCONTENT=$by -DDYN_INSTRUCTION_SETS=native \
    -DLIBDYN_SOURCE="$source" -DFETCHCONTENT_SOURCE_DIR_LIBDYN="$source" -DLIBDYN_EXAMPLES="$source/plugins/examples" >"$folder.log" 2>&1 ||
    { cat "$folder.log" >&2; exit 1; }
  if comm -13 <(names "$work/plain") <(names "$folder") | grep -vxE "$permitted" >&2 ||
    grep -E '^(CMAKE_BUILD_TYPE:STRING=.|DYN_BUILD_(TOOLS|TESTS|BENCHMARKS):BOOL=ON)' "$folder/CMakeCache.txt" >&2; then
    echo "libdyn changes the cache of the project that contains it, or builds more than its libraries" >&2
    exit 1
  fi
  targets=$(ninja -C "$folder" -t targets all)
  if grep -E '^(package|package_source|test):' <<<"$targets" >&2; then
    echo "libdyn adds targets to the project that contains it" >&2
    exit 1
  fi
  if grep -rE --include=cmake_install.cmake 'libdyn.*\.so|dyn_standard' "$folder" >&2; then
    echo "libdyn installs itself with the project that contains it" >&2
    exit 1
  fi
  plugins=$(sed -n 's/^\(my_joint[a-z0-9_]*\): phony.*/\1/p' <<<"$targets")
  ninja -C "$folder" program $plugins >"$folder.log" 2>&1 || { cat "$folder.log" >&2; exit 1; }
  "$build/bin/dyn" plugin check "$folder/plugins/my_joint.so" --rounds 1 | tail -1
  sets=$(sed -n 's/^dyn_kernels_\([a-z0-9]*\): phony.*/\1/p' <<<"$targets")
  [ "$sets" = baseline ] || [ -f "$folder/plugins/$sets/my_joint.so" ] || { echo "no plugin for the instruction set $sets" >&2; exit 1; }
done

# The folder for colcon contains libdyn, too, but installs it.
cmake -S "$source/tools/ros" -B "$work/ros" -G Ninja -DDYN_INSTRUCTION_SETS=native >"$work/ros.log" 2>&1 || { cat "$work/ros.log" >&2; exit 1; }
for file in dyn_standard.so libdyn_geometry.so bin/dyn libdynConfig.cmake; do
  grep -rq --include=cmake_install.cmake "$file" "$work/ros" || { echo "tools/ros does not install $file" >&2; exit 1; }
done

if [ -n "$whole" ]; then
  cmake --build "$work/fetchcontent-OFF" --target user
  DYN_PLUGIN_PATH=$work/fetchcontent-OFF/plugins "$work/fetchcontent-OFF/user" "$source/plugins/examples/cam_follower/cam_follower.urdf"
fi
