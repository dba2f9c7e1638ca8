"""What raylab-parallel and raylab-slurm share: a picture is cut into parts of its samples, each a film file in one
folder. What is in that folder is all the state there is, so the same command goes on after any interruption."""

import argparse
import concurrent.futures
import fcntl
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

NAME = Path(sys.argv[0]).name
# What each part sets for itself, or what would make parts of which some samples are missing.
NOT_FOR_PARTS = ("-o", "--output", "--samples", "--resume", "--progress", "-q", "--quiet", "--check", "--stats",
                 "--views", "--fly", "--time-limit", "--target-error", "--write-every", "--write-scene")
LOST_AFTER = 60  # seconds without a line in a log, to which a render writes one each 10 s


def fail(message, code=1):
    print(f"{NAME}: {message}", file=sys.stderr)
    raise SystemExit(code)


def program(name):
    """The absolute path of a program, looked for beside this one and in PATH."""
    found = shutil.which(name, path=os.path.dirname(os.path.abspath(sys.argv[0]))) or shutil.which(name)
    return os.path.abspath(found) if found else fail(f"{name} is not installed, or not in PATH")


def parse_command(description, add_options):
    """The options, with those of raylab-render after -- in `render`."""
    arguments = sys.argv[1:]
    split = arguments.index("--") if "--" in arguments else len(arguments)
    parser = argparse.ArgumentParser(
        prog=NAME, allow_abbrev=False, description=description, usage=f"{NAME} SCENE -o OUT --parts N [OPTIONS] "
        "[-- OPTIONS OF raylab-render]", epilog="Exit codes: 0 done; 1 parts are missing or failed; 2 usage; 3 bad "
        "scene; 4 output could not be written; 130 interrupted. The same command goes on where one was stopped.")
    parser.error = lambda message: fail(f"{message} (--help lists the options)", 2)
    parser.add_argument("scene", nargs="?", metavar="SCENE", help="scene file or model, as raylab-render takes it")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="picture to write, .exr (a film) or .png")
    parser.add_argument("--parts", type=int, metavar="N", help="into how many parts the samples are cut")
    parser.add_argument("--folder", metavar="DIR", help="where the parts and their logs are, on a disk that all "
                        "machines share (default: OUT.parts); remove it when the picture is done")
    parser.add_argument("--retries", type=int, default=3, metavar="N", help="how often a part that fails or is killed "
                        "is tried in all (default: 3)")
    parser.add_argument("--dry-run", action="store_true", help="print what would run, and run nothing")
    parser.add_argument("--status", action="store_true", help="of OUT alone: say which parts are done, running, "
                        "failed, stopped, lost and waiting; exit code 0 when all are done")
    add_options(parser)
    options = parser.parse_args(arguments[:split])
    options.render = arguments[split + 1:]
    for option in options.render:
        name = option.split("=")[0] if option.startswith("--") else option[:2]
        if name in NOT_FOR_PARTS:
            fail(f"{name} cannot be given to the render of a part", 2)
    if Path(options.output).suffix.lower() not in (".exr", ".png"):
        fail(f"{options.output}: the picture's name ends in .exr or .png", 2)
    if not options.status and not (options.scene and options.parts):
        fail("a scene and --parts are needed (--help lists the options)", 2)
    return options


