#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# completion.sh BUILD: sources the script for bash and completes lines with it. Checks the scripts of zsh and fish with these shells where they are.
set -euo pipefail
build=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*" >&2; exit 1; }

for shell in bash zsh fish; do "$build/bin/dyn" completion $shell >"$work/dyn.$shell"; done
# Outside of a completion, bash refuses compopt.
compopt() { :; }
. "$work/dyn.bash"

# complete_line EXPECTED WORD...: the last word is completed; the answers must be the expected words, in any order.
complete_line() {
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
  _dyn
  local found
  found=$(printf '%s\n' "${COMPREPLY[@]}" | sort | xargs)
  [ "$found" = "$(xargs -n1 <<<"$expected" | sort | xargs)" ] || fail "'$*' is completed by '$found', not by '$expected'"
}
complete_line "check codegen collide completion compute convert" dyn c
complete_line "demo diff" dyn d
complete_line "--q --quiet" dyn compute --q
complete_line "list check new" dyn plugin ""
complete_line "--integrator" dyn simulate --int
complete_line "simulate sweep" dyn s
complete_line "--replay --resume" dyn sweep --re
complete_line "--integrator" dyn simulate robot.urdf --time 5 --int
complete_line "semi_implicit_euler" dyn simulate --integrator se
complete_line "semi_implicit_euler" dyn simulate --integrator = se
complete_line "independent coupled" dyn info --mimic ""
complete_line "rnea,crba" dyn codegen --functions rnea,crb
complete_line "bash zsh fish" dyn completion ""
complete_line "--rounds" dyn plugin check x.so --ro
complete_line "--embed-meshes" dyn convert --em
complete_line "info" dyn --quiet in
complete_line "" dyn info --lock ""
cd "$work"
mkdir folder
touch robot.urdf "robot two.urdf"
complete_line "robot.urdf" dyn info robot.
complete_line "robot.urdf" dyn simulate --time 5 robot.
complete_line "folder" dyn plugin new x --directory f
COMP_WORDS=(dyn info rob) COMP_CWORD=2
_dyn
[ ${#COMPREPLY[@]} = 2 ] || fail "a file's name with a space is not one answer"

# Every option that --help lists is offered.
offered=0
for command in info convert simulate sweep bench "plugin check"; do
  for option in $("$build/bin/dyn" $command --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+'); do
    complete_line_words=(dyn $command "$option")
    COMP_WORDS=("${complete_line_words[@]}") COMP_CWORD=$((${#complete_line_words[@]} - 1))
    _dyn
    [[ " ${COMPREPLY[*]} " == *" $option "* ]] || fail "dyn $command: $option is not offered"
    offered=$((offered + 1))
  done
done
[ $offered -ge 40 ] || fail "only $offered options were found in --help"
if command -v zsh >/dev/null; then zsh -n "$work/dyn.zsh"; fi
if command -v fish >/dev/null; then
  export HOME=$work XDG_CONFIG_HOME=$work
  answers() { fish --no-config -c "source $work/dyn.fish; complete -C '$1'" | cut -f1 | sort | xargs; }
  [ "$(answers 'dyn simulate --integrator se')" = semi_implicit_euler ] || fail "fish: $(answers 'dyn simulate --integrator se')"
  [ "$(answers 'dyn plugin ')" = "check list new" ] || fail "fish: $(answers 'dyn plugin ')"
  [ "$(answers 'dyn plugin check --ro')" = "--rounds" ] || fail "fish: $(answers 'dyn plugin check --ro')"
fi
echo "the shells complete dyn"
