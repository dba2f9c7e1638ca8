#!/usr/bin/env python3
"""Measures whole renders as raylab-render makes them: on threads, without what a scene does not need, at full size.
Samplers, accelerators and peers against each other are the business of `raylab-bench render`.

    bench/render_figures.py threads needs dragon --out bench/results

Each suite writes DIR/render-SUITE.json and the same as a table, DIR/render-SUITE.md. Times are medians over --repeats runs;
ratios are medians of the ratios of neighbouring runs, so that a machine whose speed drifts does not show.
"""
import argparse
import concurrent.futures
import datetime
import json
import pathlib
import platform
import re
import statistics
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Bench:
    """The programs under test, a scratch folder, and what was run."""

    def __init__(self, options):
        self.render_program = options.build / "raylab-render"
        self.image_program = options.build / "raylab-image"
        self.repeats = options.repeats
        self.scratch = pathlib.Path(tempfile.mkdtemp(prefix="raylab-bench-"))

    def render(self, scene, output=None, name="picture", **settings):
        """One run of raylab-render; its statistics, with the seconds of the whole process."""
        output = output or self.scratch / f"{name}.exr"
        stats = self.scratch / f"{name}.json"
        arguments = [f"scenes/{scene}.toml", "-o", output, "--stats", stats, "--quiet"]
        for key, value in settings.items():
            for one in value if isinstance(value, list) else [value]:
                arguments += [f"--{key.replace('_', '-')}", one]
        start = time.monotonic()
        subprocess.run([self.render_program, *map(str, arguments)], check=True, cwd=ROOT)
        row = json.loads(stats.read_text())
        row["process_seconds"] = time.monotonic() - start
        return row

    def compare(self, picture, reference):
        result = subprocess.run([self.image_program, "compare", "--json", picture, reference],
                                check=True, capture_output=True, text=True)
        return json.loads(result.stdout)

    def interleaved(self, variants, scene):
        """Runs each of the named settings in turn, --repeats times; the rows of each."""
        rows = {name: [] for name in variants}
        for _ in range(self.repeats):
            for name, settings in variants.items():
                rows[name].append(self.render(scene, **settings))
        return rows


def median(rows, key):
    return statistics.median(row[key] for row in rows)


def ratio(rows, others, key):
    """Median of the ratios of runs that stood side by side."""
    return statistics.median(a[key] / b[key] for a, b in zip(rows, others))


def threads(bench):
    """Two threads against one, beside what the machine itself gives two of its processors: two processes of one thread
    each, at once, that share nothing but the machine."""
    table = [["scene", "accel", "1 thread, s", "2 threads, s", "speed-up", "spread of it", "two processes at once, s each",
              "the machine's speed-up", "estimated relMSE"]]
    for scene, settings in {"cornell": {"width": 400, "spp": 32}, "dragon": {"width": 800, "spp": 16}}.items():
        one, two, pair = [], [], []
        with concurrent.futures.ThreadPoolExecutor() as pool:
            for _ in range(bench.repeats):
                one.append(bench.render(scene, threads=1, **settings))
                two.append(bench.render(scene, threads=2, **settings))
                both = list(pool.map(lambda name: bench.render(scene, name=name, threads=1, **settings), ["left", "right"]))
                # Two pictures in the time of the slower one would count the moment in which only one still runs.
                pair.append({"seconds": statistics.mean(row["seconds"] for row in both)})
        low, _, high = statistics.quantiles([a["seconds"] / b["seconds"] for a, b in zip(one, two)], n=4)
        table.append([scene, one[0]["accel"], f"{median(one, 'seconds'):.3f}", f"{median(two, 'seconds'):.3f}",
                      f"{ratio(one, two, 'seconds'):.3f}", f"{low:.2f} to {high:.2f}", f"{median(pair, 'seconds'):.3f}",
                      f"{2 * ratio(one, pair, 'seconds'):.3f}", f"{two[0]['estimated_relmse']:.4f}"])
    return table


