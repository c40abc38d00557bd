#!/usr/bin/env bash
# Measures the effect of faults on the results, and writes perf/robustness.md: every fault of `run --inject` on real and rendered drives, with the
# drift of the camera and the recall of moving objects against the same drive without faults; scenes that mislead; and the tests of all other
# faults, from a build by tests/run.sh. Needs jq.
#   perf/robustness.sh [--gaps N] [--seeds N] [--drives "NAME ..."] [DATA_FOLDER] [OUT_FOLDER]
# --gaps    gaps of random place and length on rendered_street whose error is held against what the run says of it (default 100)
# --seeds   of the rendered scenes, from 1 to N (default 10)
# --drives  only these
set -euo pipefail
cd "$(dirname "$0")/.."
gaps=100 seeds=10 drives="rendered_street kitti_tracking_0003" folders=()
while (($#)); do
  case $1 in
    --gaps) gaps=$2 && shift 2 ;;
    --seeds) seeds=$2 && shift 2 ;;
    --drives) drives=$2 && shift 2 ;;
    -*) sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    *) folders+=("$1") && shift ;;
  esac
done
data=${folders[0]:-${MOTORCADE_DATA:-../shared/data}}
out=${folders[1]:-results/robustness}
build=build/release
motorcade=${MOTORCADE:-$build/apps/motorcade}
report=perf/robustness.md
command -v jq >/dev/null || { echo "perf/robustness.sh needs jq: apt-get install jq" >&2; exit 1; }
mkdir -p "$out"

run() {  # DRIVE FAULTS: the measures of a run as JSON in $out/measures.json
  rm -rf "$out/run"
  local exit_code=0
  "$motorcade" run "$data/$1" --out "$out/run" ${2:+--inject "$2"} >"$out/log" 2>&1 || exit_code=$?
  ((exit_code == 0)) || { cat "$out/log" >&2; return 1; }
  "$motorcade" evaluate "$out/run" --sequence "$data/$1" --json "$out/measures.json" >/dev/null
}
ate() { jq '.final.camera.ate_m.rmse' "$out/measures.json"; }
recall() { jq '.final.detection.within_30m.recall // 0' "$out/measures.json"; }

