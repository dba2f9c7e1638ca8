"""Single rays: speed against wrong hits, and build time against trace time."""

import math

from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

import style

KINDS = ["primary", "diffuse", "shadow", "edge", "vertex"]


def wrong_per_million(row):
    return 1e6 * row["wrong"] / row["rays_checked"]


def front(points):
    """Those of (wrong, speed) that no other one beats in both, by speed."""
    best, kept = math.inf, []
    for wrong, speed in sorted(points, key=lambda p: (-p[1], p[0])):
        if wrong < best:
            kept.append((wrong, speed))
            best = wrong
    return kept


def plain(value, _=None):
    return f"{value:g}" if 0.01 <= value < 10000 else f"$10^{{{round(math.log10(value))}}}$"


def pareto(results, scene, rows):
    kinds = [kind for kind in KINDS if any(row["rays"] == kind for row in rows)]
    figure, axes = style.panels(len(kinds), 5, width=3.1, height=4.0, sharey=True)
    # One wrong ray is the least that can be seen; none at all stands to the left of it, in a band that is wide enough
    # for equals to stand side by side.
    one = 1e6 / max(row["rays_checked"] for row in rows)
    left, right = one / 60.0, one / 2.0
    names = list(dict.fromkeys(style.variant(row) for row in rows))
    place = {name: left * (right / left) ** ((i + 1) / (len(names) + 1)) for i, name in enumerate(names)}
    largest = max([wrong_per_million(row) for row in rows] + [one * 10.0])
    for axis, kind in zip(axes, kinds):
        points = []
        for row in (row for row in rows if row["rays"] == kind):
            speed = row["mrays_per_second"]
            x = wrong_per_million(row)
            points.append((x, speed["median"]))
            x = x or place[style.variant(row)]
            axis.errorbar(x, speed["median"],
                          yerr=[[speed["median"] - speed["min"]], [speed["max"] - speed["median"]]],
                          color=style.color(row["accel"]), marker=style.MARKERS.get(row.get("intersector", ""), "D"),
                          markersize=7, linestyle="none", elinewidth=1, capsize=2, alpha=0.9, label=style.variant(row))
            batch = row.get("mrays_per_second_batch")
            if batch:
                batch_x = 1e6 * row["wrong_batch"] / row["rays_checked"]
                points.append((batch_x, batch["median"]))
                axis.plot(batch_x or place[style.variant(row)], batch["median"], color=style.color(row["accel"]),
                          marker=style.MARKERS.get(row.get("intersector", ""), "D"), markersize=7,
                          markerfacecolor="none", linestyle="none")
        edge = front(points)
        if edge:
            xs, ys = zip(*edge)
            axis.step([*(x or left for x in reversed(xs)), largest * 3.0], [*reversed(ys), ys[0]], where="post",
                      color="#999999", linewidth=1, linestyle=":", zorder=0)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlim(left, largest * 3.0)
        decades = [10.0**k for k in range(math.ceil(math.log10(one)), math.ceil(math.log10(largest * 3.0)))]
        step = max(1, -(-len(decades) // 4))
        axis.xaxis.set_major_locator(FixedLocator([(left * right) ** 0.5, *decades[::step]]))
        axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: "0" if x < right else plain(x)))
        axis.xaxis.set_minor_locator(NullLocator())
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.yaxis.set_major_formatter(FuncFormatter(plain))
        axis.axvspan(left, right, color="#F2F7F2", zorder=-1)
        axis.set_title(f"{kind} rays")
        axis.set_xlabel("wrong answers per million rays")
    speeds = [row[field] for row in rows for field in ("mrays_per_second", "mrays_per_second_batch") if field in row]
    low, high = min(s["min"] for s in speeds), max(s["max"] for s in speeds)
    for axis in axes:
        axis.set_ylim(low / 1.3, high * 1.3)
        ticks = [m * 10.0**k for k in range(-4, 4) for m in (1, 2, 5) if low / 1.3 <= m * 10.0**k <= high * 1.3]
        axis.yaxis.set_major_locator(FixedLocator(ticks))
        axis.yaxis.set_minor_locator(NullLocator())
    axes[0].set_ylabel("million rays per second, one thread")
    axes[0].plot([], [], color="#555555", marker="o", markerfacecolor="none", linestyle="none",
                 label="hollow: 512 rays side by side")
    checked = max(row["rays_checked"] for row in rows)
    style.finish(figure, f"{scene}: speed against accuracy of single rays (up and to the left is better; "
                 f"{checked:,} rays of each kind checked)", results, ["rays"], style.legend_of(axes))
    return figure


