#!/usr/bin/env bash
# Tests a batch of twelve drives on a Slurm cluster of this one machine: while it runs a worker is killed, slurmd restarted and the node lost; what
# comes out is, byte for byte, what two tasks at a time give without Slurm. Exits with 77 where Slurm cannot be installed.
#   tests/cluster/batch_on_slurm.sh MOTORCADE
set -euo pipefail
motorcade=$(realpath "$1")
# shellcheck source=tests/cluster/one_machine_slurm.sh
source "$(dirname "$0")/one_machine_slurm.sh"

skipped=77
export SLURM_WAIT_S=${SLURM_WAIT_S:-90}  # other tests may take the processors
slurm_available || { echo "Slurm cannot be installed here: batches on a cluster are not tested"; exit $skipped; }
work=$(mktemp -d)
trap 'slurm_stop "$work/cluster"; rm -rf "$work"' EXIT
cat >"$work/drives.toml" <<'END'
[sets.joint]
[sets.filter]
backend.kind = "filter"
[[drives]]
scene = "lead"
length = 14
size = "310x94"
seeds = "1-6"
rate = 5  # three seconds each, in which something can happen
END

fail() { echo "$1" >&2; "$motorcade" batch status "$work/slurm" >&2 || true; exit 1; }
submit() { "$motorcade" batch "$work/drives.toml" --out "$work/slurm" --threads 1 --slurm --memory 300 "$@"; }
state_of() { "$motorcade" batch status "$work/slurm" --json "$work/status.json" >/dev/null && grep -c "\"state\": \"$1\"" "$work/status.json" || true; }
queue_is_empty() { slurm_start_requeued; [[ -z $(timeout 5 squeue --noheader || echo unknown) ]]; }
done_at_least() { (($(state_of done) >= $1)); }
in_mid_drive() {  # sets the process that performs a task of which some frames are there, but not nearly all
  local frames attempt
  for frames in "$work"/slurm/attempts/*/run/frames.csv; do
    attempt=$(basename "$(dirname "$(dirname "$frames")")")
    worker=${attempt##*-}
    case $(wc -l <"$frames") in [3-7]) return 0 ;; esac
  done
  return 1
}
kill_in_mid_drive() {  # another one where the process has ended meanwhile
  slurm_wait "$work/cluster" "a task is in mid-drive" in_mid_drive
  kill -KILL "$worker" 2>/dev/null || kill_in_mid_drive
}
waits_for_its_node() { timeout 5 squeue --noheader --states=PENDING --format=%r | grep -q BeginTime; }

"$motorcade" -q batch "$work/drives.toml" --out "$work/here" --threads 1 -j 2 >/dev/null
slurm_start "$work/cluster"
submit --dry-run | grep -q '^#SBATCH --array=0-11$' || fail "the script of a dry run lacks its array"
submit >/dev/null

kill_in_mid_drive
slurm_wait "$work/cluster" "two tasks are done" done_at_least 2
slurm_restart_slurmd "$work/cluster"
slurm_wait "$work/cluster" "four tasks are done" done_at_least 4
slurm_wait "$work/cluster" "a task is in mid-drive" in_mid_drive
slurm_lose_node "$work/cluster" node1
slurm_start_node "$work/cluster" node1
slurm_wait "$work/cluster" "Slurm has requeued what was lost" waits_for_its_node
SLURM_WAIT_S=120 slurm_wait "$work/cluster" "the queue is empty" queue_is_empty
[[ $(state_of done) -eq 11 && $(state_of waiting) -eq 1 ]] || fail "all but the task of the killed worker should be done"

submit | grep -q '^1 tasks submitted, 11 finished before' || fail "the task of the killed worker alone should be submitted"
SLURM_WAIT_S=60 slurm_wait "$work/cluster" "the queue is empty" queue_is_empty
[[ $(state_of done) -eq 12 ]] || fail "all twelve tasks should be done"
[[ -z $(ls "$work/slurm/attempts") ]] || fail "attempts are left: $(ls "$work/slurm/attempts")"
for result in "$work"/here/results/*; do
  for file in camera_online.txt camera_final.txt camera_online.tum camera_final.tum objects_online.csv objects_final.csv covariances.csv; do
    cmp "$result/run/$file" "$work/slurm/results/$(basename "$result")/run/$file"
  done
done
[[ $(wc -l <"$work/slurm/merged/results.csv") -eq 13 ]] || fail "the table that Slurm merged should have twelve rows"
submit | grep -q '^nothing is left to submit' || fail "nothing should be left to submit"

sed -i 's/rate = 5/rate = 1/' "$work/drives.toml"
submit >/dev/null
slurm_wait "$work/cluster" "a task is in mid-drive" in_mid_drive
"$motorcade" batch cancel "$work/slurm" | grep -q "in Slurm" || fail "cancel should name Slurm's jobs"
slurm_wait "$work/cluster" "the queue is empty" queue_is_empty
if submit --partition nowhere >"$work/refused" 2>&1; then fail "a partition that is not there should be refused"; fi
grep -q "invalid partition specified: nowhere" "$work/refused" || fail "$(cat "$work/refused")"
echo "Twelve drives on a Slurm cluster of this machine gave the same bytes as two at a time without it"
