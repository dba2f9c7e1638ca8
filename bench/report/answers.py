"""The tables that open the page: what each accelerator gives on a scene, and what it costs in wrong answers."""

import operator
from html import escape

import intervals
import style
from markup import Cell, missing, table
from style import number

SPEED_KINDS = ["primary", "diffuse", "shadow"]
WRONG_KINDS = {"edge": "edges", "vertex": "vertices"}
OWN_TESTS = {"rtiow": "book"}  # the triangle test where none is asked for; of the others that have a choice: watertight
WHY_NOT = {kind: f"no {kind} rays of this scene were measured" for kind in SPEED_KINDS}


def ways_of(rows):
    """The rows of a scene by way (accelerator, triangle test, how it is built) and kind of rays."""
    ways = {}
    for row in rows:
        ways.setdefault(style.variant(row), {})[row["rays"]] = row
    return ways


# Medians of one run differ from those of another by less than this on a shared machine, where the ends of the ranges
# do not: what lies within it of the best is marked too, so that two runs mark the same.
AS_GOOD = 0.1
AS_SHORT = 1e-3  # seconds: less is nothing that anyone waits for


def as_fast(speeds):
    """Which speeds are as good as the largest."""
    return [speed >= (1.0 - AS_GOOD) * max(speeds) for speed in speeds]


def as_short(seconds, least):
    """Whether they are as good as the least ones."""
    return seconds <= max((1.0 + AS_GOOD) * least, least + AS_SHORT)


def of_base(row):
    """The interval of a time to the target in times of the way that it was measured in turns with, or which it is."""
    ratio = row.get("time_ratio", {"low": 1.0, "high": 1.0})
    return ratio["low"], ratio["high"]


def as_soon(row, first):
    """Whether a whole picture cannot be told to take more than a tenth longer to the target than the first one."""
    if "time_ratio" not in row and "time_ratio" not in first:  # measured apart
        return as_short(row["seconds"], first["seconds"])
    return of_base(row)[0] <= (1.0 + AS_GOOD) * of_base(first)[1]


def limits(low, high):
    return f"{number(low)}–{number(high)}"


def of_million(wrong, checked):
    """Wrong answers in a million and their 95% interval, as two texts."""
    low, high = (1e6 * limit for limit in intervals.proportion(wrong, checked))
    if wrong == 0:
        return f"below {number(high)}", f"0 of {checked:,}"
    return number(1e6 * wrong / checked), limits(low, high)


def speed_columns(ways, kind, field):
    """The cells of a column of speeds, one a way."""
    known = {name: kinds[kind][field] for name, kinds in ways.items() if field in kinds.get(kind, ())}
    best = dict(zip(known, as_fast([s["median"] for s in known.values()]))) if known else {}
    any_kind = any(kind in kinds for kinds in ways.values())
    why = WHY_NOT[kind] if not any_kind else "no row holds its speed in batches"
    return [Cell(number(s["median"]), s["median"], limits(s["min"], s["max"]), best[name])
            if (s := known.get(name)) else missing(why) for name in ways]


def wrong_columns(ways, kind):
    rows = {name: kinds[kind] for name, kinds in ways.items() if kind in kinds}
    fewest = dict(zip(rows, intervals.as_few([(r["wrong"], r["rays_checked"]) for r in rows.values()]))) if rows else {}
    cells = []
    for name in ways:
        if row := rows.get(name):
            text, below = of_million(row["wrong"], row["rays_checked"])
            if row.get("wrong_batch", row["wrong"]) != row["wrong"]:
                below += f"; in batches {number(1e6 * row['wrong_batch'] / row['rays_checked'])}"
            cells.append(Cell(text, row["wrong"] / row["rays_checked"], below, fewest[name]))
        else:
            cells.append(missing(f"no rays at {WRONG_KINDS[kind]}: the scene has none, or they were not measured"))
    return cells