def needs(bench):
    """What a scene does without, against everything switched on."""
    table = [["scene", "scene bytes", "scene bytes, all on", "light bytes", "light bytes, all on", "s", "s, all on",
              "s all on / s", "estimated relMSE", "estimated relMSE, all on", "pixels that differ"]]
    # The last two are models that carry what their scene does not read: texture coordinates, and normals.
    variants = {
        "cornell": ("cornell", []),
        "globe": ("globe", []),
        "forest": ("forest", []),
        "dragon": ("dragon", []),
        "forest, all of one grey": ("forest", ["mesh.0.material=grey", 'material={grey={type="lambertian"}}']),
        "dragon that glows": ("dragon", ['material={green={type="diffuse_light",radiance=[0.1,0.5,0.1]}}']),
    }
    for name, (scene, overrides) in variants.items():
        settings = {"width": 400, "spp": 64, "set": overrides}
        rows = bench.interleaved({kind: {"needs": kind, **settings} for kind in ["scene", "all"]}, scene)
        pictures = [bench.scratch / f"{kind}.exr" for kind in ["scene", "all"]]
        for kind, picture in zip(["scene", "all"], pictures):
            bench.render(scene, output=picture, needs=kind, **settings)
        needed, everything = rows["scene"], rows["all"]
        table.append([name, needed[0]["scene_bytes"], everything[0]["scene_bytes"], needed[0]["light_bytes"],
                      everything[0]["light_bytes"], f"{median(needed, 'seconds'):.3f}",
                      f"{median(everything, 'seconds'):.3f}", f"{ratio(everything, needed, 'seconds'):.3f}",
                      f"{needed[0]['estimated_relmse']:.4f}", f"{everything[0]['estimated_relmse']:.4f}",
                      bench.compare(*pictures)["different_pixels"]])
    return table


def dragon(bench):
    """The dragon at its full size, whole process."""
    table = [["accel", "whole process, s", "loading, s", "building, s", "rendering, s", "Mpaths/s",
              "estimated relMSE"]]
    for name in ["default", "embree", "embree-robust"]:
        rows = [bench.render("dragon", spp=200, **({} if name == "default" else {"accel": name}))
                for _ in range(1 if name != "default" else min(bench.repeats, 2))]
        label = f"{name} ({rows[0]['accel']})" if name == "default" else name
        table.append([label, *(f"{median(rows, key):.2f}" for key in
                               ["process_seconds", "load_seconds", "build_seconds", "seconds", "mpaths_per_second"]),
                      f"{rows[0]['estimated_relmse']:.4f}"])
    return table


SUITES = {f.__name__: f for f in [threads, needs, dragon]}


def machine():
    cpuinfo = pathlib.Path("/proc/cpuinfo").read_text()
    name = re.search(r"model name\s*: (.*)", cpuinfo)
    return (f"{name.group(1) if name else platform.machine()}, {cpuinfo.count('processor' + chr(9))} threads, "
            f"{platform.freedesktop_os_release().get('PRETTY_NAME', platform.system())}")


def markdown(table):
    lines = ["| " + " | ".join(map(str, row)) + " |" for row in table]
    return "\n".join([lines[0], "|" + "---|" * len(table[0]), *lines[1:]]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("suites", nargs="+", choices=SUITES, metavar="SUITE", help=", ".join(SUITES))
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "bench/results")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release", help="folder of the programs")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    options.build = options.build.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(options)
    for suite in options.suites:
        table = SUITES[suite](bench)
        text = markdown(table)
        print(f"{SUITES[suite].__doc__}\n\n{text}")
        command = f"bench/render_figures.py {suite} --repeats {options.repeats}"
        record = {"machine": machine(), "command": command, "date": datetime.date.today().isoformat(),
                  "rows": [dict(zip(table[0], row)) for row in table[1:]]}
        (options.out / f"render-{suite}.json").write_text(json.dumps(record, indent=1) + "\n")
        page = f"# {suite}\n\n{SUITES[suite].__doc__}\n\n{text}\n`{command}` on {record['machine']}, {record['date']}.\n"
        (options.out / f"render-{suite}.md").write_text(page)


if __name__ == "__main__":
    main()
