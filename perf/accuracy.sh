#!/usr/bin/env bash
# Measures accuracy and prints the README's tables: runs every real drive that is there, and every synthetic scene (rendered once for
# each seed), with each back-end, and evaluates all against the truth. Figures of scenes are means over the seeds. Needs jq.
#   perf/accuracy.sh [--seeds 1-5] [--backends "KIND ..."] [--against KIND] [--drives "NAME ..."] [--sequences FOLDER]
#                    [DATA_FOLDER] [OUT_FOLDER]
# --backends   kinds of back-end (backend.kind), side by side; the configuration's own one when absent
# --against    the kind that relative errors are taken against, where it is among them; filter when absent
# --drives     only these drives and scenes
# --sequences  where scenes are rendered to; OUT_FOLDER/sequences when absent
set -euo pipefail
cd "$(dirname "$0")/.."
seeds=1 backends=default against=filter wanted="" sequences="" folders=()
while (($#)); do
  case $1 in
    --seeds) seeds=$2 && shift 2 ;;
    --backends) backends=$2 && shift 2 ;;
    --against) against=$2 && shift 2 ;;
    --drives) wanted=" $2 " && shift 2 ;;
    --sequences) sequences=$2 && shift 2 ;;
    -*) sed -n '4,9s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    *) folders+=("$1") && shift ;;
  esac
done
data=${folders[0]:-${MOTORCADE_DATA:-../shared/data}}
out=${folders[1]:-results/accuracy}
sequences=${sequences:-$out/sequences}
motorcade=${MOTORCADE:-build/release/apps/motorcade}
[[ $seeds =~ ^([0-9]+)-([0-9]+)$ ]] && seeds=$(seq -s " " "${BASH_REMATCH[1]}" "${BASH_REMATCH[2]}")
command -v jq >/dev/null || { echo "perf/accuracy.sh needs jq: apt-get install jq" >&2; exit 1; }
mkdir -p "$out"

is_wanted() { [[ -z $wanted || $wanted == *" $1 "* ]]; }

run_all() {  # NAME SEQUENCE: a run and its evaluation for every back-end
  local backend
  for backend in $backends; do
    local kind=() masks=()
    [[ ! -d $2/instance ]] || masks=(--masks)  # there is truth to compare them with
    [[ $backend == default ]] || kind=(--set "backend.kind=\"$backend\"")
    mkdir -p "$out/$backend"
    "$motorcade" run "$2" --out "$out/$backend/$1" --force "${kind[@]}" "${masks[@]}" >"$out/$backend/$1.log" 2>&1
  done
  for backend in $backends; do
    local baseline=()
    [[ $backend != "$against" && " $backends " == *" $against "* ]] && baseline=(--baseline-run "$out/$against/$1")
    "$motorcade" evaluate "$out/$backend/$1" --sequence "$2" "${baseline[@]}" --json "$out/$backend/$1.json" >"$out/$backend/$1.txt"
  done
}

drives=()
declare -A evaluations  # of a drive: the names of its runs, one for each seed
for drive in kitti_tracking_0003 kitti_odometry_04 kitti_odometry_06 rendered_street; do
  is_wanted "$drive" || continue
  if [[ -d $data/$drive ]]; then
    run_all "$drive" "$data/$drive"
    drives+=("$drive")
    evaluations[$drive]=$drive
  else
    echo "$drive is not in $data: skipped" >&2
  fi
done
for scene in overtake highway urban static crossing lead stop_and_go convoy circuit traffic rain people; do
  is_wanted "$scene" || continue
  length=()
  [[ $scene == circuit ]] && length=(--frames 200)  # a third of the lap
  for seed in $seeds; do
    name=$scene-$seed
    [[ -f $sequences/$name/complete ]] || {
      "$motorcade" synth "$sequences/$name" --scene "$scene" --seed "$seed" "${length[@]}" >/dev/null
      touch "$sequences/$name/complete"
    }
    run_all "$name" "$sequences/$name"
    evaluations[$scene]+=" $name"
  done
  drives+=("$scene")
done

table() {  # KIND HEAD ...: one row for every drive and back-end
  local shown=$1 name drive backend files
  shift
  printf '|'; printf ' %s |' "$@"; printf '\n|'; printf ' --- |%.0s' "$@"; printf '\n'
  for drive in "${drives[@]}"; do
    for backend in $backends; do
      files=()
      for name in ${evaluations[$drive]}; do files+=("$out/$backend/$name.json"); done
      jq -rs --arg name "$drive" --arg backend "$backend" --arg table "$shown" -f perf/accuracy.jq "${files[@]}"
    done
  done
  echo
}

table camera drive back-end frames "ATE m" "end error" "RPE_t m rmse / median" "RPE_r deg rmse / median" \
  "ATE m, end error, RPE_t m without the truth's mounting"
table objects drive back-end "ME_t m final / online" "ME_r deg final / online" "speed error m/s final / online" "recall to 30 m" \
  "30 to 50 m" "false rows" "id switches"
table positions drive back-end objects "ATE m aligned" "offset removed" "as seen, offset removed" "ARE deg" "RE aligned" \
  "RE offset removed" "RE as seen, offset removed" "drift of the origin m along / up / across"
table boxes drive back-end "IoU in the image final / online" "over .5" "IoU from above final / online" "IoU in 3D" "center m" "heading deg" \
  "length m" "width m" "height m"
table tracking drive back-end "HOTA in the image final / online" DetA AssA LocA "to 50 m" "HOTA from above final / online" "mask IoU" "30 to 50 m" \
  "boundary px" "kinds right final / online" "first report, median / mean" "to 50 m"
table covariances drive back-end "camera NEES" "inside 95 %" "rotation over ten frames inside 95 %" "objects NEES" "inside 95 %"
