#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# documents.sh BUILD SOURCE: compiles and runs every program, builds and checks every joint plugin, and runs every command of README.md and of the
# documents in libdyn/doc, with the libdyn that install.sh has installed. Runs every Python program if BUILD has the module. Checks that links between
# the documents lead somewhere.
set -euo pipefail
umask 022
build=$1 source=$2
work=$build/documents-test
rm -rf "$work"
mkdir -p "$work"
export build prefix=$build/install-test/second work source
export PKG_CONFIG_PATH=$prefix/lib/pkgconfig:$(dirname "$(find "$prefix" -name libdyn.pc)")
export PATH=$prefix/bin:$PATH
documents=("$source/README.md" "$source"/libdyn/doc/*.md)

for document in "${documents[@]}"; do
  awk -v name="$work/$(basename "$document" .md)" '
    /^```(cpp|sh|python)$/ {kind = substr($0, 4); ++n; next}
    /^```$/ {kind = ""}
    kind {print > (name "-" n "." kind)}' "$document"
done

check() {
  set -euo pipefail
  local block=$1
  case $block in
    *.python)
      [ ! -d "$build/python" ] || PYTHONPATH=$build/python /usr/bin/python3 "$block" "$source/models/biped.urdf"
      ;;
    *.sh) (cd "$source" && bash -euo pipefail "$block") ;;
    *)
      if grep -q DYN_EXPORT "$block"; then
        g++ -std=c++20 -shared -fPIC "$block" -o "${block%.cpp}.so" $(pkg-config --cflags libdyn)
        chmod go-w "${block%.cpp}.so"
        env -u DYN_PLUGIN_PATH dyn plugin check "${block%.cpp}.so" --rounds 1
      else
        g++ -std=c++20 "$block" -o "${block%.cpp}" $(pkg-config --cflags --libs libdyn-parsers libdyn-geometry) \
          -Wl,-rpath,"$(pkg-config --variable=libdir libdyn)"
        "${block%.cpp}" "$source/models/biped.urdf"
      fi
      ;;
  esac
}
export -f check
failed=0
for block in "$work"/*.{cpp,sh,python}; do
  if ! output=$(check "$block" 2>&1); then
    printf '%s fails:\n%s\n' "$(basename "$block")" "$output" >&2
    failed=1
  fi
done

for document in "${documents[@]}" "$source"/libdyn/*.md; do
  for link in $(grep -oE '\]\([^) ]+\)' "$document" | sed 's/^](//; s/)$//; s/#.*//' | grep -vE '^(https?:|$)' | sort -u); do
    if [ ! -e "$(dirname "$document")/$link" ]; then
      echo "$document: the link $link leads nowhere" >&2
      failed=1
    fi
  done
done
[ $failed = 0 ] && echo "$(ls "$work"/*.cpp | wc -l) C++ programs, $(ls "$work"/*.python | wc -l) Python programs and $(ls "$work"/*.sh | wc -l) groups of commands run"
exit $failed
