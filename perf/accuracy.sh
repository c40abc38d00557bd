#!/usr/bin/env bash
# Measures accuracy and prints the README's tables: runs every real drive that is there, and every synthetic scene (rendered once, with
# seed 1), and evaluates each against its truth. Needs jq.
#   perf/accuracy.sh [DATA_FOLDER] [OUT_FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
data=${1:-${MOTORCADE_DATA:-../shared/data}}
out=${2:-results/accuracy}
motorcade=${MOTORCADE:-build/release/apps/motorcade}
seed=1
command -v jq >/dev/null || { echo "perf/accuracy.sh needs jq: apt-get install jq" >&2; exit 1; }
mkdir -p "$out"

run_and_evaluate() {  # NAME SEQUENCE [RUN OPTIONS ...]
  local name=$1 sequence=$2
  shift 2
  "$motorcade" run "$sequence" --out "$out/$name" "$@" >"$out/$name.log" 2>&1
  "$motorcade" evaluate "$out/$name" --sequence "$sequence" --json "$out/$name.json" >"$out/$name.txt"
}

camera_row() {  # NAME JSON
  jq -r --arg name "$1" 'def f(n): . * pow(10; n) | round / pow(10; n);
    .frames as $n | .final.camera |
    "| \($name) | \($n) | \(.ate_m.rmse | f(3)) | \(.end_error_percent | f(2)) % | \(.rpe_t_m.rmse | f(4)) / \(.rpe_t_m.median | f(4)) | \(.rpe_r_deg.rmse | f(4)) / \(.rpe_r_deg.median | f(4)) |"' "$2"
}

object_row() {  # NAME JSON
  jq -r --arg name "$1" 'def f(n): . * pow(10; n) | round / pow(10; n);
    def share: if (.labels // 0) == 0 then "-" else "\(100 * .recall | f(0)) % (\(.found)/\(.labels))" end;
    def mean(n): if (.count // 0) == 0 then "-" else .mean | f(n) end;
    .final as $x | $x.detection as $d |
    if $d.rows == null then "| \($name) | no labels | | | | | | |" else
    "| \($name) | \($d.within_30m | share) | \($d.from_30_to_50m | share) | \($d.false_rows) of \($d.rows) | \($d.id_switches) | \($x.motion.me_t_m | mean(3)) | \($x.motion.me_r_deg | mean(2)) | \($x.motion.speed_error_mps | mean(2)) |" end' "$2"
}

drives=()
for drive in kitti_tracking_0003 kitti_odometry_04 kitti_odometry_06 rendered_street; do
  if [[ -d $data/$drive ]]; then
    run_and_evaluate "$drive" "$data/$drive"
    drives+=("$drive")
  else
    echo "$drive is not in $data: skipped" >&2
  fi
done
scenes=(overtake highway urban static crossing lead stop_and_go convoy circuit)
for scene in "${scenes[@]}"; do
  length=()
  [[ $scene == circuit ]] && length=(--frames 200)  # a third of the lap
  [[ -f $out/sequences/$scene/times.txt ]] ||
    "$motorcade" synth "$out/sequences/$scene" --scene "$scene" --seed $seed "${length[@]}" >/dev/null
  run_and_evaluate "$scene" "$out/sequences/$scene"
done

echo "| drive | frames | ATE m | end error | RPE_t m rmse / median | RPE_r deg rmse / median |"
echo "| --- | --- | --- | --- | --- | --- |"
for name in "${drives[@]}" "${scenes[@]}"; do camera_row "$name" "$out/$name.json"; done
echo
echo "| drive | recall to 30 m | 30 to 50 m | false rows | id switches | ME_t m | ME_r deg | mean speed error m/s |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- |"
for name in "${drives[@]}" "${scenes[@]}"; do object_row "$name" "$out/$name.json"; done
