#!/usr/bin/env python3
"""Measures whole renders: speed beside error, the runs to compare interleaved in one go.

    bench/render_figures.py threads samplers needs accels peers dragon --out bench/results

Each suite writes DIR/render-SUITE.json and the same as a table, DIR/render-SUITE.md. Times are medians over --repeats runs;
ratios are medians of the ratios of neighbouring runs, so that a machine whose speed drifts does not show.
"""
import argparse
import datetime
import json
import pathlib
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
REFERENCE_SPP = 8192


class Bench:
    """The programs under test, a scratch folder, and what was run."""

    def __init__(self, options):
        self.render_program = options.build / "raylab-render"
        self.image_program = options.build / "raylab-image"
        self.repeats = options.repeats
        self.peer_python = options.peer_python
        self.scratch = pathlib.Path(tempfile.mkdtemp(prefix="raylab-bench-"))
        self.cache = options.cache or self.scratch
        self.cache.mkdir(parents=True, exist_ok=True)

    def render(self, scene, output=None, **settings):
        """One run of raylab-render; its statistics, with the seconds of the whole process."""
        output = output or self.scratch / "picture.exr"
        stats = self.scratch / "stats.json"
        arguments = [f"scenes/{scene}.toml", "-o", output, "--stats", stats, "--quiet"]
        for name, value in settings.items():
            for one in value if isinstance(value, list) else [value]:
                arguments += [f"--{name.replace('_', '-')}", one]
        start = time.monotonic()
        subprocess.run([self.render_program, *map(str, arguments)], check=True, cwd=ROOT)
        row = json.loads(stats.read_text())
        row["process_seconds"] = time.monotonic() - start
        return row

    def compare(self, picture, reference):
        result = subprocess.run([self.image_program, "compare", "--json", picture, reference],
                                check=True, capture_output=True, text=True)
        return json.loads(result.stdout)

    def reference(self, scene, spp=REFERENCE_SPP, **settings):
        """A picture with another seed and many samples, made once and kept in the cache."""
        name = "-".join([scene, str(spp), *(f"{k}{v}" for k, v in settings.items())]).replace("/", "_")
        file = self.cache / f"reference-{name}.exr"
        if not file.exists():
            self.render(scene, output=file, spp=spp, seed=4711, **settings)
        return file

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
    """Two threads against one."""
    table = [["scene", "accel", "1 thread, s", "2 threads, s", "speed-up", "estimated relMSE"]]
    for scene, settings in {"cornell": {"width": 400, "spp": 16}, "dragon": {"width": 800, "spp": 16}}.items():
        rows = bench.interleaved({"one": {"threads": 1, **settings}, "two": {"threads": 2, **settings}}, scene)
        table.append([scene, rows["one"][0]["accel"], f"{median(rows['one'], 'seconds'):.3f}",
                      f"{median(rows['two'], 'seconds'):.3f}", f"{ratio(rows['one'], rows['two'], 'seconds'):.3f}",
                      f"{rows['two'][0]['estimated_relmse']:.4f}"])
    return table


def samplers(bench):
    """Owen-scrambled Sobol against independent samples, error and time of each."""
    table = [["scene", "spp", "relMSE independent", "relMSE sobol", "s independent", "s sobol",
              "error ratio at equal spp", "at equal time"]]
    for scene in ["cornell", "one-weekend", "globe", "forest"]:
        size = {"width": 64}
        reference = bench.reference(scene, **size)
        for spp in [16, 64, 256]:
            rows = bench.interleaved({kind: {"sampler": kind, "spp": spp, **size}
                                      for kind in ["independent", "sobol"]}, scene)
            errors = {}
            for kind in rows:
                picture = bench.scratch / f"{kind}.exr"
                errors[kind] = []
                for seed in range(1, 4):
                    bench.render(scene, output=picture, sampler=kind, spp=spp, seed=seed, **size)
                    errors[kind].append(bench.compare(picture, reference)["relmse"])
            independent, sobol = (statistics.mean(errors[k]) for k in ["independent", "sobol"])
            slower = ratio(rows["sobol"], rows["independent"], "seconds")
            # Independent samples halve their error with twice the time: a slower sampler pays in proportion.
            table.append([scene, spp, f"{independent:.5f}", f"{sobol:.5f}",
                          f"{median(rows['independent'], 'seconds'):.3f}", f"{median(rows['sobol'], 'seconds'):.3f}",
                          f"{independent / sobol:.2f}", f"{independent / (sobol * slower):.2f}"])
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


