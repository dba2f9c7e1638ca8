"""Whole pictures: speed against accuracy, and time to a given error."""

import textwrap

import style
from answers import of_base, ratio_text
from markup import Cell, missing, number_cell, table
from rays_charts import front
from style import number

SAMPLER_LINES = {"independent": "--"}
INTEGRATOR_MARKERS = {"path": "o", "book": "X"}
USUAL = {"integrator": "path", "sampler": "sobol", "ray_offset": "bounds"}
UNUSUAL = {"ray_offset": "offset of the book"}
DIMENSIONS = {"accel": "accelerator", "intersector": "triangle test", "quality": "build quality",
              "ray_offset": "offset of rays", "sampler": "sampler", "integrator": "strategy"}


def name_of(row):
    """What sets a way of rendering apart: what is usual goes without saying."""
    if row.get("renderer"):
        return row["renderer"]
    unusual = [UNUSUAL.get(field, row[field]) for field, usual in USUAL.items() if row.get(field, usual) != usual]
    return ", ".join([style.variant(row), *unusual])


def look_of(row):
    """Of the usual way: its accelerator's."""
    if name_of(row) == style.variant(row):
        return style.look_of(row)
    return style.look(name_of(row), row["accel"], INTEGRATOR_MARKERS.get(row.get("integrator"), "s"),
                      SAMPLER_LINES.get(row.get("sampler"), "-"))


def by_size(rows):
    """The rows of each scene, and of each size where a scene was rendered in several: only equal pictures compare."""
    scenes = style.by_scene(rows)
    sizes = {scene: {row["width"] for row in mine} for scene, mine in scenes.items()}
    groups = {}
    for scene, mine in scenes.items():
        for row in mine:
            name = scene if len(sizes[scene]) == 1 else f"{scene} at {row['width']} pixels"
            groups.setdefault(name, []).append(row)
    return groups


def by_way(rows):
    ways = {}
    for row in rows:
        ways.setdefault(name_of(row), []).append(row)
    return ways


def pictures(results, scenes, targets):
    """relMSE against seconds with the Pareto line; hollow where the target is only extrapolated to."""
    figure, axes = style.panels(len(scenes), 3, width=4.4, height=4.0)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        axis.set_xscale("log")
        axis.set_yscale("log")
        goals = by_way(targets.get(scene, []))
        for name, points in by_way(rows).items():
            points.sort(key=lambda row: row["spp"])
            look = look_of(points[0])
            axis.errorbar([p["seconds"] for p in points], [p["relmse"] for p in points],
                          yerr=[[min(p.get("relmse_error", 0.0), 0.9 * p["relmse"]) for p in points],
                                [p.get("relmse_error", 0.0) for p in points]],
                          xerr=[[p["seconds"] - p["seconds_min"] for p in points],
                                [p["seconds_max"] - p["seconds"] for p in points]],
                          color=look.color, linestyle=look.line, marker=look.marker, markersize=5, capsize=2,
                          elinewidth=0.8, linewidth=1.3, alpha=0.9)
            end = (points[-1]["seconds"], points[-1]["relmse"])
            for goal in goals.get(name, []):
                if goal.get("extrapolated"):
                    target = (goal["seconds"], goal["relmse"])
                    axis.plot(*zip(end, target), color=look.color, linestyle=":", linewidth=1)
                    axis.plot(*target, **look.dot(hollow=True))
                    end = target
            style.label_end(axis, *end, name, look.color)
        edge = front([(row["seconds"], row["relmse"]) for row in rows])
        axis.step(*zip(*edge), where="post", color=style.GREY, linestyle=":", linewidth=1, zorder=0)
        low = min(axis.get_ylim()[0], rows[0]["reference_relmse"] / 2.0)
        axis.axhspan(low, rows[0]["reference_relmse"], color=style.ZONE, zorder=-1)
        axis.set_ylim(bottom=low)
        style.logarithmic(axis.xaxis, 4)
        style.logarithmic(axis.yaxis)
        spp = sorted({row["spp"] for row in rows})
        axis.set_title(f"{scene}, {rows[0]['width']} × {rows[0]['height']}, {rows[0]['threads']} threads\n"
                       f"{', '.join(map(str, spp))} samples per pixel", fontsize=10)
        axis.set_xlabel("seconds of rendering")
        axis.set_ylabel("relMSE")
    style.finish(figure, "Whole pictures: speed against accuracy (down and to the left is better)", results)
    return figure


