#!/usr/bin/env bash
# Shows what Motorcade does: builds it, renders a drive in which two cars overtake the camera car, follows it at camera rate, measures
# the outcome against the exact truth, and draws the result.
set -euo pipefail
cd "$(dirname "$0")/.."
results=results/demo
motorcade=build/release/apps/motorcade

number=0 steps=("Installing what is missing" "Building the program" "Rendering the scene 'overtake'" "Following it at 10 pairs per second"
  "Accuracy against the exact truth" "Drawing every fourth frame" "Writing the report")
next_step() {
  local next=$((number + 1))
  echo "== $next of ${#steps[@]}: ${steps[$number]}${steps[$next]:+ (next: ${steps[$next]})}"
  number=$next
}

next_step
apps/setup.sh

next_step
cmake --preset release --log-level=WARNING
apps/build.sh release motorcade libmotorcade

next_step
if [[ $results/sequence/times.txt -nt $motorcade ]]; then
  echo "already there"
else
  "$motorcade" synth "$results/sequence" --scene overtake
fi

next_step
"$motorcade" run "$results/sequence" --out "$results/run" --force --rate 10 --masks

next_step
"$motorcade" evaluate "$results/run" --sequence "$results/sequence" --json "$results/evaluation.json"

next_step
"$motorcade" draw "$results/run" --sequence "$results/sequence" --out "$results/pictures" --every 4

next_step
"$motorcade" report "$results/run" --sequence "$results/sequence"

echo "== Results"
echo "images and truth   $PWD/$results/sequence"
echo "trajectories       $PWD/$results/run"
echo "accuracy           $PWD/$results/evaluation.json"
echo "latency            $PWD/$results/run/summary.json"
pictures=("$results"/pictures/frame_*.png)
echo "a picture          $PWD/${pictures[-1]}"
echo "the report         $PWD/$results/run/report.html"
