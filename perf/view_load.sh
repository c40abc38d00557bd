#!/usr/bin/env bash
# Measures what the page costs a run: p99 latency and CPU per frame at camera rate without --view, with it and no viewer, with one, and with
# eight of which one is stalled. A viewer takes every event and its image, as the page does. The kinds take turns; medians over the rounds,
# also in units of what decoding a pair took in the same run (decode_ms of frames.csv), which is less than libpng takes. Needs curl and jq; loopback only.
#   perf/view_load.sh [ROUNDS] [SEQUENCE]
set -euo pipefail
cd "$(dirname "$0")/.."
rounds=${1:-3}
sequence=${2:-${MOTORCADE_DATA:-../shared/data}/rendered_street}
motorcade=${MOTORCADE:-build/release/apps/motorcade}
for tool in curl jq; do command -v $tool >/dev/null || { echo "perf/view_load.sh needs $tool: apt-get install $tool" >&2; exit 1; }; done
out=$(mktemp -d)
started=()
end_viewers() {
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  started=()
}
trap 'end_viewers; rm -rf "$out"' EXIT

viewer() {  # URL PORT: takes each event, then the image that it names
  local line number
  # Without a program for each image, whose start would cost more than what is measured.
  curl -sN --max-time 120 "$1events" | while read -r line; do
    [[ $line =~ \"frame\":\{\"frame\":([0-9]+) ]] || continue
    number=${BASH_REMATCH[1]}
    exec 3<>"/dev/tcp/127.0.0.1/$2" || break
    printf 'GET /image/%s.jpg HTTP/1.1\r\nHost: 127.0.0.1:%s\r\nConnection: close\r\n\r\n' "$number" "$2" >&3
    LC_ALL=C read -r -d '' -n 4000000 -u 3 _ || true
    exec 3<&-
  done
}
stalled() {  # PORT: asks for events and never reads one
  exec 3<>"/dev/tcp/127.0.0.1/$1"
  printf 'GET /events HTTP/1.1\r\nHost: 127.0.0.1:%s\r\n\r\n' "$1" >&3
  sleep 120
}

measure() {  # KIND
  local options=(--rate 10 --force -q) url="" port viewers=0 run
  [[ $1 == without ]] || options+=(--view 127.0.0.1:0)
  case $1 in one) viewers=1 ;; eight) viewers=7 ;; esac
  "$motorcade" run "$sequence" --out "$out/run" "${options[@]}" 2>"$out/log" &
  run=$!
  started+=("$run")
  if [[ $1 != without ]]; then
    for _ in $(seq 100); do
      url=$(sed -n 's/^the page is at \([^#]*\).*$/\1/p' "$out/log")  # without the token
      [[ -z $url ]] || break
      sleep 0.02
    done
    port=${url##*:} port=${port%/}
    for _ in $(seq "$viewers"); do viewer "$url" "$port" 2>/dev/null & started+=($!); done
    if [[ $1 == eight ]]; then stalled "$port" 2>/dev/null & started+=($!); fi
  fi
  wait "$run" || { cat "$out/log" >&2; exit 1; }
  end_viewers
  local unit
  unit=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "decode_ms") column = i } NR > 1 { print $column }' "$out/run/frames.csv" | sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }')
  jq -r --arg kind "$1" --argjson unit "$unit" \
    '[$kind, .latency_ms.p50, .latency_ms.p99, 1000 * .cpu_s / .frames.received, $unit] | @tsv' "$out/run/summary.json" >>"$out/rows"
}

for _ in $(seq "$rounds"); do
  for kind in without nobody one eight; do measure "$kind"; done
done
median() { sort -n | awk '{ v[NR] = $1 } END { print (v[int((NR + 1) / 2)] + v[int(NR / 2) + 1]) / 2 }'; }
printf '%-10s %10s %10s %14s %10s %14s\n' viewers "p50 ms" "p99 ms" "CPU ms/frame" "unit ms" "p99 - without"
base=$(awk -F'\t' '$1 == "without" { print $3 }' "$out/rows" | median)
for kind in without nobody one eight; do
  column() { awk -F'\t' -v kind=$kind -v column="$1" '$1 == kind { print $column }' "$out/rows" | median; }
  awk -v kind=$kind -v p50="$(column 2)" -v p99="$(column 3)" -v cpu="$(column 4)" -v unit="$(column 5)" -v base="$base" \
    'BEGIN { printf "%-10s %10.1f %10.1f %14.1f %10.2f %8.2f units\n", kind, p50, p99, cpu, unit, (p99 - base) / unit }'
done
