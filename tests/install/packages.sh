#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# packages.sh BUILD SOURCE: makes the Debian packages, installs them into this system, runs the command, builds an example plugin and a program, and
# removes everything without a trace. Exits with 100 (skipped) without DYN_TEST_PACKAGES=1 or root, or where a package of that name is installed already.
set -euo pipefail
umask 022
build=$1 source=$2
if [ "$(id -u)" != 0 ] || ! command -v dpkg >/dev/null || ! command -v dpkg-shlibdeps >/dev/null; then
  echo "skipped: needs root, dpkg and dpkg-dev"
  exit 100
fi
if [ -z "${DYN_TEST_PACKAGES:-}" ]; then
  echo "skipped: it installs packages into this system; set DYN_TEST_PACKAGES=1 where that does no harm"
  exit 100
fi
names=(libdyn0 libdyn-plugins libdyn-tools libdyn-dev)
if [ -d "$build/python" ]; then names+=(python3-libdyn); fi
for name in "${names[@]}"; do
  if dpkg -s "$name" >/dev/null 2>&1; then
    echo "skipped: $name is installed already"
    exit 100
  fi
done
work=$build/packages-test
rm -rf "$work"
mkdir -p "$work"
(cd "$build" && cpack -B "$work" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log" >&2; exit 1; }
trap 'dpkg --purge "${names[@]}" >/dev/null 2>&1 || true' EXIT
dpkg -i "$work"/*.deb >"$work/install.log" 2>&1 || { cat "$work/install.log" >&2; exit 1; }

/usr/bin/dyn --version
/usr/bin/dyn demo "$source/models/biped.urdf" | tail -1
cp -r "$source/plugins/examples/cam_follower" "$work/cam_follower"
cmake -S "$work/cam_follower" -B "$work/cam_follower/build" -G Ninja >/dev/null
cmake --build "$work/cam_follower/build" >/dev/null
/usr/bin/dyn plugin check "$work/cam_follower/build/cam_follower.so" --rounds 1 | tail -1
cp -r "$source/tests/install/user" "$work/user"
cmake -S "$work/user" -B "$work/user/build" -G Ninja >/dev/null
cmake --build "$work/user/build" >/dev/null
DYN_PLUGIN_PATH=$work/cam_follower/build "$work/user/build/user" "$work/cam_follower/cam_follower.urdf"
if [ -d "$build/python" ]; then
  /usr/bin/python3 -c "import libdyn, sys; print(libdyn.compile(libdyn.load(sys.argv[1], root='free_flyer')))" "$source/models/biped.urdf"
fi

files=$(dpkg -L "${names[@]}" | sort -u | grep -E 'dyn' || true)
dpkg --purge "${names[@]}" >/dev/null
for file in $files; do
  if [ -e "$file" ]; then
    echo "$file is left behind" >&2
    exit 1
  fi
done
echo "packages install, work, and leave nothing behind"
