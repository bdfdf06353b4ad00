"""A Slurm of one controller and one node on loopback, started and stopped as ordinary programs of the caller.

Usage: slurm_support.py CORES COMMAND...     runs a command, a campaign say, with such a Slurm
"""
import ctypes
import getpass
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time


def adopt_orphans():
    """What this process starts stays below it, daemons as well; TERM ends it as an exception, so that it cleans up."""
    PR_SET_CHILD_SUBREAPER = 36
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))


def descendants():
    """Process ids below this one that have not ended."""
    parents = {}
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/stat") as file:
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except OSError:
            continue
        if state != "Z":
            parents[int(pid)] = int(parent)
    found, newest = set(), {os.getpid()}
    while newest:
        newest = {pid for pid, parent in parents.items() if parent in newest} - found
        found |= newest
    return found


def kill_descendants():
    while pids := descendants():
        for pid in pids:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        time.sleep(0.05)
    try:
        while os.waitpid(-1, os.WNOHANG)[0] > 0:
            pass
    except ChildProcessError:
        pass


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Slurm:
    """The node has as many cores as is said, whatever this machine has."""

    def __init__(self, folder, cores):
        self.conf = f"{folder}/slurm.conf"
        for name in ("state", "spool"):
            os.makedirs(f"{folder}/{name}")
        user, host = getpass.getuser(), socket.gethostname()
        with open(self.conf, "w") as file:
            file.write(f"""ClusterName=zwang
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny,DisableIPv6
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
        os.environ["SLURM_CONF"] = self.conf
        self.log = open(f"{folder}/daemons.log", "w")
        self.start_controller()
        subprocess.Popen(["slurmd", "-D", "-f", self.conf, "-N", host], stdout=self.log, stderr=self.log)
        for _ in range(600):
            if "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout:
                return
            time.sleep(0.1)
        raise AssertionError("slurmd did not come up")

    def start_controller(self):
        self.controller = subprocess.Popen(["slurmctld", "-D", "-f", self.conf], stdout=self.log, stderr=self.log)

    def restart_controller(self):
        """As a service is restarted. Killed at once it would forget jobs that it had started, and then drain the node."""
        self.controller.terminate()
        self.controller.wait(timeout=60)
        time.sleep(1)
        self.start_controller()


if __name__ == "__main__":
    adopt_orphans()
    os.environ["PATH"] += ":/usr/sbin"
    with tempfile.TemporaryDirectory(prefix="zwang-slurm-") as folder:
        try:
            Slurm(folder, int(sys.argv[1]))
            code = subprocess.run(sys.argv[2:]).returncode
        finally:
            kill_descendants()
    sys.exit(code)
