"""A Slurm cluster of real daemons on this machine, in a folder of its own: munged, slurmctld, a slurmd for each node.

    python workflow/tests/cluster.py FOLDER [--nodes 2]    # until Ctrl-C; FOLDER/bin goes to the front of PATH

Needs the Debian packages slurmctld, slurmd, slurm-client and munge, and root. Nothing in /etc is read or written: the
commands in FOLDER/bin know where the configuration is, also within jobs.
"""

import argparse
import os
import secrets
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "scontrol", "sinfo", "scancel"]
PATH = f"{os.environ['PATH']}:/usr/sbin:/sbin"


def lacks():
    """Why there can be no cluster here; empty if there can."""
    missing = [name for name in PROGRAMS if not shutil.which(name, path=PATH)]
    if missing:
        return f"apt-get install slurmctld slurmd slurm-client munge: no {', '.join(missing)}"
    return "" if os.geteuid() == 0 else "slurmd has to be started by root"


def free_ports(count):
    sockets = [socket.create_server(("", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    """Daemons that stop at the end of the `with` block. `env` is the environment in which jobs are submitted."""

    def __init__(self, folder, nodes=2, cpus=1, memory=16000, options=""):
        self.folder = Path(folder).resolve()
        self.names = [f"n{number}" for number in range(1, nodes + 1)]
        self.daemons, self.cpus = {}, cpus
        self.bin = self.folder / "bin"
        self.conf = self.folder / "slurm.conf"
        for name in ["bin", "run", "log", "state"]:
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        os.chmod(self.folder / "run", 0o755)
        self.munge = self.folder / "run" / "munge.socket"
        (self.folder / "munge.key").write_bytes(secrets.token_bytes(128))
        os.chmod(self.folder / "munge.key", 0o600)
        control, *ports = free_ports(nodes + 1)
        host = socket.gethostname().split(".")[0]
        lines = [
            "ClusterName=bench",
            f"SlurmctldHost={host}(127.0.0.1)",
            "SlurmUser=root",
            "SlurmdUser=root",
            f"SlurmctldPort={control}",
            f"AuthInfo=socket={self.munge}",
            f"StateSaveLocation={self.folder}/state",
            f"SlurmdSpoolDir={self.folder}/spool-%n",
            f"SlurmctldPidFile={self.folder}/run/slurmctld.pid",
            f"SlurmdPidFile={self.folder}/run/slurmd-%n.pid",
            f"SlurmctldLogFile={self.folder}/log/slurmctld.log",
            f"SlurmdLogFile={self.folder}/log/slurmd-%n.log",
            "ProctrackType=proctrack/linuxproc",
            "TaskPlugin=task/none",
            "JobAcctGatherType=jobacct_gather/none",
            "SelectType=select/cons_tres",
            "SelectTypeParameters=CR_CPU",
            "MpiDefault=none",
            "ReturnToService=2",
            "KillWait=2",
            "MaxArraySize=1001",
            *options.splitlines(),
        ]
        lines += [
            f"NodeName={name} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs={cpus} RealMemory={memory}"
            for name, port in zip(self.names, ports)
        ]
        lines.append("PartitionName=debug Nodes=ALL Default=YES MaxTime=INFINITE State=UP")
        self.conf.write_text("\n".join(lines) + "\n")
        for name in ["sbatch", "srun", "squeue", "scontrol", "sinfo", "scancel", "sacct", "sacctmgr"]:
            if program := shutil.which(name, path=PATH):
                script = self.bin / name
                script.write_text(f'#!/bin/sh\nSLURM_CONF={self.conf} exec {program} "$@"\n')
                script.chmod(0o755)
        self.env = {**os.environ, "PATH": f"{self.bin}:{PATH}"}

    def start(self, name):
        """Starts `munged`, `slurmctld` or the slurmd of a node."""
        if name == "munged":
            run = self.folder / "run"
            command = ["munged", "-F", "-f", "--key-file", self.folder / "munge.key", "--socket", self.munge]
            command += ["--log-file", self.folder / "log" / "munged.log", "--pid-file", run / "munged.pid"]
            command += ["--seed-file", run / "munge.seed"]
        elif name == "slurmctld":
            command = ["slurmctld", "-D", "-f", self.conf]
        else:
            (self.folder / f"spool-{name}").mkdir(exist_ok=True)
            command = ["slurmd", "-D", "-N", name, "-f", self.conf]
        env = {**os.environ, "PATH": PATH}

        def settle_down():
            # A node has the cores that it says it has: its jobs inherit them.
            if name in self.names:
                first = self.names.index(name) * self.cpus
                cores = sorted(os.sched_getaffinity(0))
                os.sched_setaffinity(0, {cores[at % len(cores)] for at in range(first, first + self.cpus)})

        with (self.folder / "log" / f"{name}.out").open("ab") as out:
            self.daemons[name] = subprocess.Popen(
                list(map(str, command)), stdout=out, stderr=out, env=env, preexec_fn=settle_down
            )

    def stop(self, name, by=signal.SIGTERM):
        """Ends one of the daemons."""
        daemon = self.daemons.pop(name)
        daemon.send_signal(by)
        daemon.wait(30)

    def call(self, *command, **more):
        return subprocess.run(list(map(str, command)), env=self.env, capture_output=True, text=True, **more)

    def __enter__(self):
        self.start("munged")
        self.until(self.munge.exists, "munged")
        self.start("slurmctld")
        self.until(lambda: self.call("scontrol", "ping").returncode == 0, "slurmctld")
        for name in self.names:
            self.start(name)

        def states():
            return self.call("sinfo", "-h", "-N", "-o", "%t").stdout.split()

        self.until(lambda: states() == ["idle"] * len(self.names), "slurmd")
        return self

    def __exit__(self, *_):
        self.call("scancel", "--user", "root")
        time.sleep(1)
        for name in reversed(list(self.daemons)):
            self.stop(name)

    def until(self, is_true, what, seconds=60):
        end = time.monotonic() + seconds
        while not is_true():
            if time.monotonic() > end:
                logs = "\n".join(path.read_text(errors="replace")[-2000:] for path in (self.folder / "log").iterdir())
                raise TimeoutError(f"{what} is not there after {seconds} s\n{logs}")
            time.sleep(0.2)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--nodes", type=int, default=2)
    args = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with Cluster(args.folder, args.nodes) as cluster:
        print(f"export PATH={cluster.bin}:$PATH", flush=True)
        try:
            while True:
                time.sleep(3600)
        except KeyboardInterrupt:
            pass
