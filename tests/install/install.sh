#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# install.sh BUILD SOURCE: installs libdyn, builds example plugins and a user's program out of tree, and runs them with a `dyn` that is not rebuilt.
# Then it moves the installed tree elsewhere and runs it again.
set -euo pipefail
umask 022
build=$1 source=$2
work=$build/install-test
rm -rf "$work"
mkdir -p "$work"
say() { printf '== %s\n' "$*"; }

say "installing to $work/first"
cmake --install "$build" --prefix "$work/first" >/dev/null
prefix=$work/first
robot=$work/examples/cam_follower/cam_follower.urdf

say "completion, manual pages and schemas are where they are looked for"
for file in bash-completion/completions/dyn zsh/site-functions/_dyn fish/vendor_completions.d/dyn.fish man/man1/dyn.1 man/man1/dyn-plugin-check.1 \
  libdyn/schemas/states.schema.json; do
  [ -s "$prefix/share/$file" ] || { echo "share/$file is not installed" >&2; exit 1; }
done

say "building the examples out of tree"
cp -r "$source/plugins/examples" "$work/examples"
for folder in "$work"/examples/*/; do
  name=$(basename "$folder")
  cmake -S "$folder" -B "$folder/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
  cmake --build "$folder/build" >/dev/null
  # The plugin path contains another build of the same plugin.
  DYN_PLUGIN_PATH=$build/examples "$prefix/bin/dyn" plugin check "$folder/build/$name.so" --rounds 1 | tail -1
  for urdf in "$folder"/*.urdf; do DYN_PLUGIN_PATH=$folder/build "$prefix/bin/dyn" demo "$urdf" | tail -1; done
done

say "a plugin begun with dyn plugin new"
"$prefix/bin/dyn" plugin new my_joint --directory "$work" >/dev/null
cmake -S "$work/my_joint" -B "$work/my_joint/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$work/my_joint/build" >/dev/null
"$prefix/bin/dyn" plugin check "$work/my_joint/build/my_joint.so" --rounds 1 | tail -1
for command in check demo "simulate --time 0.1"; do
  DYN_PLUGIN_PATH=$work/my_joint/build "$prefix/bin/dyn" $command "$work/my_joint/my_joint.urdf" >/dev/null
done

export DYN_PLUGIN_PATH=$work/examples/cam_follower/build
say "a user's program with find_package"
cp -r "$source/tests/install/user" "$work/user"
cmake -S "$work/user" -B "$work/user/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$work/user/build" >/dev/null
"$work/user/build/user" "$robot"
say "the same with pkg-config"
export PKG_CONFIG_PATH=$prefix/lib/pkgconfig:$(dirname "$(find "$prefix" -name libdyn.pc)")
g++ -std=c++20 -O1 "$work/user/main.cpp" -o "$work/user/plain" $(pkg-config --cflags --libs libdyn-geometry libdyn-parsers) \
  -Wl,-rpath,"$(pkg-config --variable=libdir libdyn)"
"$work/user/plain" "$robot"

say "a component that is not there is refused by name"
printf 'cmake_minimum_required(VERSION 3.25)\nproject(p LANGUAGES CXX)\nfind_package(libdyn REQUIRED COMPONENTS simulation)\n' >"$work/CMakeLists.txt"
if cmake -S "$work" -B "$work/none" -DCMAKE_PREFIX_PATH="$prefix" >"$work/none.log" 2>&1; then
  echo "find_package accepted the component simulation" >&2
  exit 1
fi
grep -q "simulation is not part" "$work/none.log"

say "who does not ask for collision does not link it"
for library in libdyn.so libdyn_parsers.so; do
  if objdump -p "$(find "$prefix" -name $library)" | grep -E 'NEEDED.*(fcl|assimp|octomap|ccd|qhull)'; then
    echo "$library needs a library of collision" >&2
    exit 1
  fi
done

say "who reads URDF alone links neither libsdformat nor Lua"
for library in libdyn.so libdyn_urdf.so; do
  if objdump -p "$(find "$prefix" -name $library)" | grep -E 'NEEDED.*(sdformat|ignition|lua)'; then
    echo "$library needs the library of another format" >&2
    exit 1
  fi
done
g++ -std=c++20 -O1 "$source/tests/install/one_format/main.cpp" -o "$work/one" $(pkg-config --cflags --libs libdyn-urdf) \
  -Wl,-rpath,"$(pkg-config --variable=libdir libdyn)"
"$work/one" "$source/models/arm.urdf"
if ldd "$work/one" | grep -E 'sdformat|lua'; then
  echo "a program that reads URDF alone links another format" >&2
  exit 1
fi
cp -r "$source/tests/install/one_format" "$work/one_format"
cmake -S "$work/one_format" -B "$work/one_format/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$work/one_format/build" >/dev/null
"$work/one_format/build/one_format" "$source/models/arm.urdf"

say "the installed command reads every format that was built"
for model in "$source"/models/arm.*; do
  case $model in
    *.sdf) library=libdyn_sdf.so ;;
    *.lua) library=libdyn_lua.so ;;
    *) library=libdyn_urdf.so ;;
  esac
  if [ -n "$(find "$prefix" -name "$library")" ]; then "$prefix/bin/dyn" info "$model" --quiet | head -1; fi
done

say "the installed tree moved"
mv "$work/first" "$work/second"
"$work/second/bin/dyn" info "$robot" | head -4
module=$(find "$work/second" -path '*-packages/libdyn')
if [ -n "$module" ]; then
  PYTHONPATH=$(dirname "$module") /usr/bin/python3 -c "
import libdyn, sys
print(libdyn.compile(libdyn.load(sys.argv[1], root='free_flyer')))
assert sys.argv[2] + '/lib' in open('/proc/self/maps').read()" "$source/models/biped.urdf" "$work/second"
elif [ -d "$build/python" ]; then
  echo "the Python module is not installed" >&2
  exit 1
fi
