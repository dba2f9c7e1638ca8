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
    figure, axes = style.panels(len(kinds), 5, width=3.1, height=3.6, sharey=True)
    # One wrong ray is the least that can be seen; none at all stands to the left of it.
    one = 1e6 / max(row["rays_checked"] for row in rows)
    none = one / 4.0
    largest = max([wrong_per_million(row) for row in rows] + [one * 10.0])
    for axis, kind in zip(axes, kinds):
        points = []
        for row in (row for row in rows if row["rays"] == kind):
            speed = row["mrays_per_second"]
            x = wrong_per_million(row) or none
            points.append((x, speed["median"]))
            axis.errorbar(x, speed["median"],
                          yerr=[[speed["median"] - speed["min"]], [speed["max"] - speed["median"]]],
                          color=style.color(row["accel"]), marker=style.MARKERS.get(row.get("intersector", ""), "D"),
                          markersize=7, linestyle="none", elinewidth=1, capsize=2, alpha=0.9, label=style.variant(row))
        edge = front(points)
        if edge:
            xs, ys = zip(*edge)
            axis.step([*reversed(xs), largest * 3.0], [*reversed(ys), ys[0]], where="post", color="#999999",
                      linewidth=1, linestyle=":", zorder=0)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlim(none / 2.0, largest * 3.0)
        decades = [10.0**k for k in range(math.ceil(math.log10(one)), math.ceil(math.log10(largest * 3.0)))]
        step = max(1, -(-len(decades) // 4))
        axis.xaxis.set_major_locator(FixedLocator([none, *decades[::step]]))
        axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: "0" if x < one / 2.0 else plain(x)))
        axis.xaxis.set_minor_locator(NullLocator())
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.yaxis.set_major_formatter(FuncFormatter(plain))
        axis.axvspan(none / 2.0, one / 2.0, color="#F2F7F2", zorder=-1)
        axis.set_title(f"{kind} rays")
        axis.set_xlabel("wrong answers per million rays")
    speeds = [row["mrays_per_second"] for row in rows]
    low, high = min(s["min"] for s in speeds), max(s["max"] for s in speeds)
    for axis in axes:
        axis.set_ylim(low / 1.3, high * 1.3)
        ticks = [m * 10.0**k for k in range(-4, 4) for m in (1, 2, 5) if low / 1.3 <= m * 10.0**k <= high * 1.3]
        axis.yaxis.set_major_locator(FixedLocator(ticks))
        axis.yaxis.set_minor_locator(NullLocator())
    axes[0].set_ylabel("million rays per second, one thread")
    checked = max(row["rays_checked"] for row in rows)
    style.finish(figure, f"{scene}: speed against accuracy of single rays (up and to the left is better; "
                 f"{checked:,} rays of each kind checked)", results, ["rays"], style.legend_of(axes))
    return figure


def break_even(results, scenes):
    """Build and trace together, against the number of rays."""
    figure, axes = style.panels(len(scenes), 3, width=4.2, height=3.6)
    counts = [10.0 ** (k / 8.0) for k in range(3 * 8, 10 * 8 + 1)]
    for axis, (scene, rows) in zip(axes, scenes.items()):
        kind = "diffuse" if any(row["rays"] == "diffuse" for row in rows) else rows[0]["rays"]
        best = {}
        for row in (row for row in rows if row["rays"] == kind):
            # One line an accelerator: its watertight test, or what it has.
            if row.get("intersector", "watertight") == "watertight" or row["accel"] not in best:
                best[row["accel"]] = row
        for accel, row in best.items():
            speed = 1e6 * row["mrays_per_second"]["median"]
            axis.plot(counts, [row["build_seconds"] + n / speed for n in counts], color=style.color(accel),
                      label=style.variant(row))
        for n, y, accel in lead_changes(best):
            axis.plot(n, y, marker="o", color=style.color(accel), markersize=5)
            axis.annotate(f"{accel} leads\nfrom {n:.1g} rays", (n, y), textcoords="offset points", xytext=(8, -16),
                          fontsize=8, color=style.color(accel))
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_title(f"{scene}, {kind} rays")
        axis.set_xlabel("rays traced")
    axes[0].set_ylabel("seconds: build + trace, one thread")
    style.finish(figure, "Build against trace: how many rays pay for a better tree", results, ["rays"],
                 style.legend_of(axes))
    return figure


def lead_changes(best):
    """(rays, seconds, accelerator) where another accelerator becomes the fastest, from 1,000 rays on."""
    changes, leader = [], None
    for k in range(3 * 200, 10 * 200):
        n = 10.0 ** (k / 200.0)
        totals = {a: r["build_seconds"] + n / (1e6 * r["mrays_per_second"]["median"]) for a, r in best.items()}
        first = min(totals, key=totals.get)
        if leader is not None and first != leader:
            changes.append((n, totals[first], first))
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
               "line is the Pareto front; bars span all repeats.", pareto(results, scene, rows))
    if scenes:
        yield ("break-even", "Seconds to build and to trace so many rays.", break_even(results, scenes))
