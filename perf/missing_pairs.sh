#!/usr/bin/env bash
# Pairs that do not come: what the first frame after a gap costs a live run, how many frames of a camera that is too fast are processed, and
# how many frames are lost where only every second, third or fifth pair comes. Prints three tables; of live runs the best of REPEAT (3), as
# another program may have had the processor.
#   perf/missing_pairs.sh [DATA_FOLDER [OUT_FOLDER]]
set -euo pipefail
data=${1:-${MOTORCADE_DATA:-../shared/data}} out=${2:-results/missing_pairs}
motorcade=${MOTORCADE:-build/release/apps/motorcade}
repeat=${REPEAT:-3}
live=$data/kitti_tracking_0003
mkdir -p "$out"

run() { # DRIVE OPTION ...
  "$motorcade" run "$1" --out "$out/run" --force --quiet "${@:2}" >/dev/null 2>"$out/errors" || { cat "$out/errors" >&2; exit 1; }
}

# Prints "RATIO MS MEDIAN_MS DROPPED": of the first frame from FRAME on, and pairs dropped within ten after it.
first_after() { # FRAME
  awk -F, -v first="$1" '
    NR > 1 && $2 != "dropped" { latency[++n] = $4; if ($1 >= first && !taken) { taken = 1; at = $1; ms = $4 } }
    NR > 1 && $2 == "dropped" && $1 >= first && $1 < first + 10 { ++dropped }
    END {
      for (i = 2; i <= n; ++i) for (j = i; j > 1 && latency[j - 1] > latency[j]; --j) { t = latency[j]; latency[j] = latency[j - 1]; latency[j - 1] = t }
      median = latency[int((n + 1) / 2)]
      printf "%.1f %.1f %.1f %d\n", ms / median, ms, median, dropped
    }' "$out/run/frames.csv"
}

echo "| pairs missing at 10 Hz, live | first frame after them, in medians | ms | pairs dropped then |"
echo "| --- | --- | --- | --- |"
for gap in 40:45 40:50 40:60 20:40 60:80; do
  best=$(for ((i = 0; i < repeat; ++i)); do
    run "$live" --live --rate 10 --inject "drop@$gap"
    first_after "${gap#*:}"
  done | sort -n | head -1)
  read -r ratio ms _ dropped <<<"$best"
  echo "| $gap | $ratio | $ms | $dropped |"
done

echo
echo "| pairs per second, live | processed of $(find "$live/image_0" -name '*.png' | wc -l) |"
echo "| --- | --- |"
for rate in 30 60 100; do
  best=$(for ((i = 0; i < repeat; ++i)); do
    run "$live" --live --rate "$rate"
    awk -F, 'NR > 1 && $2 != "dropped" { ++n } END { print n }' "$out/run/frames.csv"
  done | sort -n | tail -1)
  echo "| $rate | $best |"
done

echo
echo "| drive | lost of every second pair | of every third | of every fifth |"
echo "| --- | --- | --- | --- |"
for drive in "$data"/*/; do
  [[ -d $drive/image_0 || -d $drive/mav0 ]] || continue
  row="| $(basename "$drive")"
  for step in 2 3 5; do
    missing=drop@1::$step
    for ((k = 2; k < step; ++k)); do missing+=,drop@$k::$step; done
    run "$drive" --inject "$missing"
    row+=" | $(awk -F, 'NR > 1 && $2 == "lost" { ++n } END { print n + 0 }' "$out/run/frames.csv")"
  done
  echo "$row |"
done