def accels(bench):
    """Every accelerator's picture against that of testing every primitive, at equal seed."""
    listing = subprocess.run([bench.render_program, "--list-accels"], check=True, capture_output=True, text=True)
    names = [line.split()[0] for line in listing.stdout.splitlines()]
    table = [["scene", "accel", "s", "Mrays/s", "pixels that differ from list", "relMSE against list", "mean ratio"]]
    for scene, settings in {"cornell": {"width": 200, "spp": 16}, "one-weekend": {"width": 192, "spp": 4},
                            "mirror-room": {"width": 100, "spp": 4}, "globe": {"width": 40, "spp": 1},
                            "bunny": {"width": 80, "spp": 2}, "forest": {"width": 24, "spp": 1}}.items():
        pictures = {}
        for name in ["list"] + [n for n in names if n != "list"]:
            pictures[name] = bench.scratch / f"{name}.exr"
            row = bench.render(scene, output=pictures[name], accel=name, **settings)
            error = bench.compare(pictures[name], pictures["list"])
            table.append([scene, name, f"{row['seconds']:.3f}", f"{row['mrays_per_second']:.2f}",
                          f"{error['different_pixels']} of {error['pixels']}", f"{error['relmse']:.2g}",
                          f"{error['mean_ratio']:.6f} ± {error['mean_ratio_error']:.2g}"])
    return table


def peers(bench):
    """cornell beside Mitsuba 3: paths per second at 400², error at 64 samples and the mean of the picture at 100²."""
    ours = "Raylab"
    variants = {ours: None, "Mitsuba 3": [], "Mitsuba 3, lights one-sided (another picture)": ["--one-sided-lights"]}
    reference = bench.reference("cornell", width=100)
    picture, peer_json = bench.scratch / "peer.exr", bench.scratch / "peer.json"

    def run(extra, width, seed):
        if extra is None:
            return bench.render("cornell", output=picture, seed=seed, spp=64, width=width)
        subprocess.run([bench.peer_python, ROOT / "bench/peers/mitsuba_render.py", ROOT / "scenes/cornell.toml",
                        "--width", str(width), "--spp", "64", "--repeats", "1", "--threads", "2", "--seed", str(seed),
                        "-o", picture, "--json", peer_json, *extra], check=True, stdout=subprocess.DEVNULL)
        row = json.loads(peer_json.read_text())
        return {"seconds": row["seconds"]["median"], "mpaths_per_second": row["mpaths_per_second"],
                "accel": row["variant"]}

    rows = {name: [] for name in variants}
    for seed in range(1, bench.repeats + 1):
        for name, extra in variants.items():
            row = run(extra, 400, seed)
            run(extra, 100, seed)
            rows[name].append({**row, **bench.compare(picture, reference)})
    table = [["renderer", "s", "Mpaths/s", "relMSE at 64 spp", "mean ratio to our reference",
              "Raylab's Mpaths/s over it", "Raylab's relMSE over it"]]
    for name, group in rows.items():
        table.append([f"{name}, {group[0]['accel']}", f"{median(group, 'seconds'):.3f}",
                      f"{median(group, 'mpaths_per_second'):.3f}", f"{median(group, 'relmse'):.4f}",
                      f"{statistics.mean(r['mean_ratio'] for r in group):.4f} ± "
                      f"{median(group, 'mean_ratio_error') / len(group) ** 0.5:.1g}",
                      f"{ratio(rows[ours], group, 'mpaths_per_second'):.3f}",
                      f"{ratio(rows[ours], group, 'relmse'):.3f}"])
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


SUITES = {f.__name__: f for f in [threads, samplers, needs, accels, peers, dragon]}


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
    parser.add_argument("--cache", type=pathlib.Path, help="keep reference pictures here")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--peer-python", default=sys.executable, help="a Python that has the package mitsuba")
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
