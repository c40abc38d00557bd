#!/usr/bin/env bash
# Tests that a long run stays as it is: memory, file descriptors and threads of `motorcade run` along laps of `circuit`, which repeats without
# a seam, and the latency at both ends. Prints one table; exits with 1 where memory, descriptors or threads grow. Latencies are shown only, as
# they depend on what else the machine does.
#   perf/long_drive.sh [FRAMES] [OUT_FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
frames=${1:-100000}
out=${2:-results/long_drive}
motorcade=${MOTORCADE:-build/release/apps/motorcade}
lap=$out/lap sequence=$out/laps run=$out/run samples=$out/samples.txt
lap_frames=600  # of the scene, at half the size so that a frame takes little time
size=621x187
settled=$((frames < 10000 ? frames / 2 : 5000))  # the window of 1000 frames is full, and has moved on
((frames >= 4000)) || { echo "perf/long_drive.sh: 4000 frames at least" >&2; exit 2; }
mkdir -p "$out"
out=$(realpath "$out") lap=$(realpath -m "$lap")

[[ -f $lap/complete ]] || {
  "$motorcade" synth "$lap" --scene circuit --size $size --frames $lap_frames >/dev/null 2>&1
  touch "$lap/complete"
}
rm -rf "$sequence" "$run" "$samples"
laps=$(((frames + lap_frames - 1) / lap_frames))
mkdir -p "$sequence"
cp "$lap/calib.txt" "$sequence"
awk -v frames=$((laps * lap_frames)) 'BEGIN { for (i = 0; i < frames; ++i) printf "%.1f\n", 0.1 * i }' >"$sequence/times.txt"
for camera in image_0 image_1; do  # a link for every frame, its name led by the number of the lap
  mkdir -p "$sequence/$camera" "$out/links"
  ln -sf "$lap/$camera"/*.png "$out/links"
  for ((i = 0; i < laps; ++i)); do
    tar -C "$out/links" -c . | tar -C "$sequence/$camera" -x --transform "flags=r;s,^\./,./$(printf %04d "$i"),"
  done
done

"$motorcade" run "$sequence" --frames "0:$frames" --out "$run" >"$out/log.txt" 2>&1 &
pid=$!
trap 'kill $pid 2>/dev/null || true' EXIT
while kill -0 $pid 2>/dev/null; do  # frame, resident kB, descriptors, threads
  frame=$(tail -n 1 "$run/frames.csv" 2>/dev/null | cut -d , -f 1) || true
  use=$(awk '/^VmRSS:/ { kb = $2 } /^Threads:/ { threads = $2 } END { print kb, threads }' /proc/$pid/status 2>/dev/null) || true
  descriptors=$(ls /proc/$pid/fd 2>/dev/null | wc -l) || true
  [[ $frame =~ ^[0-9]+$ && $use =~ ^([0-9]+)\ ([0-9]+)$ ]] && echo "$frame ${BASH_REMATCH[1]} $descriptors ${BASH_REMATCH[2]}" >>"$samples"
  sleep 0.2
done
wait $pid || { echo "the run ended with exit code $?:" >&2; tail -n 3 "$out/log.txt" >&2; exit 1; }

p99() {  # of the latency [ms] of the frames from $1 up to $2
  tail -n +2 "$run/frames.csv" | awk -F , -v a="$1" -v b="$2" '$1 >= a && $1 < b { print $4 }' | sort -g |
    awk '{ value[NR] = $1 } END { print value[int(0.99 * NR) + 1] }'
}
ends=$((frames < 30000 ? frames / 3 : 10000))
awk -v frames="$frames" -v settled="$settled" -v first="$(p99 0 $ends)" -v last="$(p99 $((frames - ends)) "$frames")" -v ends=$ends '
  function median(list, count,   i, j, t) {
    for (i = 2; i <= count; ++i)
      for (j = i; j > 1 && list[j - 1] > list[j]; --j) { t = list[j]; list[j] = list[j - 1]; list[j - 1] = t }
    return list[int((count + 1) / 2)]
  }
  { around = settled / 5 }
  $1 >= settled - around && $1 <= settled + around { mid_kb[++m] = $2; mid_fd[m] = $3; mid_threads[m] = $4 }
  $1 >= frames - 2 * around && $1 < frames - 1 { end_kb[++e] = $2; end_fd[e] = $3; end_threads[e] = $4 }
  function verdict(good) { bad += !good; return good ? "good" : "GROWS" }
  END {
    if (!m || !e) { print "the run was too fast to be watched: take more frames"; exit 1 }
    mid = median(mid_kb, m) / 1e3; end = median(end_kb, e) / 1e3
    printf "%-26s %14s %14s\n", "", "frame " settled, "frame " frames
    printf "%-26s %14.1f %14.1f  %s\n", "resident memory MB", mid, end, verdict(end - mid <= 4 || end <= 1.02 * mid)
    printf "%-26s %14d %14d  %s\n", "file descriptors", median(mid_fd, m), median(end_fd, e), verdict(end_fd[int((e + 1) / 2)] <= mid_fd[int((m + 1) / 2)])
    printf "%-26s %14d %14d  %s\n", "threads", median(mid_threads, m), median(end_threads, e), verdict(end_threads[int((e + 1) / 2)] <= mid_threads[int((m + 1) / 2)])
    printf "%-26s %14.1f %14.1f  %+.0f %%\n", "p99 of " ends " latencies ms", first, last, 100 * (last / first - 1)
    exit bad > 0
  }' "$samples"
