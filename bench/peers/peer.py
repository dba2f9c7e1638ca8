"""What the peers' commands share: options, repeats, the mean, the picture and one JSON object.

A command's options left out are those of best_settings.py for the scene.
"""

import argparse
import json
import os
import statistics
import struct
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

from best_settings import BEST

try:
    import numpy as np
except ImportError as error:
    sys.exit(f"{Path(sys.argv[0]).name}: NumPy is not installed (Python package numpy): {error}")
from scene_file import InputError, SceneFile


@dataclass
class Rendered:
    picture: np.ndarray  # (height, width, 3)
    seconds: float  # of rendering alone, wall clock
    cpu_seconds: float  # the same, of all threads
    samples: int  # per pixel: not all samplers take any number


@dataclass
class Peer:
    """A renderer with a scene built in it."""

    name: str
    version: str
    width: int
    height: int
    max_depth: int
    settings: dict  # in the peer's own words
    differences: list[str]  # what of the scene is not the same as in Raylab
    render: Callable  # (seed, samples per pixel) -> Rendered
    start_up: dict[str, float] = field(default_factory=dict)  # seconds before rendering, by name
    prepare: Callable = lambda spp: None  # what so many samples per pixel need once, such as compiling: in start_up


class Command:
    def __init__(self, name: str, description: str, variants: list[str], samplers: list[str]):
        self.name = name
        self.began = time.perf_counter()
        self.parser = argparse.ArgumentParser(
            description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
        add = self.parser.add_argument
        add("scene", type=Path, nargs="?", help="Raylab scene file (TOML)")
        add("--probe", action="store_true", help="only say whether the renderer and the variant can be used")
        add("--variant", choices=variants, help="way of rendering (default: the best for the scene)")
        add("--sampler", choices=samplers, help="(default: the best for the scene)")
        add("--width", type=positive, help="pixels; alone, it keeps the scene's aspect ratio")
        add("--height", type=positive, help="pixels; alone, it keeps the scene's aspect ratio")
        add("--spp", type=positive, help="samples per pixel (default: the scene's)")
        add("--max-depth", type=positive, help="path segments, camera ray included (default: the scene's)")
        add("--repeats", type=positive, default=3, help="timed renders (default: 3)")
        add("--threads", type=positive, default=os.cpu_count(), help="default: all")
        add("--seed", type=int, default=0, help="of the first timed render; the others follow it")
        add("-o", "--output", type=Path,
            help="EXR of the first timed render, float RGB; with {seed} in its name, one of each")
        add("--json", type=Path, help="write the result to this file")
        add("--serve", action="store_true",
            help="stay, and render what each line of standard input asks for: a JSON object with seed, spp and output;"
                 " answer each with a line, after a first one that tells the renderer and its settings")

    def parse(self):
        arguments = self.parser.parse_args()
        if arguments.serve:  # answers alone go to standard output, where renderers print too
            self.answers = os.fdopen(os.dup(1), "w")
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if not arguments.scene and not arguments.probe:
            self.parser.error("a scene file is missing")
        best = BEST[self.name]
        scene = arguments.scene.stem if arguments.scene else ""
        for option, value in (best["otherwise"] | best.get(scene, {})).items():
            if getattr(arguments, option) is None:
                setattr(arguments, option, value)
        return arguments

    def fail(self, message: str):
        sys.exit(f"{self.name}_render.py: {message}")  # exit code 1

    def read_scene(self, arguments) -> SceneFile:
        """The scene file; what the options leave out of size, samples and depth is then the scene's."""
        file = SceneFile(arguments.scene)
        arguments.width, arguments.height = file.picture_size(arguments.width, arguments.height)
        arguments.spp = arguments.spp or file.samples_per_pixel
        arguments.max_depth = arguments.max_depth or file.max_depth
        return file

    @contextmanager
    def telling_errors(self):
        """Ends the program with one line where a scene cannot be read or built."""
        try:
            yield
        except (InputError, RuntimeError) as error:
            self.fail(str(error))

    def seconds(self) -> float:
        """Since this was called before, or since the start."""
        now = time.perf_counter()
        passed, self.began = now - self.began, now
        return passed

    def answer(self, values: dict):
        print(json.dumps(values), file=self.answers, flush=True)

    def serve(self, arguments, peer: Peer):
        """Tells of the renderer, then renders what it is asked for until standard input ends."""
        self.answer({"version": peer.version, "variant": arguments.variant, "settings": peer.settings,
                     "differences": peer.differences})
        prepared, waiting = set(), Watch()
        for line in sys.stdin:
            waited, waited_cpu = waiting.stop()
            asked = json.loads(line)
            if asked["spp"] not in prepared:
                peer.prepare(asked["spp"])
                prepared.add(asked["spp"])
            run = peer.render(asked["seed"], asked["spp"])
            write_exr(run.picture, asked["output"])
            self.answer({"seconds": run.seconds, "cpu_seconds": run.cpu_seconds, "spp": run.samples,
                         "start_up_seconds": sum(peer.start_up.values()), "waited_seconds": waited,
                         "waited_cpu_seconds": waited_cpu})
            waiting = Watch()

    def measure(self, arguments, peer: Peer):
        """Renders, prints what came out and writes the files asked for."""
        if arguments.serve:
            return self.serve(arguments, peer)
        peer.prepare(arguments.spp)
        runs = [peer.render(arguments.seed + repeat, arguments.spp) for repeat in range(arguments.repeats)]
        pictures = [run.picture for run in runs]
        mean, error = mean_and_error(pictures)
        samples = runs[0].samples
        median = statistics.median(run.seconds for run in runs)
        row = {
            "peer": peer.name,
            "version": peer.version,
            "variant": arguments.variant,
            "scene": arguments.scene.stem,
            "width": peer.width,
            "height": peer.height,
            "spp": samples,
            "max_depth": peer.max_depth,
            "threads": arguments.threads,
            "seed": arguments.seed,
            "settings": peer.settings,
            "differences": peer.differences,
            "seconds": median,
            "all_seconds": [run.seconds for run in runs],
            "all_cpu_seconds": [run.cpu_seconds for run in runs],
            "start_up_seconds": peer.start_up,
            "mpaths_per_second": peer.width * peer.height * samples / median * 1e-6,
            "mean": mean.tolist(),
            "mean_standard_error": error.tolist() if len(pictures) > 1 else None,
        }
        print(json.dumps(row, indent=1))
        if not all(abs(m) < float("inf") for m in mean):
            print("some pixels are not finite", file=sys.stderr)
        if arguments.output:
            for repeat, run in enumerate(runs if "{seed}" in arguments.output.name else runs[:1]):
                name = arguments.output.name.replace("{seed}", str(arguments.seed + repeat))
                self.replace_file(arguments.output.with_name(name), lambda file: write_exr(run.picture, file))
        if arguments.json:
            self.replace_file(arguments.json, lambda file: file.write_text(json.dumps(row, indent=1) + "\n"))

    def replace_file(self, file: Path, write: Callable):
        """Writes beside the file, then renames: what was there stays until the new one is whole."""
        partial = file.with_name(f".partial-{file.name}")
        try:
            write(partial)
            partial.replace(file)
        except (OSError, RuntimeError) as error:
            partial.unlink(missing_ok=True)
            self.fail(f"{file} could not be written: {error}")


class Watch:
    """Wall clock and processor time of all threads since it was made."""

    def __init__(self):
        self.start = time.perf_counter(), time.process_time()

    def stop(self) -> tuple[float, float]:
        return time.perf_counter() - self.start[0], time.process_time() - self.start[1]


def positive(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"found {value}, expected at least 1")
    return value


def mean_and_error(pictures):
    """Mean of each channel over all pictures and pixels, and its standard error from the spread of each pixel. Under
    a box filter pixels are independent."""
    stack = np.stack(pictures)
    count, pixels = len(pictures), stack[0].shape[0] * stack[0].shape[1]
    variance = stack.var(axis=0, ddof=1) / count if count > 1 else np.zeros_like(stack[0])
    return stack.mean(axis=(0, 1, 2)), np.sqrt(variance.sum(axis=(0, 1))) / pixels


def write_exr(picture, file: Path):
    """Float RGB, not compressed: the peers have no library in common that writes it."""
    height, width = picture.shape[:2]

    def attribute(name: str, kind: str, value: bytes) -> bytes:
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    header = struct.pack("<2i", 20000630, 2) + b"".join([
        attribute("channels", "chlist", channels),
        attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0.0, 0.0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1.0)),
    ]) + b"\0"
    line_bytes = 8 + 12 * width
    offsets = len(header) + 8 * height + line_bytes * np.arange(height, dtype="<u8")
    with open(file, "wb") as stream:
        stream.write(header + offsets.tobytes())
        for y, line in enumerate(picture.astype("<f4")):
            stream.write(struct.pack("<2i", y, 12 * width) + line[:, ::-1].T.tobytes())
