"""Growth with the number of triangles, and with threads."""

import math

from matplotlib.ticker import MaxNLocator

import style
from style import number

METRICS = [
    ("build, seconds, one thread", lambda row: row["build_seconds"]),
    ("bytes a triangle", lambda row: row["bytes"] / row["triangles"]),
    ("million rays a second, single", lambda row: row["mrays_per_second"]["median"]),
    ("million rays a second, batch", lambda row: row.get("mrays_per_second_batch", {}).get("median", math.nan)),
]
WRONG = {2: "wrong", 3: "wrong_batch"}  # of the metrics that are speeds


def by_way(rows):
    ways = {}
    for row in sorted(rows, key=lambda row: row["triangles"]):
        ways.setdefault(style.variant(row), []).append(row)
    return ways


def growth(results, families):
    figure, axes = style.panels(len(families) * len(METRICS), len(METRICS), width=3.6, height=2.7)
    for i, (family, rows) in enumerate(families.items()):
        for j, (label, metric) in enumerate(METRICS):
            axis = axes[i * len(METRICS) + j]
            axis.set_xscale("log")
            for name, points in by_way(rows).items():
                look = style.look_of(points[0])
                points = [row for row in points if not math.isnan(metric(row))]
                if not points:
                    continue
                xs, ys = [row["triangles"] for row in points], [metric(row) for row in points]
                axis.plot(xs, ys, marker=look.marker, markersize=4, color=look.color, linestyle=look.line)
                style.label_end(axis, xs[-1], ys[-1], name, look.color)
                # A ring around what was wrong: speed alone would praise it.
                if wrong := [(x, y) for x, y, row in zip(xs, ys, points) if row.get(WRONG.get(j), 0) > 0]:
                    axis.plot(*zip(*wrong), marker="o", markersize=11, markerfacecolor="none", color=style.VERMILION,
                              linestyle="none", label="ring: some answers were wrong")
            if j == 1:
                axis.set_ylim(bottom=0.0)
            else:
                axis.set_yscale("log")
                style.logarithmic(axis.yaxis)
            style.logarithmic(axis.xaxis)
            axis.set_title(f"{family}: {label}", fontsize=9)
            axis.set_xlabel("triangles", fontsize=9)
    style.finish(figure, "Growth with the number of triangles", results, style.legend_of(axes))
    return figure


def fastest(families):
    """The fastest at the largest size of each family, as a sentence with what was wrong."""
    parts = []
    for family, rows in families.items():
        most = max(row["triangles"] for row in rows)
        last = [row for row in rows if row["triangles"] == most]
        best = max(last, key=lambda row: row["mrays_per_second"]["median"])
        speed = number(best["mrays_per_second"]["median"])
        parts.append(f"on {family} {style.variant(best)} ({speed} million a second)")
    rows = [row for rows in families.values() for row in rows]
    wrong = sum(row["wrong"] > 0 for row in rows)
    return (f"The fastest with single rays at the largest size: {'; '.join(parts)}. {wrong or 'None'} of {len(rows)} "
            "measurements had wrong answers.")


def quotient(over, under):
    """The ratio of two medians whose runs were not paired, in the widest limits that their ranges allow."""
    return {"median": over["median"] / under["median"], "min": over["min"] / under["max"],
            "max": over["max"] / under["min"]}


def build_speed(row):
    return {"median": 1.0 / row["build_seconds"], "min": 1.0 / row["build_seconds_max"],
            "max": 1.0 / row["build_seconds_min"]}


def speedups(results):
    """{scene: [(name, what, threads, {median, min, max}, whether the runs were paired, a row for its look)]}"""
    found = {}
    for row in results["rows"]:
        if row["suite"] == "threads" and row["processes"] == 1 and row["threads"] > 1:
            found.setdefault(row["scene"], []).append(("render", row["speedup"], True, row))
    families = style.by_scene(row for row in results["rows"] if row["suite"] == "scale")
    for family, rows in families.items():
        for row in (row for row in rows if row["threads"] > 1):
            one = next((r for r in rows if r["threads"] == 1 and r["triangles"] == row["triangles"]
                        and style.variant(r) == style.variant(row)), None)
            if one is None:
                continue
            paired = row.get("speedup")
            trace = paired or quotient(row["mrays_per_second_wall"], one["mrays_per_second_wall"])
            build = quotient(build_speed(row), build_speed(one))
            found.setdefault(f"{family}, {row['triangles']:,} triangles", []).extend(
                [("trace", trace, paired is not None, row), ("build", build, False, row)])
    return found


