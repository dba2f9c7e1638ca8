"""Tests of apps/cluster on the real GNU parallel, sshd and Slurm, run by ctest with one class each. What is not
installed or cannot start is skipped by name. Whatever a test starts ends with it, and nothing of the system's
configuration is read or changed."""

import concurrent.futures
import contextlib
import ctypes
import os
import pwd
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

CLUSTER = Path(__file__).resolve().parents[2] / "apps" / "cluster"
SCENE = Path(__file__).resolve().parents[2] / "scenes" / "cornell.toml"
WIDTH = 48
USER = pwd.getpwuid(os.geteuid()).pw_name
PATH = f"{sys.argv[1]}:{os.environ['PATH']}:/usr/sbin:/sbin"


def needed(*programs):
    for program in programs:
        if not shutil.which(program, path=PATH):
            raise unittest.SkipTest(f"{program} is not installed")


def wait_for(what, condition, seconds=60):
    end = time.monotonic() + seconds
    while not (found := condition()):
        if time.monotonic() > end:
            raise AssertionError(f"waited {seconds} s for {what}")
        time.sleep(0.02)
    return found


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def end_children():
    """Kills all that descends from this process, which adopts what its children leave behind."""
    while children := Path(f"/proc/self/task/{os.getpid()}/children").read_text().split():
        for child in map(int, children):
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
            with contextlib.suppress(ChildProcessError):
                os.waitpid(child, 0)


def log_of(part):
    return part.with_name(part.name + ".log")


def rows(film):
    """Picture and exact sums of a film file: after each row of the picture, in half, is the film's, of 27 words a
    pixel, the last of which is a checksum; neither is compressed."""
    row = 12 + 8 * WIDTH + 12 + 108 * WIDTH
    data = film.read_bytes()[-row * WIDTH:]
    return [data[y * row:(y + 1) * row - 4 * WIDTH] for y in range(WIDTH)]


