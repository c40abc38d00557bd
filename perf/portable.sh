#!/usr/bin/env bash
# How far the portable build's camera and objects are from the x86-64-v3 build's, over the first frames of a drive: prints the largest
# difference of any number per file, and fails above the tolerance. Builds what is not there.
#   perf/portable.sh [DRIVE] [FRAMES] [TOLERANCE]
set -euo pipefail
cd "$(dirname "$0")/.."
drive=${1:-${MOTORCADE_DATA:-../shared/data}/kitti_tracking_0003}
frames=${2:-30}
tolerance=${3:-1e-6}
native=${MOTORCADE:-build/release/apps/motorcade} portable=${MOTORCADE_PORTABLE:-build/portable/apps/motorcade}
out=results/portable

if [[ ! -x $native ]]; then cmake --preset release --log-level=WARNING && cmake --build --preset release --target motorcade; fi
if [[ ! -x $portable ]]; then cmake --preset portable --log-level=WARNING && cmake --build --preset portable; fi >/dev/null
mkdir -p $out
"$native" run "$drive" --frames "0:$frames" --out $out/native --force >/dev/null 2>&1
"$portable" run "$drive" --frames "0:$frames" --out $out/portable --force >/dev/null 2>&1

# Prints the largest difference between the numbers of two files of the same shape, and where it is; words must be equal.
largest_difference() {
  paste -d '\n' "$1" "$2" | awk -F '[ ,]' '
    NR % 2 { fields = split($0, a, FS); line = $0; next }
    NF != fields { print "inf line", NR / 2; found = 1; exit }
    { for (i = 1; i <= NF; i++) {
        if ($i == a[i]) continue
        if ($i !~ /^[-+0-9.eE]+$/ || a[i] !~ /^[-+0-9.eE]+$/) { print "inf line", NR / 2; found = 1; exit }
        d = $i - a[i]; if (d < 0) d = -d
        if (d > most) { most = d; where = " line " NR / 2 " field " i } } }
    END { if (!found) printf "%g%s\n", most, where }'
}

failed=0
for file in camera_online.txt camera_final.txt objects_online.csv objects_final.csv; do
  read -r difference where <<<"$(largest_difference $out/native/$file $out/portable/$file)"
  verdict=$(awk -v d="$difference" -v t="$tolerance" 'BEGIN { print (d != "inf" && d + 0 <= t + 0) ? "" : "ABOVE " t }')
  [[ -z $verdict ]] || failed=1
  printf '%-20s %4d lines  largest difference %s %s %s\n' $file "$(wc -l <$out/native/$file)" "$difference" "${where:-}" "$verdict"
done
exit $failed