def break_even(results, scenes):
    """Build and trace together over those of the fastest, against the number of rays."""
    figure, axes = style.panels(len(scenes), 3, width=4.4, height=3.6)
    counts = [10.0 ** (k / 16.0) for k in range(3 * 16, 9 * 16 + 1)]
    for axis, (scene, rows) in zip(axes, scenes.items()):
        kind = "diffuse" if any(row["rays"] == "diffuse" for row in rows) else rows[0]["rays"]
        best = {}
        for row in (row for row in rows if row["rays"] == kind):
            # One line an accelerator, built in one way: its watertight test, or what it has.
            name = style.variant({**row, "intersector": ""})
            if row.get("intersector", "watertight") == "watertight" or name not in best:
                best[name] = row
        fastest = [min(seconds(row, n) for row in best.values()) for n in counts]
        for row in best.values():
            axis.plot(counts, [seconds(row, n) / least for n, least in zip(counts, fastest)],
                      color=style.color(row["accel"]), linestyle=style.LINES.get(row.get("quality"), "-"),
                      label=style.variant(row))
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_ylim(0.9, max(axis.get_ylim()[1], 2.0))
        axis.yaxis.set_major_formatter(FuncFormatter(plain))
        axis.yaxis.set_major_locator(FixedLocator([m * 10.0**k for k in range(4) for m in (1, 1.5, 2, 3, 5)]))
        axis.yaxis.set_minor_locator(NullLocator())
        for n, name in lead_changes(best):
            color = style.color(best[name]["accel"])
            axis.axvline(n, color=color, linestyle=":", linewidth=1)
            axis.annotate(f"{name} leads from {float(f'{n:.2g}'):,.0f} rays", (n, 0.97), xycoords=("data", "axes fraction"), rotation=90,
                          xytext=(3, 0), textcoords="offset points", fontsize=7, va="top", color=color)
        axis.set_title(f"{scene}, {kind} rays")
        axis.set_xlabel("rays traced")
    axes[0].set_ylabel("build + trace, over the fastest")
    style.finish(figure, "Build against trace: how many rays pay for a better tree (one thread)", results, ["rays"],
                 style.legend_of(axes))
    return figure


def seconds(row, rays):
    """To build, and to trace so many rays."""
    return row["build_seconds"] + rays / (1e6 * row["mrays_per_second"]["median"])


def lead_changes(best):
    """(rays, name) where another accelerator becomes the fastest, from 1,000 rays on."""
    changes, leader = [], None
    for k in range(3 * 200, 9 * 200):
        n = 10.0 ** (k / 200.0)
        first = min(best, key=lambda name: seconds(best[name], n))
        if leader is not None and first != leader:
            changes.append((n, first))
        leader = first
    return changes


def charts(results):
    """(file name, caption, figure) of each chart there are rows for."""
    scenes = {}
    for row in results["rows"]:
        if row["suite"] == "rays" and row.get("rays_checked"):
            scenes.setdefault(row["scene"], []).append(row)
    for scene, rows in scenes.items():
        yield (f"rays-{scene}", f"{scene}: what each accelerator and triangle test gives and what it costs. A wrong "
               "answer is a leak, a false miss, a false hit or a wrong primitive, against the exact answer. The dotted "
               "line is the Pareto front; bars span all repeats; hollow: 512 rays side by side, as the renderer sends "
               "them.", pareto(results, scene, rows))
    if scenes:
        yield ("break-even", "Seconds to build and to trace so many rays.", break_even(results, scenes))