class Picture:
    """The parts of a picture. `samples` are those of a pixel; part i has samples i * samples / parts and on."""

    def __init__(self, options):
        self.options = options
        self.output = os.path.abspath(options.output)
        self.folder = os.path.abspath(options.folder or options.output + ".parts")
        self.job = os.path.join(self.folder, "job")
        self.image = program("raylab-image")
        text = ""
        if os.path.exists(self.job):
            text = Path(self.job).read_text()
            self.samples, self.parts = map(int, re.search(r"^samples=(\d+) parts=(\d+)$", text, re.M).groups())
        if options.status:
            if not text:
                fail(f"{self.folder}: there are no parts")
            return
        self.render = [program("raylab-render"), options.scene, *options.render]
        self.samples, self.parts = self.samples_of_scene(), options.parts
        if not 1 <= self.parts <= self.samples:
            fail(f"--parts: {self.parts} parts cannot be made of {self.samples} samples a pixel", 2)
        self.script = self.script_text()
        if text and text != self.script:
            fail(f"{self.folder} has the parts of another command: remove it, or name another --folder")

    def samples_of_scene(self):
        """Asks raylab-render, which refuses now what each part would refuse later."""
        check = subprocess.run([*self.render, "--check"], stdout=subprocess.PIPE, text=True)
        if check.returncode:
            raise SystemExit(check.returncode)
        return int(re.search(r"^film .* (\d+) samples a pixel", check.stdout, re.M).group(1))

    def script_text(self):
        values = {"from": os.getcwd(), "image": self.image, "folder": self.folder, "output": self.output}
        return (f"#!/bin/bash\n# Made by {NAME}, for each part and for merging them.\n"
                f"samples={self.samples} parts={self.parts}\n"
                f"render=({shlex.join(self.render)})\n"
                + "".join(f"{name}={shlex.quote(value)}\n" for name, value in values.items())
                + Path(__file__).with_name("job.sh").read_text())

    def begin(self):
        """Makes the folder, and keeps other runs out of it as long as this one or a process of its own is alive."""
        try:
            os.makedirs(self.folder, exist_ok=True)
            self.lock = os.open(os.path.join(self.folder, "lock"), os.O_RDWR | os.O_CREAT)
            os.set_inheritable(self.lock, True)
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            Path(self.job).write_text(self.script)
        except BlockingIOError:
            fail(f"{self.folder} is in use by another run: wait for it or end it")
        except OSError as error:
            fail(f"{self.folder}: {error.strerror}", 4)

    def range(self, part):
        return self.samples * part // self.parts, self.samples * (part + 1) // self.parts

    def file(self, part):
        return os.path.join(self.folder, "part-{}-{}.exr".format(*self.range(part)))

    def is_whole(self, part):
        if not os.path.exists(self.file(part)):
            return False
        info = subprocess.run([self.image, "info", self.file(part)], capture_output=True, text=True)
        first, end = self.range(part)
        return info.returncode == 0 and {"raylab.partial: false", f"film: samples {first}:{end} of {self.samples}",
                                         f"raylab.samplesTaken: {end - first} to {end - first}"
                                         } <= set(info.stdout.splitlines())

    def missing(self):
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return [part for part, whole in enumerate(pool.map(self.is_whole, range(self.parts))) if not whole]

    def print_plan(self, engine, missing):
        """What would run: the engine's command, each part's, and the merging."""
        print(shlex.join(engine))
        for part in missing:
            samples = "{}:{}".format(*self.range(part))
            print(shlex.join([*self.render, "--samples", samples, "-o", self.file(part), "--resume"]))
        print(f"{shlex.join([self.image, 'merge'])} {shlex.quote(self.folder)}/part-*[0-9].exr "
              f"{shlex.join(['-o', self.output])}")

    def state(self, part):
        """Of a part that is not whole: running, failed, stopped, lost or waiting, and what its log says last."""
        log = Path(self.file(part) + ".log")
        try:
            lines = log.read_text(errors="replace").splitlines()
            age = time.time() - log.stat().st_mtime
        except OSError:
            return "waiting", ""
        if not lines or not lines[-1].startswith("exit "):
            return ("running" if age < LOST_AFTER else "lost"), lines[-1] if lines else ""
        return ("stopped" if lines[-1] == "exit 130" else "failed"), f"{lines[-1]}, {log}"

    def print_status(self):
        missing = self.missing()
        states = {part: self.state(part) for part in missing}
        counts = [f"{sum(state == name for state, _ in states.values())} {name}"
                  for name in ("running", "failed", "stopped", "lost", "waiting")]
        print(f"{self.parts} parts: {self.parts - len(missing)} done, {', '.join(counts)}")
        for part, (state, said) in states.items():
            if state != "waiting":
                print("{} part {} (samples {}:{}): {}".format(state, part, *self.range(part), said))
        return 1 if missing else 0