def varied(scenes):
    """In what the ways of rendering differ, and in what they do not, as a sentence."""
    rows = [row for rows in scenes.values() for row in rows if not row.get("renderer")]
    differ = [name for field, name in DIMENSIONS.items() if len({row.get(field) for row in rows}) > 1]
    same = [name for field, name in DIMENSIONS.items() if name not in differ]
    return (f"The ways of rendering differ in {', '.join(differ) or 'nothing'}"
            + (f"; no row here varies {', '.join(same)}." if same else "."))


def prices(rows, goals):
    """What equal error costs each way, and within what limits: the times to the target in times of one of them, with
    which all took turns, or, where rows were measured apart, error × seconds at most samples."""
    if goals and sum("time_ratio" in goal for goal in goals) == len(goals) - 1:
        return {name_of(goal): [goal.get("time_ratio", {"mean": 1.0})["mean"], *of_base(goal)] for goal in goals}
    price = {}
    for name, points in by_way(rows).items():
        last = max(points, key=lambda row: row["spp"])
        error = last.get("relmse_error", 0.0)
        price[name] = [last["relmse"] * last["seconds"], (last["relmse"] - 2 * error) * last["seconds_min"],
                       (last["relmse"] + 2 * error) * last["seconds_max"]]
    return price


def cheapest(scenes, targets):
    """The way with the least time for equal error, as a sentence; those within the noise are named too."""
    parts = []
    for scene, rows in scenes.items():
        price = prices(rows, targets.get(scene, []))
        best = min(price, key=lambda name: price[name][0])
        tied = [name for name in price if name != best and price[name][1] <= price[best][2]]
        worst = max(price, key=lambda name: price[name][0])
        text = f"on {scene} {best}" + (f" (not to be told from {' and '.join(tied)})" if tied else "")
        parts.append(text + (f", where {worst} takes {number(price[worst][0] / price[best][0])} times as long for the "
                             "same error" if worst != best and worst not in tied else ""))
    return "The least error for its time: " + "; ".join(parts) + "."


def dots(axis, rows, names, values, looks, text):
    """A row of the axis for each: a dot, hollow where it is extrapolated, and its text at the right."""
    for place, (row, value, look) in enumerate(zip(rows, values, looks)):
        axis.plot(value, place, **look.dot(hollow=row.get("extrapolated", False)))
        axis.annotate(text(row, value), (1.01, place), xycoords=("axes fraction", "data"), va="center", fontsize=8,
                      annotation_clip=False)
    if style.narrow:
        names = ["\n".join(textwrap.wrap(name, 18)) for name in names]
    axis.set_yticks(range(len(rows)), names, fontsize=8)
    axis.set_ylim(len(rows) - 0.4, -0.6)


def logarithmic_across(axis, values):
    axis.set_xscale("log")
    axis.set_xlim(min(values) / 1.5, max(values) * 1.5)
    style.logarithmic(axis.xaxis, 3 if style.narrow else 5)


def time_to_error(results, scenes):
    most = max(len(rows) for rows in scenes.values())
    figure, axes = style.panels(len(scenes), 3, width=4.6, height=0.8 + 0.3 * most)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        rows = sorted(rows, key=lambda row: row["seconds"])
        dots(axis, rows, [name_of(row) for row in rows], [row["seconds"] for row in rows], map(look_of, rows),
             lambda row, value: f"{number(value)} s" + (", extrapolated" if row.get("extrapolated") else ""))
        logarithmic_across(axis, [row["seconds"] for row in rows])
        axis.set_title(f"{scene}: relMSE {rows[0]['target_relmse']:g}")
        axis.set_xlabel("seconds")
    style.finish(figure, "Time to a given error (hollow: extrapolated)", results)
    return figure


