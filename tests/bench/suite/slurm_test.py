"""64 tasks on a real slurmctld and slurmd on loopback: tasks killed, the controller restarted, a part lost; the joined
result equals one uninterrupted run, and only what had no valid record ran again.

Usage: slurm_test.py PROGRAM     exit code 77: Slurm is not installed
"""
import getpass
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from campaign_support import assert_equal, run, suite

program = os.path.abspath(sys.argv[1])
os.environ["PATH"] += ":/usr/sbin"
if not all(shutil.which(name) for name in ("slurmctld", "slurmd", "sbatch", "squeue")):
    print("skipped: Slurm is not installed (Debian: apt install slurm-wlm)")
    sys.exit(77)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Slurm:
    """A controller and one node of four cores, whatever this machine has."""

    def __init__(self, folder):
        self.conf = f"{folder}/slurm.conf"
        os.makedirs(f"{folder}/state")
        os.makedirs(f"{folder}/spool")
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
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
        os.environ["SLURM_CONF"] = self.conf
        self.log = open(f"{folder}/daemons.log", "w")
        self.node = None
        self.start_controller()
        self.node = subprocess.Popen(["slurmd", "-D", "-f", self.conf, "-N", host], stdout=self.log, stderr=self.log)
        for _ in range(200):
            if "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout:
                return
            time.sleep(0.1)
        raise AssertionError("slurmd did not come up")

    def start_controller(self):
        self.controller = subprocess.Popen(["slurmctld", "-D", "-f", self.conf], stdout=self.log, stderr=self.log)

    def stop(self):
        for daemon in (self.node, self.controller):
            if daemon:
                daemon.terminate()
        for daemon in (self.node, self.controller):
            if daemon:
                try:
                    daemon.wait(timeout=30)
                except subprocess.TimeoutExpired:
                    daemon.kill()
                    daemon.wait()


def tasks_running(folder):
    """Process ids of the tasks' programs."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/cmdline", "rb") as file:
                words = file.read().decode(errors="replace").split("\0")
        except OSError:
            continue
        if words[0] == program and any(word.startswith(f"{folder}/it/parts/") for word in words):
            found.append(int(pid))
    return found


def parts_with_results():
    return [k for k in range(64) if os.path.exists(f"it/parts/{k}/results.jsonl") and os.path.getsize(f"it/parts/{k}/results.jsonl")]


folder = os.path.realpath(tempfile.mkdtemp(prefix="zwang-slurm-"))
os.chdir(folder)
os.environ["XDG_CACHE_HOME"] = folder
words = suite(252)
slurm = Slurm(folder)
try:
    run([program, "bench", *words, "--out", "whole"])
    campaign = subprocess.Popen([program, "campaign", "quick", "--engine", "slurm", "--tasks", "64", "--at-once", "4", "--out", "it",
                                 *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    chance = random.Random(1)
    killed = restarted = lost = 0
    finished_by_then = {}
    deadline = time.time() + 600
    while campaign.poll() is None and time.time() < deadline:
        running = tasks_running(folder)
        done = len(parts_with_results())
        if running and killed < 12:
            try:
                os.kill(chance.choice(running), signal.SIGKILL)
                killed += 1
            except ProcessLookupError:
                pass
        if not restarted and done >= 8:
            slurm.controller.send_signal(signal.SIGKILL)
            slurm.controller.wait()
            time.sleep(1)
            slurm.start_controller()
            restarted = 1
        if not lost and done >= 16:
            shutil.rmtree(f"it/parts/{parts_with_results()[0]}", ignore_errors=True)
            lost = 1
        time.sleep(chance.uniform(0.05, 0.4))
    said, _ = campaign.communicate(timeout=60)
    assert campaign.returncode == 0, said
    assert killed >= 8 and restarted and lost, (killed, restarted, lost)
    assert "1,536 of 1,536 runs" in said, said
    assert_equal("whole", "it/result")
    # No run was made twice: what had a valid record did not run again.
    lines = 0
    for k in range(64):
        with open(f"it/parts/{k}/results.jsonl") as file:
            lines += sum(1 for _ in file)
    assert lines == 1536, lines
    print(f"{killed} tasks killed, controller restarted, one part lost: equal")
finally:
    slurm.stop()
    os.chdir("/")
    shutil.rmtree(folder, ignore_errors=True)
