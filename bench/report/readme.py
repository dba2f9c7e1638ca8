#!/usr/bin/env python3
"""Writes the section Results of a README from a folder of results: each figure there is one of results.json.

    bench/report/readme.py DIR README [--check]

The section stands between two comments that name this program. --check writes nothing, and exits with 1 where the
section is not what it would write. Needs scipy, as report.py.
"""

import argparse
import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True

import answers  # noqa: E402  (after no byte code is written)
import rows  # noqa: E402
import stability_charts as stability  # noqa: E402
import style  # noqa: E402
from style import number  # noqa: E402

BEGIN, END = "<!-- bench/report/readme.py writes from here -->", "<!-- to here -->"
SCENES = ["dragon", "bunny", "cornell", "one-weekend"]
ACCELERATORS = ["rtiow", "bvh", "embree", "embree-robust"]


STUDENT = (" The student path tracer that Raylab follows published 36 h 37 m 37 s on 16 threads of a Ryzen 7 5700U for its "
           "dragon of 871,478 triangles at 800 × 800, 200 samples and 5 segments.")


def markdown(head, body):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head),
                      *("| " + " | ".join(line) + " |" for line in body)])


def spread(s):
    return number(s["median"]) if s else "–"


def ray_table(results):
    """Speed and wrong answers of each accelerator's own triangle test, on the scenes that were measured."""
    scenes = answers.measured(results)
    body = []
    for scene in (name for name in SCENES if name in scenes):
        ways = answers.ways_of(row for row in scenes[scene] if answers.is_own_test(row))
        for accel in ACCELERATORS:
            for kinds in (kinds for kinds in ways.values() if next(iter(kinds.values()))["accel"] == accel):
                row = next(iter(kinds.values()))
                if row.get("quality", "balanced") != "balanced" or row.get("compact"):
                    continue
                speeds = [f"{spread(kinds[k].get('mrays_per_second'))} / {spread(kinds[k].get('mrays_per_second_batch'))}"
                          if k in kinds else "–" for k in answers.SPEED_KINDS]
                wrong = [sum(kinds[k][field] for k in answers.WRONG_KINDS if k in kinds)
                         for field in ("wrong", "rays_checked")]
                text, below = answers.of_million(*wrong) if wrong[1] else ("–", "")
                body.append([scene, f"`{accel}`", *speeds, f"{text} ({below})" if below else text,
                             number(row["build_seconds"]), number(row["bytes"] / (row["triangles"] + row["spheres"]))])
    return markdown(["scene", "`--accel`", *(f"{k}, single / batch" for k in answers.SPEED_KINDS),
                     "wrong in a million at edges and vertices (95%)", "build, s", "bytes a primitive"], body)


def bare_table(results):
    """Our Embree backends and `bvh` in batches, over the fastest bare loop over Embree."""
    body = [[row["scene"], row["rays"], f"`{row['accel']}`", number(row["mrays_per_second_bare"]), row["fastest_bare"],
             f"{row['batch_of_fastest_bare']:.2f}", f"{row['bvh_of_fastest_bare']:.2f}"]
            for row in results["rows"] if row["suite"] == "embree"]
    if not body:
        return ""
    ratios = [row["bvh_of_fastest_bare"] for row in results["rows"] if row["suite"] == "embree"]
    behind = sum(ratio < 1.2 for ratio in ratios)
    says = (f"The aim of 1.2 times the best of Embree is missed in {behind} of these {len(ratios)} rows, "
            f"with {min(ratios):.2f} at the least." if behind else
            f"`bvh` is ahead in all rows, by {min(ratios):.2f} times at the least.")
    return says + "\n\n" + markdown(["scene", "rays", "Embree's mode", "fastest bare loop", "it is", "our backend ÷ it",
                              "`bvh` ÷ it"], body)


def picture_table(results):
    """Seconds to an equal error, of Raylab and of other renderers."""
    rows = [row for row in results["rows"] if row.get("question") == "time to error"]
    body, in_turns = [], any("time_ratio" in row for row in rows)
    for row in rows:
        if row["width"] != max(r["width"] for r in rows if r["scene"] == row["scene"]) or row["width"] < 400:
            continue
        who = row.get("renderer") or f"`{style.variant(row)}`"
        approximately = "≈ " if row.get("extrapolated") else ""
        body.append([row["scene"], who, number(row["target_relmse"]), approximately + number(row["seconds"]),
                     *([answers.ratio_text(row) or "–"] if in_turns else []), str(row["width"])])
    head = ["scene", "renderer", "relMSE", "seconds", *(["times as long (95%)"] if in_turns else []), "width"]
    return body and markdown(head, body)


