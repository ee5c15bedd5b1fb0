# A Slurm job array as in docs/clusters.md: a controller and a node of this test, on this machine, without munge.
. "$(dirname "$0")/lib.sh"
PATH=$PATH:/usr/sbin:/sbin
for program in slurmctld slurmd sbatch sinfo; do
  command -v $program >/dev/null || skip "$program is not installed (Debian: slurmctld, slurmd, slurm-client)"
done
begin
started=
finish() {
  for pid in $started; do kill "$pid" 2>/dev/null || true; done
  for pid in $started; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$folder"
}
trap finish EXIT

host=$(hostname -s)
user=$(id -un)
port=$((20000 + $$ % 20000))
mkdir state spool
cat >slurm.conf <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/none
CredType=cred/none
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SlurmdSpoolDir=$folder/spool
StateSaveLocation=$folder/state
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$folder/slurm.conf
slurmctld -D >/dev/null 2>&1 &
started=$!
slurmd -D >/dev/null 2>&1 &
started="$started $!"
for _ in $(seq 60); do
  [ "$(sinfo -h -o %t 2>/dev/null)" = idle ] && break
  sleep 0.5
done
if [ "$(sinfo -h -o %t)" != idle ]; then
  tail -20 slurmctld.log slurmd.log
  exit 1
fi

block slurm >sweep.sbatch
block sh slurm >commands
[ -s sweep.sbatch ] && [ -s commands ]
timeout 90 sh -e commands >log 2>&1 || { cat log sweep.*.log merge.log slurmctld.log; exit 1; }
cat log
check
