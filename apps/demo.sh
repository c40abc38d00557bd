#!/usr/bin/env bash
# Shows what Motorcade does: renders a drive in which two cars overtake the camera car, follows it at camera rate and measures
# the outcome against the exact truth, and draws what it saw.
set -euo pipefail
cd "$(dirname "$0")/.."
results=results/demo
motorcade=build/release/apps/motorcade

apps/setup.sh
echo "== Building"
cmake --preset release --log-level=WARNING
cmake --build --preset release --target motorcade

echo "== Rendering the scene 'overtake'"
if [[ $results/sequence/times.txt -nt $motorcade ]]; then
  echo "already there"
else
  "$motorcade" synth "$results/sequence" --scene overtake
fi

echo "== Following it at 10 pairs per second"
"$motorcade" run "$results/sequence" --out "$results/run" --force --rate 10 --masks

echo "== Accuracy against the exact truth"
"$motorcade" evaluate "$results/run" --sequence "$results/sequence" --json "$results/evaluation.json"

echo "== Drawing every fourth frame"
"$motorcade" draw "$results/run" --sequence "$results/sequence" --out "$results/pictures" --every 4

echo "== Writing the report"
"$motorcade" report "$results/run" --sequence "$results/sequence"

echo "== Results"
echo "images and truth   $PWD/$results/sequence"
echo "trajectories       $PWD/$results/run"
echo "accuracy           $PWD/$results/evaluation.json"
echo "latency            $PWD/$results/run/summary.json"
echo "a picture          $PWD/$results/pictures/frame_000032.png"
echo "the report         $PWD/$results/run/report.html"
