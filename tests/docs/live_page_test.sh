#!/usr/bin/env bash
# Runs the commands at the top of docs/guide_live.md as they stand there, in an empty folder: blocks that follow a comment with this file's
# name. Exits with 77 where a program that they need is missing or their port is taken.
#   tests/docs/live_page_test.sh MOTORCADE BRIDGE_SUBSCRIBER
set -euo pipefail
page=$(realpath "$(dirname "$0")/../../docs/guide_live.md")
PATH=$(dirname "$(realpath "$1")"):$(dirname "$(realpath "$2")"):$PATH

skipped=77
for program in ffmpeg curl jq; do
  command -v $program >/dev/null || { echo "$program is not installed: the page is not tried"; exit $skipped; }
done
if (exec 3<>/dev/tcp/127.0.0.1/8080) 2>/dev/null; then echo "port 8080 is taken: the page is not tried"; exit $skipped; fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
awk '/^<!-- tests\/docs\/live_page_test.sh / { named = 1; next }
  /^```/ { inside = named; named = 0; next }
  inside' "$page" >commands
echo wait >>commands
timeout 120 bash commands >said 2>&1 || { cat said; exit 1; }

expect() { # at least $1 lines of the form $2
  local found
  found=$(grep -cE "$2" said || true)
  ((found >= $1)) || { cat said run.log; echo "$found lines, not $1, of the form: $2"; exit 1; }
}
expect 5 '^frame [0-9]+: object [0-9]+, [0-9.]+ m/s, [0-9.]+ m away$'  # the newest frames: how many is the machine's affair
expect 40 '^[0-9.]+ s: object [0-9]+, [0-9.]+ m/s, sigma [0-9.]+, at \[[-0-9.]+,[-0-9.]+\] m$'
[[ $(jq .complete RUN/summary.json) == true ]] || { cat run.log; echo "the run is not complete"; exit 1; }
grep -q "the vehicle's own motion is known" run.log || { cat run.log; echo "the vehicle's motion was not taken"; exit 1; }
echo "the commands of the page do what it says"
