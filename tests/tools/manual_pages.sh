#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# manual_pages.sh BUILD: writes the manual pages and formats each with all of groff's warnings. Exits with 100 (skipped) without groff.
set -euo pipefail
build=$1
command -v groff >/dev/null || { echo "skipped: needs groff"; exit 100; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*" >&2; exit 1; }

"$build/bin/dyn" help --man-pages "$work"
for command in "" -info -simulate -plugin -plugin-check -completion; do
  [ -s "$work/dyn$command.1" ] || fail "there is no page dyn$command.1"
done
for page in "$work"/*.1; do
  groff -man -ww -Tutf8 "$page" >"$work/text" 2>"$work/warnings"
  [ ! -s "$work/warnings" ] || fail "$(cat "$work/warnings")"
  # Bold letters are written twice, with a backspace or between escape sequences.
  sed -i 's/.\x08//g; s/\x1b\[[0-9;]*m//g' "$work/text"
  grep -q '^NAME' "$work/text" && grep -q '^SYNOPSIS' "$work/text" || fail "$page: a section is missing"
done
"$build/bin/dyn" help simulate --man | cmp - "$work/dyn-simulate.1" || fail "dyn help --man and --man-pages differ"
# Each option that --help lists has its entry.
described=0
for option in $("$build/bin/dyn" simulate --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+'); do
  grep -qF -- "\\fB$(sed 's/-/\\-/g' <<<"$option")\\fR" "$work/dyn-simulate.1" || fail "dyn-simulate.1 does not describe $option"
  described=$((described + 1))
done
[ $described -ge 10 ] || fail "only $described options were found in --help"
echo "$(ls "$work"/*.1 | wc -l) manual pages are well formed"
