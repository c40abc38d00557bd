#!/usr/bin/env bash
# Measures how the cost of a frame grows with the image's size, the number of tracks and the objects in view: CPU ms per frame on one thread,
# images in memory, for the whole process and by stage. Renders what is not there.
#   perf/scaling.sh [DATA_FOLDER] [OUT_FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
data=${1:-${MOTORCADE_DATA:-../shared/data}}
out=${2:-results/scaling}
motorcade=${MOTORCADE:-build/release/apps/motorcade}
bench=${PIPELINE_BENCH:-build/release/perf/apps/pipeline_bench}

rendered() {  # SCENE SIZE FRAMES
  local folder=$out/sequences/$1_$2
  [[ -f $folder/times.txt ]] || "$motorcade" synth "$folder" --scene "$1" --size "$2" --frames "$3" >/dev/null 2>&1
  echo "$folder"
}

measure() {  # NAME SEQUENCE [OPTIONS ...]
  local name=$1 sequence=$2
  shift 2
  "$bench" sweep "$sequence" --threads 1 --in-flight 1 --images memory --repeat "${REPEAT:-3}" "$@" |
    awk -v name="$name" '$1 == "memory" && $5 == "|" { cpu = $6 }
      $1 == "memory" && $5 == "/" { printf "%-22s %8s", name, cpu
        for (i = 4; i <= NF; i += 3) printf " %8s", $i
        print "" }'
}

printf '%-22s %8s %8s %8s %8s %8s %8s %8s %8s\n' "CPU ms per frame" all prepare stereo flow segment. tracking optim. shapes
for size in 621x187 878x265 1242x375; do measure "overtake $size" "$(rendered overtake $size 28)"; done
for tracks in 250 500 1000 2000; do
  measure "$tracks tracks at most" "$data/kitti_tracking_0003" --range 0:60 --set frontend.optical_flow.max_tracks=$tracks
done
for scene in static lead convoy crowd; do measure "$scene" "$(rendered $scene 1242x375 28)"; done
