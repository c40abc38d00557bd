#!/usr/bin/env bash
# Runs the vehicle stack as a whole: vehicle_stack_test.sh PROGRAM DRIVE stalls|blind|stopped|reader_gone
# What it expects does not depend on how fast the machine is.
set -euo pipefail
program=$1 drive=$2 what=$3
folder=$(mktemp -d)
pid=
trap '[[ -z $pid ]] || kill -KILL "$pid" 2>/dev/null || true; rm -rf "$folder"' EXIT
messages=$folder/messages errors=$folder/errors
touch "$messages" "$errors"

fail() {
  echo "FAILED: $1"
  cat "$errors"
  exit 1
}

check_end() {  # EXIT_CODE: the last line's counts agree with each other and with the messages
  local line
  cat "$errors"
  line=$(tail -1 "$errors")
  [[ $line =~ ([0-9]+)\ pushed\ =\ ([0-9]+)\ rejected\ \+\ ([0-9]+)\ dropped\ \+\ ([0-9]+)\ results\ \+\ ([0-9]+)\ abandoned ]] ||
    fail "no last line of counts"
  local pushed=${BASH_REMATCH[1]} rejected=${BASH_REMATCH[2]} dropped=${BASH_REMATCH[3]} results=${BASH_REMATCH[4]} abandoned=${BASH_REMATCH[5]}
  [[ $((rejected + dropped + results + abandoned)) -eq $pushed && $abandoned -eq 0 ]] || fail "the counts do not agree"
  [[ $(grep -c '"type":"frame"' "$messages") -eq $results ]] || fail "not each result was published"
  if [[ $line == *"ended blind" ]]; then [[ $1 -eq 1 ]]; else [[ $1 -eq 0 ]]; fi || fail "exit code $1 after: $line"
}

run() {
  local code=0
  timeout 100 "$program" "$drive" "$@" >"$messages" 2>"$errors" || code=$?
  check_end "$code"
}

case $what in
  stalls)
    run --loops 25 --stall-at 2 --stall-for 2
    grep -q '"level":"blind".*"objects_valid":false' "$messages" || fail "the objects were not declared stale"
    ;;
  blind)  # the camera never comes back
    run --loops 8 --stall-at 1 --stall-for 1000
    grep -q 'ended blind' "$errors" || fail "it did not end blind"
    ;;
  stopped)
    "$program" "$drive" --loops 1000000 >"$messages" 2>"$errors" &
    pid=$!
    for _ in $(seq 600); do
      [[ $(wc -l <"$messages") -lt 30 ]] || break
      sleep 0.1
    done
    kill -TERM "$pid"
    for _ in $(seq 100); do
      kill -0 "$pid" 2>/dev/null || break
      sleep 0.1
    done
    if kill -0 "$pid" 2>/dev/null; then fail "it still runs ten seconds after SIGTERM"; fi
    code=0
    wait "$pid" || code=$?
    pid=
    check_end "$code"
    ;;
  reader_gone)
    { timeout 100 "$program" "$drive" --loops 1000000 2>"$errors" || echo "$?" >"$folder/code"; } | head -3 >"$messages"
    [[ ! -e $folder/code ]] || fail "exit code $(cat "$folder/code")"
    ;;
esac
echo "as expected"