def process_lines(results):
    for row in results["rows"]:
        if row["suite"] == "process" and row["accel"] == "bvh" and row.get("needs", "scene") == "scene":
            yield (f"- **{row['scene']}**, {row['width']} × {row['height']}, {row['spp']} samples, {row['max_depth']} "
                   f"segments, {row['threads']} threads: the whole process takes "
                   f"{spread(row['process_seconds'])} s (building {number(row['build_seconds'])} s, rendering "
                   f"{number(row['seconds'])} s) at an estimated relMSE of {number(row['estimated_relmse'])}."
                   + (STUDENT if row["scene"] == "dragon" else ""))


def thread_lines(results):
    for row in results["rows"]:
        if row["suite"] == "threads" and row["threads"] > 1:
            s = row["speedup"]
            yield (f"- **{row['threads']} threads against one**, {row['scene']}: {s['median']:.2f} times "
                   f"({s['min']:.2f} to {s['max']:.2f}).")


STABILITY_METHODS = ["rtiow book", "list fast", "embree", "embree-robust", "bvh watertight"]
STABILITY_CASES = [1, 4, 5, 9, 13, 14, 16, 23, 24, 34]


def stability_table(results):
    """From which value on each method fails, for cases that part them, and of how many cases it fails some."""
    cases = stability.cases_of(results)
    queries = {case: methods for case, methods in cases.items() if not stability.is_light(stability.first_of(methods))}
    if not set(STABILITY_CASES) <= set(queries):
        return ""
    body = []
    for case in STABILITY_CASES:
        row = stability.first_of(queries[case])
        cells = [stability.cell(queries[case], name) for name in STABILITY_METHODS]
        body.append([f"{row['scene']} ({row['swept']})", *(c.text for c in cells)])
    failed = []
    for name in STABILITY_METHODS:
        tried = [methods[name] for methods in queries.values() if name in methods]
        failing = sum(any(row["failures"] for rows_of in ways.values() for row in rows_of) for ways in tried)
        failed.append(f"{failing} of {len(tried)}")
    body.append(["**cases failed somewhere**", *failed])
    return markdown(["fails, at", *(f"`{name}`" for name in STABILITY_METHODS)], body)


def section(results):
    parts = [f"Machine: {style.machine_of(results)}.",
             "Million rays a second of one thread; medians. Each accelerator with its own triangle test; all others, "
             "intervals and charts: [bench/results](bench/results/index.html).", ray_table(results)]
    if bare := bare_table(results):
        parts += ["Embree at its best is the fastest of bare loops over `rtcIntersect1`, `8`, `16` (`c`: with the "
                  "coherent flag) and streams (`Np`), million rays a second (`raylab-bench embree`):", bare]
    if pictures := picture_table(results):
        parts += ["Whole pictures to an equal error, rendering alone, each renderer with the "
                  "[best settings found](bench/peers/README.md). Of another renderer the error is its noise, the spread of its "
                  "own pictures, since what it models otherwise would stay whatever the time; ≈: extrapolated, not "
                  "reached:", pictures]
    if failures := stability_table(results):
        parts += ["Where methods fail (`raylab-bench stability`: 66 known failures, swept over what breaks; some that "
                  "part the accelerators, single rays, batches where they differ). All of them, the pictures' too, with "
                  "rates and intervals: [bench/results](bench/results/index.html).", failures]
    if lines := [*process_lines(results), *thread_lines(results)]:
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("readme", type=Path, metavar="README")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    try:
        results = rows.read_results(options.folder / "results.json")
    except (rows.RowError, ValueError, OSError) as error:
        print(f"readme.py: {options.folder / 'results.json'}: {error}", file=sys.stderr)
        return 3
    old = options.readme.read_text(encoding="utf-8")
    if old.count(BEGIN) != 1 or old.count(END) != 1:
        print(f"readme.py: {options.readme}: expected one line '{BEGIN}' and one '{END}'", file=sys.stderr)
        return 3
    new = re.sub(re.escape(BEGIN) + ".*" + re.escape(END), lambda _: f"{BEGIN}\n\n{section(results)}\n\n{END}", old,
                 flags=re.DOTALL)
    if options.check and new != old:
        print(f"readme.py: {options.readme}: the results are not those of {options.folder}: write them again by "
              f"{parser.prog} {options.folder} {options.readme}", file=sys.stderr)
        return 1
    if not options.check:
        options.readme.write_text(new, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
