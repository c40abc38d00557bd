#!/usr/bin/env bash
# Tests what bash completes behind `motorcade`, and that each command has its manual page: manual_test.sh MOTORCADE [PAGES]
set -euo pipefail
motorcade=$1 pages=${2:-}
source "$(dirname "$0")/../../../apps/manual/motorcade.bash"
failures=0

# completes WORDS... : what the last word may become, on one line
completes() {
  COMP_WORDS=("$motorcade" "$@") COMP_CWORD=$# COMPREPLY=()
  _motorcade "$motorcade" "${*: -1}" "" || true
  echo "${COMPREPLY[*]:-}"
}

# expect WANTED WORDS...
expect() {
  local wanted=$1 seen
  shift
  seen=$(completes "$@")
  [[ $seen == "$wanted" ]] || { echo "motorcade $*: wanted '$wanted', got '$seen'"; failures=$((failures + 1)); }
}

bridge=$("$motorcade" --help | sed -n 's/^  \(bridge\) .*/ \1/p')  # not in every build
expect "run check synth evaluate draw report latency export view solve batch$bridge help" ""
expect "solve" so
expect "latency" help la
expect "status" batch st
expect "--rate --require" run --r
expect "overtake" synth --scene ov
expect "overtake" synth --scene = ov
expect "warning" run DRIVE --log-level w
expect "" run DRIVE       # a folder, which readline completes
expect "" run --out RU
expect "" synth --out sy  # a folder that begins as a command does
expect "--quiet" --q

if [[ $pages ]]; then
  for command in $(completes ""); do
    [[ $command == help ]] && continue
    page=$pages/motorcade-$command.1
    grep -q "^motorcade-$command .- " "$page" 2>/dev/null || { echo "$page has no name"; failures=$((failures + 1)); continue; }
    for option in $("$motorcade" "$command" --help | sed -n 's/^  \(--[a-z-]*\).*/\1/p'); do
      grep -qF -- "${option//-/\\-}" "$page" || { echo "$page lacks $option"; failures=$((failures + 1)); }
    done
  done
  ! grep -l "$PWD" "$pages"/*.1 || { echo "these pages name the folder of the build"; failures=$((failures + 1)); }
fi
exit "$((failures > 0))"
