#!/usr/bin/env bash
# Measures rendered scenes with exact truth over many seeds, one row each: where patterns repeat, leaves sway or little is at rest in view.
# Ends with exit code 1 where a run fails or leaves the true path by more than 0.3 m. Needs jq.
#   perf/scenes.sh [--seeds N] [--style NAME] [--out FOLDER] [SCENE ...]
# --seeds  from 1 to N (default 10)
# --style  of the images, as in `motorcade synth` (default plain)
# --out    where drives are rendered and kept (default results/scenes)
set -euo pipefail
cd "$(dirname "$0")/.."
seeds=10 style=plain out=results/scenes scenes=()
while (($#)); do
  case $1 in
    --seeds) seeds=$2 && shift 2 ;;
    --style) style=$2 && shift 2 ;;
    --out) out=$2 && shift 2 ;;
    -*) sed -n '2,7s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    *) scenes+=("$1") && shift ;;
  esac
done
((${#scenes[@]})) || scenes=(brick corner hedges windy parked bonnet walled_in truck crowd)
motorcade=${MOTORCADE:-build/release/apps/motorcade}
most_m=0.3  # far above what any of them shows, far below what a wrong motion costs
command -v jq >/dev/null || { echo "perf/scenes.sh needs jq: apt-get install jq" >&2; exit 1; }
mkdir -p "$out"

measured() {  # SCENE SEED: "error recall false rows lost" of one drive; recall is - where nothing moves
  local drive=$out/$style-$1-$2
  [[ -f $drive/times.txt ]] || "$motorcade" -q synth "$drive" --scene "$1" --seed "$2" --style "$style" >/dev/null
  "$motorcade" -q run "$drive" --out "$out/run" --force >/dev/null
  "$motorcade" evaluate "$out/run" --sequence "$drive" --json "$out/measures.json" >/dev/null
  jq -r --slurpfile summary "$out/run/summary.json" '.final | .detection as $d | $d.within_30m as $near |
    "\(.camera.ate_m.rmse * 1000 | round / 1000) \(if $near.labels == 0 then "-" else $near.recall * 1000 | round / 10 end)" +
    " \($d.false_rows) \($d.rows) \($summary[0].frames.lost)"' "$out/measures.json"
}

echo "| scene | ATE m: median, largest | recall to 30 m %: mean, least | false rows of all | seeds with any | lost frames |"
echo "| --- | --- | --- | --- | --- | --- |"
failed=0
for scene in "${scenes[@]}"; do
  for ((seed = 1; seed <= seeds; ++seed)); do measured "$scene" "$seed" || echo "9 0 0 0 1"; done | sort -g |
    awk -v scene="$scene" -v most="$most_m" '
      { ate[NR] = $1; wrong += $3; rows += $4; lost += $5; some += $3 > 0 }
      $2 != "-" { recall += $2; if (!near++ || $2 < least) least = $2 }
      END {
        found = near ? sprintf("%.1f, %.1f", recall / near, least) : "-"
        printf "| `%s` | %.3f, %.3f | %s | %d of %d | %d of %d | %d |\n", scene, ate[int((NR + 1) / 2)], ate[NR], found, wrong, rows, some, NR, lost
        exit ate[NR] > most
      }' || failed=1
done
exit $failed