def least_columns(ways, value, is_best, below=lambda row: ""):
    """A column of which the least is the best, the same for all kinds of rays."""
    rows = [next(iter(kinds.values())) for kinds in ways.values()]
    least = min(map(value, rows))
    return [Cell(number(value(row)), value(row), below(row), is_best(value(row), least)) for row in rows]


def is_own_test(row):
    return row.get("intersector") in (None, OWN_TESTS.get(row["accel"], "watertight"))


def picture_columns(ways, targets):
    """Seconds to equal error: rendered with each accelerator's own triangle test, path and sobol."""
    seconds = {style.variant({**row, "intersector": ""}): row for row in targets
               if row.get("integrator") == "path" and row.get("sampler") == "sobol"}
    first = min(targets, key=lambda row: row["seconds"], default=None)
    cells = []
    for kinds in ways.values():
        row = next(iter(kinds.values()))
        if not seconds:
            cells.append(missing("no whole pictures of this scene were measured"))
        elif not is_own_test(row):
            cells.append(missing("whole pictures are rendered with the accelerator's own triangle test"))
        elif found := seconds.get(style.variant({**row, "intersector": ""})):
            cells.append(picture_cell(found, as_soon(found, first)))
        else:
            cells.append(missing("no whole picture was measured with it"))
    return cells


def peer_rows(targets, columns):
    """A row for each other renderer, of which only whole pictures can be measured."""
    why = "of another renderer only whole pictures are measured"
    first = min(targets, key=lambda row: row["seconds"], default=None)
    for row in targets:
        if row.get("renderer"):
            yield [row["renderer"], *(missing(why) for _ in range(columns - 2)), picture_cell(row, as_soon(row, first))]


def ratio_text(row):
    """How many times as long as the way that it took turns with; empty where it took none."""
    if "time_ratio" not in row:
        return ""
    ratio = row["time_ratio"]
    return f"{number(ratio['mean'])} ({limits(ratio['low'], ratio['high'])}) × {row['against']}"


def picture_cell(row, best=False):
    extrapolated = row.get("extrapolated")
    below = "; ".join(filter(None, ["extrapolated" if extrapolated else "", ratio_text(row)]))
    return Cell(("≈ " if extrapolated else "") + number(row["seconds"]), row["seconds"], below, best)


def scene_table(rows, targets):
    ways = ways_of(rows)
    first = rows[0]
    primitive = "triangle" if not first["spheres"] else "primitive"
    columns = [("accelerator", list(ways))]
    for kind in SPEED_KINDS:
        columns += [("single", speed_columns(ways, kind, "mrays_per_second")),
                    ("batch", speed_columns(ways, kind, "mrays_per_second_batch"))]
    columns += [(f"at {name}", wrong_columns(ways, kind)) for kind, name in WRONG_KINDS.items()]
    columns += [
        ("seconds", least_columns(ways, lambda row: row["build_seconds"], as_short,
                            lambda row: limits(row["build_seconds_min"], row["build_seconds_max"]))),
        (f"bytes a {primitive}", least_columns(ways, lambda row: row["bytes"] / (row["triangles"] + row["spheres"]),
                                               operator.eq)),
        (f"s to relMSE {targets[0]['target_relmse']:g}" if targets else "s to equal error",
         picture_columns(ways, targets))]
    groups = [("", 1), *((f"{kind}, million a second", 2) for kind in SPEED_KINDS), ("wrong answers in a million", 2),
              ("build", 1), ("memory", 1), ("whole picture", 1)]
    body = [*zip(*(cells for _, cells in columns)), *peer_rows(targets, len(columns))]
    return table([head for head, _ in columns], body, groups)