def reached(scenes):
    """How many of the times were reached, and how far apart the first and the last are."""
    rows = [row for rows in scenes.values() for row in rows]
    beyond = sum(bool(row.get("extrapolated")) for row in rows)
    parts = []
    for scene, mine in scenes.items():
        first, last = (edge(mine, key=lambda row: row["seconds"]) for edge in (min, max))
        parts.append(f"on {scene} {name_of(first)} in {number(first['seconds'])} s"
                     + (f", {name_of(last)} last in {number(last['seconds'])} s" if last is not first else ""))
    return (f"Interpolated between measured points: {len(rows) - beyond} of {len(rows)}; extrapolated beyond the last: "
            f"{beyond}. First: {'; '.join(parts)}.")


def points_and_targets(results):
    rows = [row for row in results["rows"] if row["suite"] == "render"]
    return (by_size(row for row in rows if "question" not in row and "reference_relmse" in row),
            by_size(row for row in rows if row.get("question") == "time to error"))


def charts(results, _):
    measured, targets = points_and_targets(results)
    if measured:
        yield style.Chart(
            "convergence", cheapest(measured, targets),
            varied(measured) +
            " relMSE: mean of independent runs with its standard error; seconds: median and range. In the shaded zone"
            " the reference is the noisier of the two, so nothing can be measured there. A hollow mark on a dotted "
            "line is where error × seconds = constant would reach the target error: it is extrapolated. No measured "
            "point beats those on the grey dotted Pareto line in both. Unless it is said, integrator and sampler are "
            "path and sobol.",
            lambda: pictures(results, measured, targets))
    if targets:
        yield style.Chart(
            "time-to-error", reached(targets),
            "Filled marks are interpolated between two measured points; hollow marks are extrapolated as if error × "
            "seconds were constant, and not measured.",
            lambda: time_to_error(results, targets))


def estimate_cell(row):
    """What a picture's own samples say of its error, to be held against the relMSE."""
    if row.get("renderer"):
        return missing("another renderer's samples are not seen")
    if "estimated_relmse" not in row:
        return missing("it was not estimated")
    interval = row.get("estimated_relmse_95")
    below = [f"{number(interval['low'])}–{number(interval['high'])}"] if interval else []
    return Cell(number(row["estimated_relmse"]), row["estimated_relmse"],
                "; ".join(below + ([] if row["estimated_relmse_reliable"] else ["not reliable"])))


def points_table(scenes):
    return table(
        ["scene", "way", "samples", "seconds", "relMSE", "as its samples estimate it", "mean ratio"],
        [[scene, name_of(row), number_cell(row["spp"]),
          Cell(number(row["seconds"]), row["seconds"], f"{number(row['seconds_min'])}–{number(row['seconds_max'])}"),
          Cell(number(row["relmse"]), row["relmse"], f"± {number(row['relmse_error'])}" if "relmse_error" in row else ""),
          estimate_cell(row), Cell(f"{row['mean_ratio']:.5f}", row["mean_ratio"], f"± {row['mean_ratio_error']:.5f}")]
         for scene, rows in scenes.items() for row in sorted(rows, key=lambda row: row["spp"])])


def targets_table(scenes):
    return table(
        ["scene", "way", "relMSE", "seconds", "times as long, in turns (95%)"],
        [[scene, name_of(row), number(row["target_relmse"]),
          Cell(("≈ " if row.get("extrapolated") else "") + number(row["seconds"]), row["seconds"]),
          Cell(ratio_text(row), row["time_ratio"]["mean"]) if "time_ratio" in row else
          missing("it is what the others are compared with, or was measured apart")]
         for scene, rows in scenes.items() for row in rows])


def tables(results):
    """HTML of the points of the charts, of how other renderers were set, and of what they have otherwise."""
    measured, targets = points_and_targets(results)
    if measured:
        yield ("<h2>Whole pictures</h2><p class=\"notes\">relMSE is that against the reference, whose own is in it; what "
               "a picture's own samples say of it, with 95% interval, needs none.</p>") + points_table(measured)
    if targets:
        yield "<h2>Time to a given error</h2>" + targets_table(targets)
    peers = {(row["scene"], row["renderer"]): row for row in results["rows"] if row.get("settings")}
    if peers:
        yield "<h2>How other renderers were set</h2>" + table(
            ["scene", "renderer", "settings", "what differs in the scene", "start-up, s"],
            [[scene, renderer, ", ".join(row["settings"]), "; ".join(row.get("differences", [])) or "nothing known",
              number(row["start_up_seconds"]) if "start_up_seconds" in row else "–"]
             for (scene, renderer), row in peers.items()])