row() {  # NAME FAULTS
  local line="| $1 | \`$2\` |" drive clean_ate clean_recall
  for drive in $drives; do
    read -r clean_ate clean_recall <<<"${clean[$drive]}"
    run "$drive" "$2"
    line+=$(jq -r --argjson clean "$clean_ate" --argjson recall "$clean_recall" --slurpfile summary "$out/run/summary.json" '
      .final.camera.ate_m.rmse as $ate | (.final.detection.within_30m.recall // null) as $found | $summary[0].frames as $f |
      " \($ate * 1000 | round / 1000) (x \($ate / $clean * 100 | round / 100)) | \(if $found == null then "-" else "\($found * 1000 | round / 10)" end) | \($f.lost + $f.rejected + $f.dropped) / \($f.degraded) / \($f.segments) |"' \
      "$out/measures.json")
  done
  echo "$line"
}

head_of() { printf '| fault | `--inject` |'; for drive in $drives; do printf ' %s: ATE m (times clean) | recall %% | missing / degraded / segments |' "$drive"; done
  printf '\n| --- | --- |'; for drive in $drives; do printf ' --- | --- | --- |'; done; printf '\n'; }

checked() {  # NAME FAULTS FINDING: on how many clips of the drives `check` names the fault
  local drive first named=0 clips=0
  for drive in $drives; do
    for first in 0 10 20 30; do
      "$motorcade" check "$data/$drive" --frames $first: --inject "$2" --json "$out/check.json" >/dev/null 2>&1 || true
      clips=$((clips + 1))
      jq -e --arg name "$3" 'if $name == "" then .findings == [] else any(.findings[]; .name == $name) end' "$out/check.json" >/dev/null && named=$((named + 1))
    done
  done
  echo "| $1 | \`$2\` | ${3:-nothing} | $named of $clips |"
}

tested() {  # FAULT TESTS: whether the tests whose names match pass
  local result
  result=$(ctest --test-dir "$build" -R "$2" 2>/dev/null | sed -n 's/^[0-9]*% tests passed, \([0-9]*\) tests\{0,1\} failed out of \([0-9]*\)$/\1 \2/p' | tail -1)
  read -r failed all <<<"${result:-0 0}"
  echo "| $1 | \`${2//|/, }\` | $((all - failed)) of $all passed |"
}

declare -A clean
for drive in $drives; do
  run "$drive" ""
  clean[$drive]="$(ate) $(recall)"
done

{
  echo "# Robustness"
  echo
  echo "This page shows what each fault does to the results. \`perf/robustness.sh --gaps $gaps --seeds $seeds\` writes this page. It did so on $(LC_ALL=C date '+%-d %B %Y')."
  echo
  echo "* *ATE* is the absolute trajectory error of the camera's final path. *times clean* compares it with the same drive without faults."
  echo "* *recall* is that of moving objects to 30 m."
  echo "* *missing* frames are lost, rejected or dropped. A new *segment* begins where no measurement links the frames before and after."
  echo
  echo "## Frames that are missing or of no use"
  echo
  head_of
  row "none" "seed=1"
  for n in 1 3 5 8 10 15; do row "$n missing" "drop@30:$((30 + n))"; done
  for n in 1 3 10 20; do row "$n black" "black@30:$((30 + n))"; done
  row "3 white" "white@30:33"
  row "3 damaged" "truncated@30:33"
  row "3 with bits turned" "bitflips=20@30:33"
  row "3 without the right image" "one_eyed@30:33"
  row "3 frozen" "duplicate@30:33"
  row "left and right exchanged" "exchanged@30"
  row "first five black" "black@0:5"
  row "every second blurred" "blur=9@0::2"
  row "every fifth exposed by .3" "exposure=0.3@0::5"
  row "three in ten missing" "drop~0.3"
  row "neighbors exchanged" "reordered@30"
  row "clock jumps by an hour" "jump=3600@30"
  echo
  echo "## Poor images, all along"
  echo
  head_of
  for v in 10 20 40; do row "noise, sigma $v" "noise=$v"; done
  for v in 3 5 9; do row "blur over $v px" "blur=$v"; done
  for v in 40 20 10; do row "JPEG, quality $v" "jpeg=$v"; done
  for v in 0.5 1.5; do row "exposure x $v" "exposure=$v"; done
  for v in 0.7 0.5; do row "right image's exposure x $v" "exposure=$v/right"; done
  for v in 3 5; do row "right image's blur $v px" "blur=$v/right"; done
  echo
  echo "## Rigs and inputs that are wrong"
  echo
  echo "\`motorcade check\` looks at twenty pairs, from four places of each drive. *named* counts the places at which it finds the fault."
  echo
  echo "| fault | \`--inject\` | finding | named |"
  echo "| --- | --- | --- | --- |"
  checked "none" "seed=1" ""
  checked "left and right exchanged" "exchanged" exchanged
  for v in 1.5 -1.5 4; do checked "right image lower by $v px" "lowered=$v/right" rows; done
  for v in 1 -1; do checked "right image turned by $v degrees" "rolled=$v/right" roll; done
  for v in -0.1 0.1; do checked "distortion left in, k1 $v" "barrel=$v" distortion; done
  checked "right image of the pair before" "apart" apart
  checked "exposure jumps" "exposure=0.5@35::2,exposure=0.5@5::2" exposure
  checked "one image dark" "exposure=0.5/right" exposure
  checked "blur" "blur=9" blur
  checked "noise" "noise=20" noise
  echo
  echo "## Silent jumps"
  echo
  perf/gaps.sh "$gaps" rendered_street "$data" "$out"  # its truth is exact
  echo
  echo "## Scenes that mislead"
  echo
  echo "These rendered scenes have exact truth (\`perf/scenes.sh --seeds $seeds\`). They show patterns that repeat, leaves that sway, rows of parked cars, and little at rest in view."
  echo
  MOTORCADE=$motorcade perf/scenes.sh --seeds "$seeds" --out "$out/scenes" || echo "In one of them the camera is farther from the true path than allowed."
  echo
  echo "## All other faults"
  echo
  echo "Tests hold these, in a build by \`tests/run.sh\`."
  echo
  echo "| fault | tests | result |"
  echo "| --- | --- | --- |"
  tested "a second run into the folder" Run.ASecondRunIntoTheSameFolderIsRefused
  tested "the folder goes away" Run.NoticesThatItsFolderIsGone
  tested "file size limit, full disk" "Run.EndsWithAnErrorWhereFilesMayNotGrow|Inject.AFullDisk"
  tested "SIGKILL, SIGTERM" "Run.LeavesFinalsWhenItIsKilled|Run.FlushesItsResults|Run.SettledEstimates|RecoveredFinals"
  tested "out of memory" "Run.EndsWithAMessageWhereMemoryRunsOut|ExceptionSafety|LacksMemory|RestartingBackend"
  tested "FIFOs and devices as input or output" "Run.RefusesInputsThatWouldBeWaitedFor|RunFolder.Outputs"
  tested "sizes, limits and headers of images" "Run.RefusesImagesThatAreLarger|ImageFile.AbsurdSizes|ImageFile.RefusesFiles|ImageFile.Pixels|ImageFile.Jpegs"
  tested "damaged images" "ImageFile.EveryCut|ImageFile.BrokenBytes|Run.RejectsADamagedImage"
  tested "calibrations and times that cannot be" "Run.WarnsOfTimes|DoubtsAboutACamera|Check|Plausibility|CalibrationFile.Refuses"
  tested "clocks" "FrameClock|Inject.AJumpOfTheClock|Inject.AClockThat|Inject.OneTimeFar"
  tested "late pairs" "Inject.LatePairs|FaultInjector"
  tested "parameters at their bounds" "ParameterRange"
  tested "\`solve\`: a star, signals" "Solve.AStar|Solve.WritesWhatIsSolved"
  tested "crowds, a truck that fills the view" "CrowdedRun|FollowsNoMoreObjects|EgoMotion.ACarDoesNotSlide"
} >"$out/report.md"
mv "$out/report.md" "$report"
cat "$report"
