#!/usr/bin/env bash
# Counts each stage's instructions per frame by callgrind on one worker, and compares them with perf/instructions.md. A count repeats to .05 %,
# however busy the machine is.
#   perf/instructions.sh [BUILD]                     checks; ends with 1 where a stage grew by more than 5 % or exceeds its budget, and with 77
#                                                    where counts cannot be compared with the recorded ones
#   perf/instructions.sh --write [--budgets] [BUILD] writes the counts into the record, and with --budgets new budgets, 8 % above them
# BUILD is build/release unless named. Needs valgrind and the target libpng_pairs. Drives are rendered once (BUILD/instructions); a real one is
# read from MOTORCADE_DATA (default ../shared/data), and left out where it is not there.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=check budgets=
while [[ ${1:-} == --* ]]; do
  case $1 in
    --write) mode="write" ;;
    --budgets) budgets=yes ;;
    *) sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
  esac
  shift
done
build=${1:-build/release}
record=perf/instructions.md
motorcade=$build/apps/motorcade libpng_pairs=$build/tests/perf/libpng_pairs
skipped=77
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

skip() { echo "Instructions are not counted: $1"; exit $skipped; }
# The environment is the same everywhere. On one processor no other thread takes a part of a stage's loops.
profile() { env -i PATH=/usr/bin:/bin LC_ALL=C taskset --cpu-list "$processor" "$valgrind" --tool="$1" "${@:2}"; }
processors() {  # those that this process may use
  awk '/^Cpus_allowed_list:/ {
    count = split($2, ranges, ",")
    for (i = 1; i <= count; ++i) {
      last = split(ranges[i], ends, "-")
      for (p = ends[1] + 0; p <= ends[last] + 0; ++p) print p
    }
  }' /proc/self/status
}

conditions() {  # what a count depends on beside the code, a line "conditions NAME VALUE" each
  sed -n 's/^\(build\|compiler\|instruction_set\|onetbb\|eigen\|opencv\|libpng\|libdeflate\)  *\(.*\)$/conditions\t\1\t\2/p' "$work/version"
  printf 'conditions\tzlib\t%s\n' "$(basename "$(readlink -f "$(ldd "$libpng_pairs" | awk '$1 ~ /^libz\.so/ { print $3 }')")" | sed 's/^libz\.so\.//')"
  printf 'conditions\tglibc\t%s\n' "$(getconf GNU_LIBC_VERSION | cut -d' ' -f2)"
  printf 'conditions\tvalgrind\t%s\n' "$("$valgrind" --version | sed 's/^valgrind-//')"
}
recorded_conditions() {
  awk -F' *[|] *' '/^## / { section = substr($0, 4) } section == "conditions" && NF == 4 && $3 !~ /^-*$/ { print "conditions\t" $2 "\t" $3 }' $record
}

frames_of() { case $1 in highway-small) echo 24 ;; highway) echo 30 ;; *) echo 40 ;; esac; }
folder_of() { if [[ $1 == highway* ]]; then echo "$build/instructions/$1"; else echo "${MOTORCADE_DATA:-../shared/data}/$1"; fi; }
rendered() {  # NAME SIZE
  local folder
  folder=$(folder_of "$1")
  [[ $folder/times.txt -nt $motorcade ]] || "$motorcade" -q synth "$folder" --scene highway --size "$2" --frames "$(frames_of "$1")" >/dev/null
}

count() {  # DRIVE PROCESSOR
  local drive=$1 processor=$2 folder frames
  folder=$(folder_of "$drive") frames=$(frames_of "$drive")
  callgrind() { profile callgrind --callgrind-out-file="$work/$drive.$1" "${@:2}" >"$work/$drive.log" 2>&1 || { cat "$work/$drive.log" >&2; return 1; }; }
  attribute() { awk -f perf/instructions/attribute.awk -v drive="$drive" -v frames="$frames" -v parts="$1" "$work/$drive.$1"; }
  callgrind stages "$motorcade" -q run "$folder" --frames "0:$frames" --threads 1 --masks --out "$work/run_$drive" && attribute stages &&
    callgrind libpng "$libpng_pairs" "$folder" "$frames" && attribute libpng
}

valgrind=$(command -v valgrind) || skip "valgrind is not installed"
mapfile -t processors < <(processors)
processor=${processors[0]} profile none "$motorcade" --version >"$work/version" 2>"$work/log" || skip "valgrind does not run here: $(tail -n 1 "$work/log")"
conditions >"$work/counts"
differences=$({ diff <(recorded_conditions) "$work/counts" || true; } | sed -n 's/^> conditions\t\(.*\)\t\(.*\)$/\1 \2/p' | paste -sd, | sed 's/,/, /g')
[[ $mode == write || -z $differences ]] || skip "perf/instructions.md was not measured with $differences"

drives=(highway-small highway)
rendered highway-small 621x187
rendered highway 1242x375
if [[ -d $(folder_of kitti_tracking_0003) ]]; then drives+=(kitti_tracking_0003); else echo "kitti_tracking_0003 is not there and left out"; fi
[[ ${#drives[@]} -eq 3 || $mode == check || -z $differences ]] || { echo "As $differences changed, all drives are to be counted anew" >&2; exit 1; }

jobs=()
for drive in "${drives[@]}"; do
  count "$drive" "${processors[${#jobs[@]} % ${#processors[@]}]}" >"$work/$drive.counts" &
  jobs+=($!)
done
failed=
for job in "${jobs[@]}"; do wait "$job" || failed=yes; done
[[ -z $failed ]] || { echo "Counting failed" >&2; exit 1; }
for drive in "${drives[@]}"; do cat "$work/$drive.counts"; done >>"$work/counts"

status=0
awk -f perf/instructions/record.awk -v mode=$mode -v budgets=$budgets "$work/counts" $record >"$work/out" || status=$?
if [[ $mode == check ]]; then cat "$work/out"; fi
if [[ $mode == write && $status -eq 0 ]]; then cp "$work/out" $record && echo "$record holds the counts of ${drives[*]}"; fi
exit $status
