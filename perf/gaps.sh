#!/usr/bin/env bash
# Gaps of random place and length (1 to 20 frames): is the error of the motion across each covered by the covariance that the run gives,
# or is the frame after it reported as lost? Prints a table. Needs jq. Called by perf/robustness.sh.
#   perf/gaps.sh COUNT "DRIVE ..." DATA_FOLDER OUT_FOLDER
set -euo pipefail
count=$1 drives=$2 data=$3 out=$4
motorcade=${MOTORCADE:-build/release/apps/motorcade}
mkdir -p "$out"
read -ra names <<<"$drives"

RANDOM=17
covered=0 lost=0 silent=0 worst=0
for ((gap = 0; gap < count; ++gap)); do
  drive=${names[gap % ${#names[@]}]}
  length=$((1 + RANDOM % 20)) start=$((12 + RANDOM % 20))
  after=$((start + length))
  "$motorcade" run "$data/$drive" --out "$out/gap" --force --frames "0:$((after + 2))" --inject "drop@$start:$after" >/dev/null 2>&1
  status=$(awk -F, -v frame=$after '$1 == frame { print $2 }' "$out/gap/frames.csv")
  if [[ $status == lost ]]; then
    lost=$((lost + 1))
    continue
  fi
  "$motorcade" evaluate "$out/gap" --sequence "$data/$drive" --json "$out/gap.json" >/dev/null
  nees=$(jq --arg frame "$after" '.covariance.camera_nees_by_frame[$frame] // 1e9' "$out/gap.json")
  worst=$(jq -n "[$worst, $nees] | max")
  if jq -ne "$nees < 16" >/dev/null; then covered=$((covered + 1)); else silent=$((silent + 1)); fi
done
echo "$count gaps of 1 to 20 frames. NEES is the normalized error squared of the motion across a gap, with 6 degrees of freedom. A gap is *silent* if its error is neither covered nor reported."
echo
echo "| covered (NEES < 16) | reported as lost | silent | greatest NEES |"
echo "| --- | --- | --- | --- |"
echo "| $covered | $lost | $silent | $(jq -n "$worst * 10 | round / 10") |"
