#!/usr/bin/env bash
# Batches on a Slurm cluster of this one machine.
#   tests/cluster/batch_on_slurm.sh MOTORCADE
set -euo pipefail
motorcade=$(realpath "$1")
# shellcheck source=tests/cluster/one_machine_slurm.sh
source "$(dirname "$0")/one_machine_slurm.sh"

skipped=77
slurm_available || { echo "Slurm cannot be installed here: batches on a cluster are not tested"; exit $skipped; }
work=$(mktemp -d)
trap 'slurm_stop "$work/cluster"; rm -rf "$work"' EXIT
slurm_start "$work/cluster"

queue_is_empty() { [[ -z $(timeout 5 squeue --noheader || echo unknown) ]]; }

cat >"$work/no_op.sh" <<END
#!/bin/sh
"$motorcade" --version >/dev/null && touch "$work/done_\$SLURM_ARRAY_TASK_ID"
END
sbatch --parsable --array=1-12 --mem=10 --output=/dev/null "$work/no_op.sh" >/dev/null
slurm_wait "$work/cluster" "the queue is empty" queue_is_empty
[[ $(find "$work" -name 'done_*' | wc -l) -eq 12 ]]
echo "An array of twelve ran on a Slurm cluster of this machine"
