#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# examples.sh BUILD SOURCE: builds each project of tools/examples against the libdyn that install.sh has installed, and runs it. Each checks its result.
set -euo pipefail
umask 022
build=$1 source=$2
export prefix=$build/install-test/second work=$build/examples-test source
export LIBDYN_CACHE=$work/cache
rm -rf "$work"
mkdir -p "$work/cache"

run() {
  set -euo pipefail
  local name=$1
  cmake -S "$source/tools/examples/$name" -B "$work/$name" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O1 -DCMAKE_PREFIX_PATH="$prefix"
  cmake --build "$work/$name"
  printf -- '-- %s\n' "$name"
  (cd "$source" && "$work/$name/$name")
}
export -f run
failed=0
for folder in "$source"/tools/examples/*/; do
  name=$(basename "$folder")
  if output=$(run "$name" 2>&1); then
    sed -n '/^-- '"$name"'$/,$p' <<<"$output"
  else
    printf '%s fails:\n%s\n' "$name" "$output" >&2
    failed=1
  fi
done
exit $failed