def summary(scene, rows):
    """What the rows of a scene say, in a sentence or two."""
    ways = ways_of(rows)
    kind = "diffuse" if any("diffuse" in kinds for kinds in ways.values()) else rows[0]["rays"]
    ways = {name: kinds for name, kinds in ways.items() if kind in kinds}
    wrong = {name: sum(row["wrong"] for row in kinds.values()) for name, kinds in ways.items()}
    checked = {name: sum(row["rays_checked"] for row in kinds.values()) for name, kinds in ways.items()}

    def fastest(names):
        return max(names, key=lambda name: ways[name][kind]["mrays_per_second"]["median"])

    def speed(name):
        row = ways[name][kind]
        batch = row.get("mrays_per_second_batch")
        return (f"{number(row['mrays_per_second']['median'])} million {kind} rays a second"
                + (f", {number(batch['median'])} in batches" if batch else ""))

    clean = [name for name in ways if wrong[name] == 0]
    if not clean:
        best = min(ways, key=lambda name: wrong[name] / checked[name])
        return (f"{scene}: each way answers some rays wrongly; {best} the fewest, {wrong[best]:,} of "
                f"{checked[best]:,}, at {speed(best)}.")
    best, first = fastest(clean), fastest(ways)
    high = 1e6 * intervals.proportion(0, checked[best])[1]
    says = (f"{scene}: {len(clean)} of {len(ways)} ways gave no wrong answer to {checked[best]:,} checked rays (below "
            f"{number(high)} in a million at 95%); the fastest of them is {best}: {speed(best)}.")
    if first != best:
        speeds = [ways[name][kind]["mrays_per_second"]["median"] for name in (first, best)]
        told = "is as fast, within a tenth" if all(as_fast(speeds)) else "is the fastest of all"
        says += f" {first}, wrong on {wrong[first]:,} of {checked[first]:,}, {told}: {speed(first)}."
    return says


def measured(results):
    """The rows of the suite rays that were checked, by scene."""
    return style.by_scene(row for row in results["rows"] if row["suite"] == "rays" and row.get("rays_checked"))


def html(results):
    """The section that opens the page: a table for each scene, the first one open."""
    scenes = measured(results)
    if not scenes:
        return "<p>No single rays were measured yet: <code>raylab-bench rays</code> measures them.</p>"
    targets = style.by_scene(row for row in results["rows"] if row.get("question") == "time to error")
    parts = []
    for scene, rows in scenes.items():
        of_scene = targets.get(scene, [])
        widest = max((row["width"] for row in of_scene), default=0)  # only pictures of one size compare
        of_scene = [row for row in of_scene if row["width"] == widest]
        inside = f"<p>{escape(summary(scene, rows))}</p>\n{scene_table(rows, of_scene)}"
        title = ", ".join([scene, *(f"{rows[0][kind]:,} {kind}" for kind in ("triangles", "spheres") if rows[0][kind])])
        parts.append(f"<h2>{escape(title)}</h2>\n{inside}" if not parts else
                     f"<details><summary>{escape(title)}</summary>\n{inside}\n</details>")
    repeats = min(row["runs"] for rows in scenes.values() for row in rows)
    coverage = min(100.0 * intervals.median_coverage(repeats), 99.9)
    reading = (
        "Speeds are medians, on one thread; small beneath them the least and the most of all repeats, which hold the "
        f"median at {coverage:.3g}% or more (sign test, {repeats} repeats at least). Wrong answers: leaks, false "
        "misses, false hits and wrong primitives against the exact answer, with Clopper and Pearson's 95% interval. "
        "Marked: the best of a column, and those that are as good: speeds and seconds within a tenth of it (or a "
        "millisecond), which is what two runs differ by on a shared machine, whole pictures that are not surely more than "
        "a tenth slower, and counts that Fisher's exact test with Holm's correction does not tell apart at 5%. Beneath "
        "the seconds of a whole picture: how many times as long as with the accelerator named, with which it took "
        "turns; mean and 95% interval over rounds (Student's t). Batch: 512 rays at once, as the renderer sends them.")
    return "\n".join([*parts[:1], f'<p class="notes">{reading}</p>', *parts[1:]])
