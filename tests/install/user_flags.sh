#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# user_flags.sh BUILD SOURCE: compiles a user's program and a plugin with different flags each (alignment, instruction sets, assertions, another
# compiler) against the libdyn that install.sh has installed. All combinations run under AddressSanitizer and must agree.
set -euo pipefail
umask 022
build=$1 source=$2
prefix=$build/install-test/second
work=$build/install-test/flags
rm -rf "$work"
mkdir -p "$work"
export PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name libdyn.pc)")
read -r -a libdyn <<<"$(pkg-config --cflags --libs libdyn-geometry libdyn-parsers) -Wl,-rpath,$(pkg-config --variable=libdir libdyn)"

variants=("g++ -O1" "g++ -O2 -march=native -DNDEBUG" "g++ -O0 -DEIGEN_MAX_ALIGN_BYTES=0" "g++ -O1 -DEIGEN_MAX_ALIGN_BYTES=64 -march=native")
if echo 'int main() {}' | clang++-16 -fsanitize=address -x c++ - -o "$work/probe" 2>/dev/null; then
  variants+=("clang++-16 -O1" "clang++-16 -O2 -march=native -DNDEBUG")
else
  echo "skipped: clang++-16 with its AddressSanitizer is not installed, so there is no other compiler"
fi

# The AddressSanitizer runtimes of two compilers do not mix in one process. So a program runs with sanitized plugins of its own compiler and with
# plain plugins of the other.
plugin() {  # index, suffix, extra flags
  mkdir -p "$work/plugin$1$2"
  ${variants[$1]} $3 -std=c++20 -fPIC -shared -fvisibility=hidden "${libdyn[0]}" "$source/plugins/examples/cam_follower/cam_follower.cpp" \
    -o "$work/plugin$1$2/cam_follower.so"
}
for i in "${!variants[@]}"; do
  ${variants[$i]} -fsanitize=address -fno-omit-frame-pointer -std=c++20 "$source/tests/install/user/main.cpp" -o "$work/user$i" "${libdyn[@]}" &
  plugin "$i" "" "" &
  plugin "$i" "-asan" "-fsanitize=address" &
  wait
done

read -r -a headers <<<"$(pkg-config --cflags libdyn-geometry libdyn-parsers)"
for compiler in "${variants[@]%% *}"; do echo "$compiler"; done | sort -u | while read -r compiler; do
  $compiler -std=c++20 -fsyntax-only -Wall -Wextra -Werror "$source/tests/install/user/main.cpp" "${headers[@]}" ||
    { echo "a user who asks $compiler for warnings gets some" >&2; exit 1; }
done

# Macros that change the layout of containers are refused by name when the program is compiled.
for macro in _GLIBCXX_DEBUG _GLIBCXX_USE_CXX11_ABI=0; do
  if g++ -std=c++20 -fsyntax-only "-D$macro" "$source/tests/install/user/main.cpp" "${headers[@]}" 2>"$work/refusal"; then
    echo "a program with $macro compiles, and would crash" >&2
    exit 1
  fi
  grep -q "${macro%=*}.* libdyn" "$work/refusal" || { echo "nothing says that $macro is wrong:" >&2; cat "$work/refusal" >&2; exit 1; }
done

expected=
runs=0
for i in "${!variants[@]}"; do
  for k in "${!variants[@]}"; do
    suffix=
    [ "${variants[$i]%% *}" = "${variants[$k]%% *}" ] && suffix=-asan
    answer=$(DYN_PLUGIN_PATH=$work/plugin$k$suffix "$work/user$i" "$source/plugins/examples/cam_follower/cam_follower.urdf") ||
      { echo "program '${variants[$i]}' with plugin '${variants[$k]}' failed" >&2; exit 1; }
    # Sums in another order or with fused operations may differ in the last digits.
    rounded=$(awk '{printf "%.11e %.11e %.11e", $2, $4, $6}' <<<"$answer")
    [ "${expected:=$rounded}" = "$rounded" ] ||
      { echo "program '${variants[$i]}' with plugin '${variants[$k]}' says $rounded, not $expected" >&2; exit 1; }
    runs=$((runs + 1))
  done
done
echo "$runs combinations of ${#variants[@]} sets of flags agree: $expected"
