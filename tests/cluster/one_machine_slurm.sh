#!/usr/bin/env bash
# A Slurm cluster of this one machine, for tests: munged, slurmctld and slurmd run as root from a folder, without systemd and without a
# file in /etc. Each node is one slurmd. Needs the packages slurm-wlm and munge.
#   tests/cluster/one_machine_slurm.sh start|stop FOLDER [NODES]
# After `start`, SLURM_CONF=FOLDER/slurm.conf has Slurm's commands find the cluster. A script that sources this file calls the functions,
# and puts `slurm_stop FOLDER` into its trap.
set -euo pipefail

# True where a cluster can be started; installs the packages if they are missing.
slurm_available() {
  [[ $(id -u) -eq 0 ]] || return 1
  (cd "$(dirname "${BASH_SOURCE[0]}")/../.." && apps/setup.sh slurm-wlm munge >/dev/null 2>&1) || return 1
  [[ -x /usr/sbin/munged && -x /usr/sbin/slurmctld && -x /usr/sbin/slurmd ]]
}

# slurm_start FOLDER [NODES]: starts a cluster of as many nodes (default 1) that share the cores and the memory of this machine.
slurm_start() {
  local folder nodes=${2:-1}
  mkdir -p "$1"
  folder=$(realpath "$1")
  if ((${#folder} > 70)); then  # the sockets in it have names of at most 107 characters
    echo "The name of the folder is too long for sockets: $folder" >&2
    return 1
  fi
  mkdir -p "$folder/state" "$folder/log"
  slurm_write_conf "$folder" "$nodes"
  export SLURM_CONF=$folder/slurm.conf
  (umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key")
  slurm_daemon "$folder" munged --foreground --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
    --pid-file="$folder/munged.pid" --seed-file="$folder/munge.seed" --num-threads=10 --force  # other users may not reach the folder
  slurm_wait "$folder" "munged answers" slurm_munge_answers "$folder" || return 1
  slurm_daemon "$folder" slurmctld -D -i
  slurm_wait "$folder" "slurmctld answers" slurm_answers || return 1
  local node
  for ((node = 1; node <= nodes; ++node)); do slurm_start_node "$folder" "node$node"; done
  slurm_wait "$folder" "all nodes are idle" slurm_nodes_are_idle "$nodes"
}

# slurm_stop FOLDER: ends the jobs and every daemon. Harmless where nothing runs.
slurm_stop() {
  [[ -d $1/log ]] || return 0
  local folder name file
  folder=$(realpath "$1")
  export SLURM_CONF=$folder/slurm.conf
  timeout 10 scancel --user=root >/dev/null 2>&1 || true
  for _ in {1..30}; do
    [[ -n $(timeout 5 squeue --noheader 2>/dev/null) ]] || break
    sleep .2
  done
  for name in slurmd_node slurmctld munged; do
    for file in "$folder/$name"*.process; do [[ ! -e $file ]] || slurm_end "$folder" "$(basename "$file" .process)" TERM; done
  done
  slurm_end_steps "$folder"
}

# slurm_start_node FOLDER NODE: starts the slurmd of a node that does not run.
slurm_start_node() { slurm_daemon "$1" slurmd -D -N "$2" "${@:3}"; }

# slurm_stop_node FOLDER NODE [SIGNAL]: ends the slurmd of a node; what runs there goes on.
slurm_stop_node() { slurm_end "$1" "slurmd_$2" "${3:-TERM}"; }

# slurm_restart_slurmd FOLDER [NODE] [SIGNAL]: ends the slurmd of a node and starts it again; jobs go on.
slurm_restart_slurmd() {
  slurm_stop_node "$1" "${2:-node1}" "${3:-TERM}"
  slurm_start_node "$1" "${2:-node1}"
  slurm_wait "$1" "${2:-node1} answers" slurm_node_responds "${2:-node1}"
}

# slurm_lose_node FOLDER NODE: the power goes. Its slurmd and every process of its jobs are killed, and the controller is told at once;
# by itself it would notice after SlurmdTimeout and some pings, 30 seconds in all. `slurm_start_node` has the node back.
slurm_lose_node() {
  slurm_stop_node "$1" "$2" KILL
  slurm_end_steps "$1" "$2"
  scontrol update NodeName="$2" State=DOWN Reason=lost
}

# slurm_start_requeued: jobs that were requeued start as soon as there is room, not two minutes later.
slurm_start_requeued() {
  local job reason
  squeue --noheader --array --states=PENDING --format='%i %r' | while read -r job reason; do
    [[ $reason != BeginTime ]] || scontrol update JobId="$job" StartTime=now
  done
}

# slurm_wait FOLDER WHAT COMMAND...: waits until the command succeeds, at most SLURM_WAIT_S (30) seconds; then shows the ends of the logs.
slurm_wait() {
  local folder=$1 what=$2 end=$((SECONDS + ${SLURM_WAIT_S:-30}))
  shift 2
  while ! "$@" >/dev/null 2>&1; do
    if ((SECONDS >= end)); then
      echo "Waited in vain until $what" >&2
      tail -n 5 "$folder"/log/*.out >&2
      tail -n 20 "$folder"/log/*.log >&2
      return 1
    fi
    sleep .1
  done
}

# The rest is for the functions above.

slurm_write_conf() {  # FOLDER NODES
  local folder=$1 nodes=$2 host cpus memory_mb node port ports=() affinity=affinity
  host=$(uname -n) host=${host%%.*}
  cpus=$(($(nproc) / nodes)) cpus=$((cpus > 0 ? cpus : 1))
  memory_mb=$(($(sed -n 's/^MemTotal: *\([0-9]*\) kB$/\1/p' /proc/meminfo) / 1024 / nodes - 64))
  ((nodes == 1)) || affinity=none  # every node would pin its first task to the first core
  while ((${#ports[@]} < nodes + 1)); do
    port=$((20000 + RANDOM % 12000))
    cat /proc/net/tcp /proc/net/tcp6 2>/dev/null | grep -q ":$(printf %04X $port) " || ports+=("$port")
  done
  cat >"$folder/slurm.conf" <<END
ClusterName=one_machine
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool_%n
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/slurmd_%n.log
SlurmctldDebug=${SLURM_TEST_DEBUG:-info}
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd_%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/$affinity
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,sched_interval=1,bf_interval=1,default_queue_depth=1000
JobRequeue=1
ReturnToService=2
SlurmdTimeout=10
BatchStartTimeout=10
MessageTimeout=10
KillWait=2
MinJobAge=60
MaxArraySize=2001
MaxJobCount=10000
SlurmdParameters=config_overrides
END
  echo "CgroupPlugin=cgroup/v1" >"$folder/cgroup.conf"  # it is not used, but found out by default, which fails in some containers
  {
    for ((node = 1; node <= nodes; ++node)); do
      echo "NodeName=node$node NodeHostname=$host NodeAddr=127.0.0.1 Port=${ports[$node]} CPUs=$cpus RealMemory=$memory_mb State=UNKNOWN"
    done
    echo "PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP"
  } >>"$folder/slurm.conf"
}

slurm_daemon() {  # FOLDER PROGRAM ARGUMENTS...
  local folder=$1 program=$2 name=$2
  shift 2
  [[ $program != slurmd ]] || name=slurmd_$3
  # shellcheck disable=SC2016
  PATH=/usr/sbin:$PATH SLURM_CONF=$folder/slurm.conf setsid --fork bash -c 'echo $$ >"$0.process"; exec "$@"' "$folder/$name" \
    "$program" "$@" </dev/null >>"$folder/log/$name.out" 2>&1
}

slurm_runs() {  # PROCESS: a zombie does not
  [[ -n $(tr -d '\0' 2>/dev/null <"/proc/$1/cmdline") ]]
} 2>/dev/null

slurm_end() {  # FOLDER NAME SIGNAL
  local process
  process=$(cat "$1/$2.process" 2>/dev/null) || return 0
  rm -f "$1/$2.process"
  for _ in {1..100}; do
    slurm_runs "$process" || return 0
    kill "-$3" "$process" 2>/dev/null || true
    sleep .1
  done
  kill -KILL "$process" 2>/dev/null || true
}

slurm_end_steps() {  # FOLDER [NODE]: kills every process of the jobs, and what runs them: it is in the session of the first
  local folder node process session sessions=" " processes=()
  folder=$(realpath "$1") node=${2:-node}
  for process in /proc/[0-9]*; do
    if tr '\0' '\n' <"$process/cmdline" | grep -q "^$folder/spool_$node" ||
      { tr '\0' '\n' <"$process/environ" | grep -qx "SLURM_CONF=$folder/slurm.conf" &&
        tr '\0' '\n' <"$process/environ" | grep -q "^SLURMD_NODENAME=$node"; }; then
      session=$(sed 's/.*) //' "$process/stat" | cut -d' ' -f4) || continue
      processes+=("${process#/proc/}") sessions+="$session "
    fi
  done 2>/dev/null
  for process in /proc/[0-9]*; do
    session=$(sed 's/.*) //' "$process/stat" | cut -d' ' -f4) || continue
    [[ $sessions != *" $session "* ]] || processes+=("${process#/proc/}")
  done 2>/dev/null
  ((${#processes[@]} == 0)) || kill -KILL "${processes[@]}" 2>/dev/null || true
}

slurm_munge_answers() { munge --no-input --socket="$1/munge.socket"; }
slurm_answers() { timeout 5 scontrol ping; }
slurm_node_responds() { ! timeout 5 scontrol show node "$1" | grep -q 'State=[A-Z+]*\(DOWN\|NOT_RESPONDING\|\*\)'; }
slurm_nodes_are_idle() { [[ $(timeout 5 sinfo --noheader --Node --states=idle --format=%t | grep -c '^idle$') -eq $1 ]]; }

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
  case ${1:-} in
    start) slurm_start "${@:2}" || { slurm_stop "$2"; exit 1; } ;;
    stop) slurm_stop "$2" ;;
    *) sed -n '2,6s/^# //p' "$0" >&2; exit 2 ;;
  esac
fi