def is_implausible(speedup, threads):
    """More than so many threads can give, in its whole interval; of one run there is no interval to judge by."""
    return speedup["max"] > speedup["min"] > threads


def figure_of(speedup, threads):
    text = f"{speedup['median']:.2f}"
    if speedup["min"] == speedup["max"]:
        return f"{text}, one run"
    return f"{text}, implausible" if is_implausible(speedup, threads) else text


def threads(results, scenes):
    most = max(len(measured) for measured in scenes.values())
    figure, axes = style.panels(len(scenes), 2, width=5.6, height=0.9 + 0.27 * most)
    for axis, (scene, measured) in zip(axes, scenes.items()):
        limits = sorted({row["threads"] for *_, row in measured})
        names = []
        for place, (what, speedup, paired, row) in enumerate(measured):
            look = style.look_of(row)
            axis.errorbar(speedup["median"], place, xerr=[[speedup["median"] - speedup["min"]],
                                                          [speedup["max"] - speedup["median"]]],
                          elinewidth=1, capsize=2, **look.dot(hollow=not paired))
            axis.annotate(figure_of(speedup, row["threads"]), (1.01, place), xycoords=("axes fraction", "data"),
                          va="center", fontsize=8, annotation_clip=False)
            names.append(f"{style.variant(row)}, {what}" + (f", {row['threads']} threads" if len(limits) > 1 else ""))
        for limit in limits:
            axis.axvline(limit, color=style.GREY, linestyle=":", linewidth=1)
        axis.set_yticks(range(len(names)), names, fontsize=8)
        axis.set_ylim(len(names) - 0.4, -0.6)
        axis.set_xlim(left=0.0)
        axis.xaxis.set_major_locator(MaxNLocator(2 if style.narrow else 5))
        axis.set_title(scene, fontsize=10)
        axis.set_xlabel("times as fast as one thread")
    style.finish(figure, "Growth with threads (dotted: the number of threads)", results)
    return figure


def says_threads(scenes):
    every = [(what, speedup, paired, row) for measured in scenes.values() for what, speedup, paired, row in measured]
    medians = [speedup["median"] / row["threads"] for _, speedup, _, row in every]
    beyond = [speedup["median"] > row["threads"] for _, speedup, _, row in every]
    implausible = sum(is_implausible(speedup, row["threads"]) for _, speedup, _, row in every)
    alone = sum(not paired for _, _, paired, _ in every)
    says = (f"Of what their threads can give, {len(every)} measurements reach {100 * min(medians):.0f}% to "
            f"{100 * max(medians):.0f}%.")
    if any(beyond):
        says += (f" Medians beyond the number of threads, which only noise can give: {sum(beyond)}; with the whole "
                 f"interval, which is implausible: {implausible}.")
    if alone:
        says += (f" From runs that were not paired, so that a change of the machine's speed between them counts as the "
                 f"threads': {alone}.")
    return says


def charts(results, _):
    single = style.by_scene(row for row in results["rows"] if row["suite"] == "scale" and row["threads"] == 1)
    if single:
        checked = min(row["rays_checked"] for rows in single.values() for row in rows)
        yield style.Chart(
            "growth", fastest(single),
            "Build, memory and speed against the number of triangles, for geometry of one character each; "
            f"{checked:,} rays or more of each were checked.",
            lambda: growth(results, single))
    if scenes := speedups(results):
        yield style.Chart(
            "threads", says_threads(scenes),
            "Filled marks: medians of ratios of neighbouring runs, with the range of all pairs; hollow marks: ratios "
            "of medians of runs that were not paired, with the widest limits that the runs' ranges allow; of one run "
            "there are none.",
            lambda: threads(results, scenes))
