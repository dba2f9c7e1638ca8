"""Growth with the number of triangles, and with threads."""

import math

from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

import style

METRICS = [
    ("build, seconds, one thread", lambda row: row["build_seconds"]),
    ("bytes per triangle", lambda row: row["bytes"] / row["triangles"]),
    ("million rays per second, singly", lambda row: row["mrays_per_second"]["median"]),
    ("million rays per second, in batches", lambda row: row.get("mrays_per_second_batch", {}).get("median", math.nan)),
]
SPEEDS = (2, 3)


def plain(x, _=None):
    return f"{x:g}"


def growth(results, rows):
    families = list(dict.fromkeys(row["scene"] for row in rows))
    figure, axes = style.panels(len(families) * len(METRICS), len(METRICS), width=3.6, height=2.7)
    for i, family in enumerate(families):
        for j, (label, metric) in enumerate(METRICS):
            axis = axes[i * len(METRICS) + j]
            mine = [row for row in rows if row["scene"] == family]
            for name in dict.fromkeys(style.variant(row) for row in mine):
                points = sorted((row for row in mine if style.variant(row) == name), key=lambda row: row["triangles"])
                xs = [row["triangles"] for row in points]
                axis.plot(xs, [metric(row) for row in points], marker=style.MARKERS.get(points[0].get("intersector", ""), "D"),
                          markersize=4, color=style.color(points[0]["accel"]), label=name)
                # A ring around what was wrong: speed alone would praise it.
                wrong = [(row["triangles"], metric(row)) for row in points if row["wrong"] > 0]
                if wrong and j in SPEEDS:
                    axis.plot(*zip(*wrong), marker="o", markersize=11, markerfacecolor="none", color="#CC0000",
                              linestyle="none", label="some answers were wrong")
            axis.set_xscale("log")
            axis.xaxis.set_minor_formatter(NullFormatter())
            if j != 1:
                axis.set_yscale("log")
                axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
                axis.yaxis.set_minor_locator(NullLocator())
                axis.yaxis.set_major_formatter(FuncFormatter(plain))
            else:
                axis.set_ylim(bottom=0.0)
            axis.set_title(f"{family}: {label}", fontsize=9)
            axis.set_xlabel("triangles", fontsize=9)
    checked = max(row["rays_checked"] for row in rows)
    style.finish(figure, f"Growth with the number of triangles ({checked:,} rays of each checked)", results, ["scale"],
                 style.legend_of(axes), legend_columns=5)
    return figure


def threads(results, rows):
    # Only sizes that were run with more than one number of threads.
    several = {(row["scene"], row["triangles"]) for row in rows if row["threads"] > 1}
    families = list(dict.fromkeys(scene for scene, _ in sorted(several)))
    figure, axes = style.panels(len(families), 3, width=4.0, height=3.0)
    for axis, family in zip(axes, families):
        mine = [row for row in rows if (row["scene"], row["triangles"]) in several and row["scene"] == family]
        for name in dict.fromkeys(style.variant(row) for row in mine):
            points = sorted((row for row in mine if style.variant(row) == name), key=lambda row: row["threads"])
            one = points[0]
            xs = [row["threads"] for row in points]
            axis.plot(xs, [row["mrays_per_second_wall"]["median"] / one["mrays_per_second_wall"]["median"] for row in points],
                      marker="o", color=style.color(one["accel"]), label=f"{name}, trace")
            axis.plot(xs, [one["build_seconds"] / row["build_seconds"] for row in points], marker="s", linestyle="--",
                      color=style.color(one["accel"]), label=f"{name}, build")
        most = max(row["threads"] for row in mine)
        axis.plot([1, most], [1, most], color="#999999", linestyle=":", label="ideal")
        axis.xaxis.set_major_locator(MaxNLocator(integer=True))
        axis.set_title(f"{family}, {mine[0]['triangles']:,} triangles")
        axis.set_xlabel("threads")
    axes[0].set_ylabel("times as fast as one thread")
    style.finish(figure, "Growth with threads", results, ["scale"], style.legend_of(axes), legend_columns=5)
    return figure


def charts(results):
    rows = [row for row in results["rows"] if row["suite"] == "scale"]
    single = [row for row in rows if row["threads"] == 1]
    if single:
        yield ("growth", "Build, memory and speed against the number of triangles, for geometry of one character each. A "
               "red ring: some of the checked rays were answered wrongly.", growth(results, single))
    if any(row["threads"] > 1 for row in rows):
        yield ("threads", "Speed-up with threads of tracing and of building, at the largest size.", threads(results, rows))