class ClusterTest(unittest.TestCase):
    """A folder with a name that shells, Slurm and GNU parallel would read as their own."""

    def setUp(self):
        # munged wants the folders above its socket open to all.
        top = Path(self.enterContext(tempfile.TemporaryDirectory()))
        top.chmod(0o755)
        self.addCleanup(end_children)
        self.servers = top / "servers"
        self.servers.mkdir()
        self.folder = top / "it's {} \"%a\" $HOME"
        self.folder.mkdir()
        self.output = self.folder / "p {#}.exr"
        self.parts = Path(f"{self.output}.parts")
        self.environment = {**os.environ, "PATH": PATH, "PARALLEL_HOME": str(self.servers), "TMPDIR": str(self.servers)}

    if sys.version_info < (3, 11):
        def enterContext(self, context):
            value = context.__enter__()
            self.addCleanup(context.__exit__, None, None, None)
            return value

    def run_all(self, command, **options):
        return subprocess.run(list(map(str, command)), cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, **options)

    def command(self, *options, parts=4, spp=8, render=()):
        return [CLUSTER / self.program, SCENE, "-o", self.output.name, "--parts", parts, *options, "--",
                "--width", WIDTH, "--spp", spp, "--threads", "1", *render]

    def succeeds(self, command):
        result = self.run_all(command)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return result.stdout

    def fails(self, code, said, command):
        result = self.run_all(command)
        self.assertEqual((result.returncode, result.stderr.count("\n")), (code, 1), result.stderr)
        self.assertIn(said, result.stderr)

    def start(self, command):
        return subprocess.Popen(list(map(str, command)), cwd=self.folder, env=self.environment,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def status(self):
        return self.run_all([CLUSTER / self.program, "-o", self.output.name, "--status"])

    def kill_render(self, part):
        """Kills the render of a part when that has a checkpoint."""
        file = self.parts / part
        wait_for(f"a checkpoint of {part}", Path(f"{file}.checkpoint.exr").exists)
        process = int(re.findall(r"process (\d+)$", log_of(file).read_text(), re.M)[-1])
        os.kill(process, signal.SIGKILL)
        wait_for(f"{part} to be known as killed", lambda: "exit 137" in log_of(file).read_text())

    def expect_bits_of_one_render(self, spp):
        whole = self.folder / "whole.exr"
        self.succeeds(["raylab-render", SCENE, "-o", whole, "--film", "--width", WIDTH, "--spp", spp])
        self.assertTrue(rows(self.output) == rows(whole), "the films differ")
        self.assertIn("differing pixels  0 of", self.succeeds(["raylab-image", "compare", self.output, whole]))
        self.assertIn("raylab.partial: false", self.succeeds(["raylab-image", "info", self.output]))


class Parallel(ClusterTest):
    program = "raylab-parallel"

    def setUp(self):
        needed("parallel")
        super().setUp()

    def test_killed_interrupted_lost_and_resumed(self):
        spp = 9000
        command = self.command("--jobs", 2, spp=spp, render=["--checkpoint-every", "0.05s"])
        log = log_of(self.parts / "part-0-2250.exr")

        def wait_for_run(number):
            wait_for(f"run {number} of part 0", lambda: len(re.findall("^part 0 on", log.read_text(), re.M)) == number)

        run = self.start(command)
        self.kill_render("part-0-2250.exr")
        wait_for_run(2)
        self.fails(1, "in use by another run", command)
        status = self.status()
        self.assertEqual(status.returncode, 1)
        self.assertRegex(status.stdout, "^4 parts: . done, [12] running, 0 failed")
        run.send_signal(signal.SIGINT)
        self.assertIn("the same command goes on", run.communicate()[0])
        self.assertEqual(run.returncode, 130)
        self.assertFalse(self.output.exists())
        self.assertRegex(self.status().stdout, "^4 parts: . done, 0 running, 0 failed, [12] stopped, 0 lost, . waiting")
        # As a machine that fails ends it.
        self.start(command)
        wait_for_run(3)
        end_children()
        os.utime(log, (0, 0))
        self.assertRegex(self.status().stdout, "^4 parts: . done, . running, 0 failed, . stopped, 1 lost")
        self.succeeds(command)
        wait_for_run(4)
        self.assertRegex(log.read_text(), "resumed    .* with ")
        self.assertEqual(self.status().returncode, 0)
        self.expect_bits_of_one_render(spp)

    def test_lost_and_damaged_parts_alone_are_rendered_again(self):
        self.succeeds(self.command())
        times = {file.name: file.stat().st_mtime_ns for file in self.parts.glob("part-*.exr")}
        self.assertEqual(len(times), 4)
        (self.parts / "part-2-4.exr").unlink()
        os.truncate(self.parts / "part-6-8.exr", 20000)
        self.assertIn("4 parts: 2 done", self.status().stdout)
        self.succeeds(self.command())
        self.expect_bits_of_one_render(8)
        again = [name for name, then in times.items() if (self.parts / name).stat().st_mtime_ns != then]
        self.assertEqual(sorted(again), ["part-2-4.exr", "part-6-8.exr"])

    def test_a_part_that_always_fails_is_told_and_the_others_are_merged(self):
        # A folder is in the way of one part's checkpoint.
        in_the_way = self.parts / "part-4-6.exr.checkpoint.exr"
        in_the_way.mkdir(parents=True)
        result = self.run_all(self.command())
        self.assertEqual(result.returncode, 1)
        self.assertIn("failed part 2 (samples 4:6): exit ", result.stdout)
        self.assertIn("1 of 4 parts are missing: the same command tries them again", result.stderr)
        self.assertEqual(log_of(self.parts / "part-4-6.exr").read_text().count("exit "), 3)  # the --retries
        self.assertIn("raylab.partial: true", self.succeeds(["raylab-image", "info", self.output]))
        in_the_way.rmdir()
        self.succeeds(self.command())
        self.expect_bits_of_one_render(8)

    def test_dry_run_and_errors(self):
        plan = self.succeeds(self.command("--dry-run")).splitlines()
        self.assertEqual(len(plan), 6)
        self.assertIn("--joblog", plan[0])
        self.assertIn("--samples 2:4", plan[2])
        self.assertIn("raylab-image merge ", plan[5])
        self.assertFalse(self.parts.exists())
        self.fails(2, "--samples cannot be given", self.command(render=["--samples", "0:2"]))
        self.fails(2, "9 parts cannot be made of 8 samples", self.command(parts=9))
        self.fails(2, "--max-dept", self.command(render=["--max-dept", "3"]))
        self.fails(2, "a scene and --parts are needed", [CLUSTER / self.program, "-o", "a.exr"])
        self.fails(3, "nosuch.toml", [CLUSTER / self.program, "nosuch.toml", "-o", "a.exr", "--parts", "2"])
        self.fails(1, "there are no parts", [CLUSTER / self.program, "-o", "a.exr", "--status"])
        self.succeeds(self.command())
        self.fails(1, "has the parts of another command", self.command(render=["--seed", "2"]))


class Ssh(ClusterTest):
    program = "raylab-parallel"

    def setUp(self):
        needed("parallel", "sshd", "ssh", "ssh-keygen")
        super().setUp()
        port = free_port()
        for key in ("host", "user"):
            self.run_all(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", self.servers / key])
        (self.servers / "known").write_text(f"[127.0.0.1]:{port} {(self.servers / 'host.pub').read_text()}")
        (self.servers / "sshd.conf").write_text(
            f"ListenAddress 127.0.0.1:{port}\nHostKey {self.servers}/host\nAuthorizedKeysFile {self.servers}/user.pub\n"
            "PidFile none\nStrictModes no\nUsePAM no\nPasswordAuthentication no\n")
        sshd = [shutil.which("sshd", path=PATH), "-D", "-e", "-f", str(self.servers / "sshd.conf")]
        if os.geteuid() == 0 and not os.path.exists("/run/sshd"):
            # As root it wants a folder there, and gets one that only it sees.
            sshd = ["unshare", "--mount", "sh", "-c", 'mount -t tmpfs none /run && mkdir /run/sshd && exec "$@"', "-",
                    *sshd]
        self.ssh = (f"ssh -F none -p {port} -i {self.servers}/user -o IdentitiesOnly=yes -o BatchMode=yes "
                    f"-o UserKnownHostsFile={self.servers}/known {USER}@127.0.0.1")
        log = self.servers / "sshd.log"
        with open(log, "w") as out:
            server = subprocess.Popen(sshd, stdin=subprocess.DEVNULL, stdout=out, stderr=out)
        wait_for("sshd", lambda: server.poll() is not None or "Server listening" in log.read_text())
        login = self.run_all([*self.ssh.split(), "true"])
        if login.returncode:
            self.skipTest(f"sshd cannot start or take a login here: {login.stderr.strip()} {log.read_text().strip()}")

    def test_hosts_of_which_a_render_is_killed(self):
        spp = 9000
        (self.servers / "hosts").write_text(f"{self.ssh}\n")
        run = self.start(self.command("--sshlogin", ":", "--sshloginfile", self.servers / "hosts", parts=4, spp=spp,
                                      render=["--checkpoint-every", "0.05s"]))
        # One on each host, side by side, as the second would not wait to be killed until the first is.
        with concurrent.futures.ThreadPoolExecutor() as pool:
            list(pool.map(self.kill_render, ("part-0-2250.exr", "part-2250-4500.exr")))
        said = run.communicate()[0]
        self.assertEqual(run.returncode, 0, said)
        hosts = [line.split("\t")[1] for line in (self.parts / "joblog").read_text().splitlines()]
        self.assertIn(":", hosts)
        self.assertTrue(any("127.0.0.1" in host for host in hosts), hosts)
        self.expect_bits_of_one_render(spp)


class Slurm(ClusterTest):
    program = "raylab-slurm"

    def setUp(self):
        needed("sbatch", "slurmctld", "slurmd", "munged")
        super().setUp()
        host = os.uname().nodename.split(".")[0]
        there = self.servers
        (there / "key").write_bytes(os.urandom(64))
        (there / "key").chmod(0o600)
        (there / "state").mkdir()
        (there / "spool").mkdir()
        # cred_expire is also how long a job that was requeued waits; 5 s is the least.
        (there / "slurm.conf").write_text(f"""
ClusterName=raylab
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={there}/munge.sock,cred_expire=5
SlurmUser={USER}
SlurmdUser={USER}
StateSaveLocation={there}/state
SlurmdSpoolDir={there}/spool
SlurmctldPidFile={there}/slurmctld.pid
SlurmdPidFile={there}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()}
PartitionName=main Nodes=ALL Default=YES State=UP
""")
        self.environment["SLURM_CONF"] = str(there / "slurm.conf")
        self.server("munged", "--foreground", f"--socket={there}/munge.sock", f"--key-file={there}/key",
                    f"--pid-file={there}/munge.pid", f"--log-file={there}/munged.log", f"--seed-file={there}/seed")
        wait_for("munged", lambda: self.poll("munged") or (there / "munge.sock").exists())
        self.server("slurmctld", "-D")
        self.server("slurmd", "-D")
        try:
            wait_for("Slurm's node", lambda: self.poll("slurmctld") or self.poll("slurmd") or self.run_all(
                ["sinfo", "--noheader", "--format=%T"]).stdout.strip() == "idle", 20)
        except AssertionError as late:
            self.skipTest(f"Slurm cannot start here: {late}")

    def server(self, name, *options):
        with open(self.servers / f"{name}.out", "w") as out:
            setattr(self, name, subprocess.Popen([shutil.which(name, path=PATH), *options], env=self.environment,
                                                 stdin=subprocess.DEVNULL, stdout=out, stderr=out))

    def poll(self, name):
        if getattr(self, name).poll() is not None:
            said = (self.servers / f"{name}.out").read_text().strip().splitlines()
            self.skipTest(f"{name} cannot start here: {said[-1] if said else 'it says nothing'}")

    def wait_for_jobs(self):
        wait_for("the jobs to end", lambda: not self.succeeds(["squeue", "--noheader"]).strip(), 120)

    def test_killed_requeued_and_merged_by_the_job_that_waits(self):
        spp = 9000
        said = self.succeeds(self.command(parts=2, spp=spp, render=["--checkpoint-every", "0.05s"]))
        self.assertIn("submitted 2 of 2 parts as job", said)
        self.kill_render("part-0-4500.exr")
        wait_for("the other part", Path(f"{self.parts}/part-4500-9000.exr.checkpoint.exr").exists)
        self.assertRegex(self.status().stdout, "^2 parts: 0 done, 1 running, 1 failed")
        job = self.succeeds(["squeue", "--noheader", "--states=RUNNING", "--format=%i"]).strip()
        self.succeeds(["scontrol", "requeue", job])
        self.wait_for_jobs()
        for part in ("part-0-4500.exr", "part-4500-9000.exr"):
            self.assertRegex(log_of(self.parts / part).read_text(), "(?s)exit 1.*resumed    .* with .*exit 0\n$")
        self.assertIn("2 parts: 2 done", self.status().stdout)
        self.assertEqual((self.parts / "merge.log").read_text().count("merged 2 parts"), 1)
        self.expect_bits_of_one_render(spp)

    def test_submitted_twice_cancelled_and_gone_on_with(self):
        spp = 6000
        command = self.command(parts=3, spp=spp, render=["--checkpoint-every", "0.05s"])
        self.succeeds(command)
        wait_for("a checkpoint", Path(f"{self.parts}/part-0-2000.exr.checkpoint.exr").exists)
        job = (self.parts / "jobs").read_text()
        self.fails(1, f"jobs {job} of this picture are queued or running", command)
        self.succeeds(["scancel", job])
        self.wait_for_jobs()
        self.assertRegex(self.status().stdout, "^3 parts: . done, 0 running, 0 failed, 1 stopped")
        self.succeeds(self.command("--wait", parts=3, spp=spp, render=["--checkpoint-every", "0.05s"]))
        self.expect_bits_of_one_render(spp)

    def test_dry_run(self):
        plan = self.succeeds(self.command("--dry-run", "--jobs", 3, "--sbatch=--time=5")).splitlines()
        self.assertEqual(len(plan), 6)
        for option in ("--requeue", "--array=0,1,2,3%3", "--time=5 job task 3"):
            self.assertIn(option, plan[0])
        self.assertFalse(self.parts.exists())


def too_long(*_):
    raise TimeoutError("the tests take too long")


if __name__ == "__main__":
    PR_SET_CHILD_SUBREAPER = 36
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    signal.signal(signal.SIGALRM, too_long)  # before ctest would end this process and not what it started
    signal.alarm(240)
    result = unittest.main(argv=[sys.argv[0], *sys.argv[2:]], exit=False, verbosity=2).result
    sys.exit(1 if not result.wasSuccessful() else 77 if len(result.skipped) == result.testsRun else 0)
