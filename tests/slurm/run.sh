#!/bin/bash
# A study on a real Slurm: slurmctld and two slurmd on this host, one of which is killed with its jobs midway.
#
#   tests/slurm/run.sh path/to/lss [FOLDER]
#
# Needs root and Debian's slurmctld, slurmd, slurm-client and munge; where they are missing, or their services do not
# start, as in some containers, it says "skipped". Everything lies in a folder of its own, with ports
# and sockets of its own, and is stopped at the end. It says "passed" where the study completed on the node that was
# left, nothing was lost, and its table has the bytes of a run without Slurm.
set -euo pipefail

lss=$(realpath "$1")
work=${2:-$(mktemp -d /tmp/lss-slurm.XXXXXX)}
for program in slurmctld slurmd sbatch squeue scontrol munged; do
  command -v "$program" >/dev/null || { echo "skipped: $program is not there"; exit 0; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: slurmd needs root"; exit 0; }
mkdir -p "$work"/{state,spool1,spool2,log}
export SLURM_CONF=$work/slurm.conf
host=$(hostname -s)
started=()

stop() {
  local pid
  for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${started[@]}"; do wait "$pid" 2>/dev/null || true; done
}
trap stop EXIT
trap 'exit 1' INT TERM

fail() {
  echo "FAILED: $1"
  tail -n 20 "$work"/log/*.log || true
  exit 1
}

# ---- the cluster

dd if=/dev/urandom of="$work/munge.key" bs=1024 count=1 2>/dev/null
chmod 600 "$work/munge.key"
chmod 755 "$work"
munged --foreground --force --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munge.pid" \
  --log-file="$work/log/munged.log" --seed-file="$work/munge.seed" >"$work/log/munged.out" 2>&1 &
started+=($!)

cat >"$SLURM_CONF" <<CONF
ClusterName=lss
SlurmctldHost=$host
SlurmctldPort=16817
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
# A job of a dead node begins again when its credential has expired.
AuthInfo=socket=$work/munge.socket,cred_expire=6
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool.%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.%n.pid
SlurmctldLogFile=$work/log/slurmctld.log
SlurmdLogFile=$work/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2
SwitchType=switch/none
MpiDefault=none
ReturnToService=0
SlurmdTimeout=8
KillWait=5
JobRequeue=1
MaxArraySize=1001
SlurmdParameters=config_overrides
NodeName=node1 NodeHostname=$host Port=17001 CPUs=1 State=UNKNOWN
NodeName=node2 NodeHostname=$host Port=17002 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
CONF

sleep 1
slurmctld -D -c >"$work/log/slurmctld.out" 2>&1 &
started+=($!)
slurmd -D -N node1 >"$work/log/slurmd1.out" 2>&1 &
started+=($!)
slurmd -D -N node2 >"$work/log/slurmd2.out" 2>&1 &
node2=$!
started+=("$node2")
for _ in $(seq 60); do
  [ "$(sinfo -h -N -o '%N %T' 2>/dev/null | grep -c idle)" = 2 ] && break
  sleep 1
done
if [ "$(sinfo -h -N -o '%T' 2>/dev/null | grep -c idle)" != 2 ]; then
  tail -n 20 "$work"/log/*.log || true
  echo "skipped: Slurm's services do not start here"
  exit 0
fi
sinfo -N -l

# ---- the study: 40 tasks of about a second or two

mkdir -p "$work/study"
cat >"$work/study/small.lss" <<'LSS'
use std.carts.tilt_tray
use std.tracks.standard

let long = 16 m

layout small {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width 1.2 m

  vertex A (0 m, 0 m) radius 4 m
  vertex B (long, 0 m) radius 4 m
  vertex C (long, 9 m) radius 4 m
  vertex D (0 m, 9 m) radius 4 m

  photocell on A..B at 2 m
  motors 3 evenly

  optimise nothing
}
LSS
cat >"$work/study/study.toml" <<'TOML'
[[sweep]]
name = "speeds"
steps = ["build", "simulate"]
file = "small.lss"
let.long = { from = 16, to = 20, count = 5, unit = "m" }
simulate.speed = { from = 1, to = 2.4, step = 0.2, unit = "m/s" }
simulate.settle = "2s"
TOML
cd "$work/study"
"$lss" study run study.toml -o "$work/local" >/dev/null || fail "the local run"
"$lss" study collect study.toml -o "$work/local" >/dev/null || fail "the local table"
"$lss" study submit study.toml -o "$work/cluster" --engine slurm --chunk 4s || fail "not submitted"
# Again: everything is in the queue.
"$lss" study submit study.toml -o "$work/cluster" --engine slurm --chunk 4s | tee "$work/again.txt"
grep -q "nothing to submit" "$work/again.txt" || fail "submitted twice"

# ---- a node dies with what runs there

done_so_far() { find "$work/cluster/tasks" -name result.json 2>/dev/null | wc -l; }
# The daemon of each of its jobs, and what that started.
descendants() {
  local pid
  for pid in $(ps -o pid= --ppid "$1"); do
    echo "$pid"
    descendants "$pid"
  done
}
for _ in $(seq 300); do
  victims=()
  if [ "$(done_so_far)" -ge 8 ]; then
    for job in $(squeue -h -t R -w node2 -o '%A' 2>/dev/null); do
      for daemon in $(pgrep -f "^slurmstepd: \\[$job\\."); do
        # shellcheck disable=SC2207
        victims+=("$daemon" $(descendants "$daemon"))
      done
    done
  fi
  # Daemon, task and step: a job that Slurm has only begun to start has less.
  [ ${#victims[@]} -ge 3 ] && break
  sleep 0.2
done
[ ${#victims[@]} -ge 3 ] || fail "no job runs on node2"
echo "killing node2 with $(done_so_far) of 40 tasks done, and ${#victims[@]} processes of its jobs"
kill -9 "$node2" "${victims[@]}"

# ---- it completes all the same

requeued=0
for _ in $(seq 300); do
  for job in $(squeue -h -o '%A' 2>/dev/null | sort -u); do
    scontrol show job "$job" 2>/dev/null | grep -q 'Restarts=[1-9]' && requeued=1
  done
  [ -z "$(squeue -h 2>/dev/null)" ] && break
  sleep 1
done
sinfo -N -l
"$lss" study status -o "$work/cluster" || fail "a task failed"
grep -h -i -E "requeue|node node2 not responding|DOWN" "$work/log/slurmctld.log" | tail -n 8 || true
[ "$requeued" = 1 ] || fail "no job was requeued"
"$lss" study collect study.toml -o "$work/cluster" || fail "not all tasks are done"
for file in study.csv study.parquet study.html; do
  cmp "$work/local/$file" "$work/cluster/$file" || fail "$file differs"
done
echo "passed: 40 tasks, one of two nodes killed, nothing lost, the same bytes as without Slurm"
