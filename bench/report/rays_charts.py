"""Single rays and batches: speed against wrong answers, and build time against trace time."""

import math

import answers
import style
from markup import number_cell, spread_cell, table

KINDS = {"primary": "primary rays", "diffuse": "diffuse rays", "shadow": "shadow rays", "edge": "rays at edges",
         "vertex": "rays at vertices"}


def front(points):
    """Those of (cost, other cost) that no other one beats in both, by the first."""
    least, kept = math.inf, []
    for x, y in sorted(points):
        if y < least:
            kept.append((x, y))
            least = y
    return kept


def marks_of(row):
    """(wrong answers in a million, speed, whether it is in batches) of what the row measured."""
    yield 1e6 * row["wrong"] / row["rays_checked"], row["mrays_per_second"], False
    if "mrays_per_second_batch" in row:
        yield 1e6 * row["wrong_batch"] / row["rays_checked"], row["mrays_per_second_batch"], True


def accuracy(results, scene, rows):
    kinds = [kind for kind in KINDS if any(row["rays"] == kind for row in rows)]
    figure, axes = style.panels(len(kinds), 5, width=3.1, height=4.0, sharey=True)
    # One wrong ray is the least that can be seen; none at all stands to the left of it, in a zone that is wide enough
    # for equals to stand beside each other.
    one = 1e6 / max(row["rays_checked"] for row in rows)
    left, right = one / 500.0, one / 2.0
    names = list(dict.fromkeys(style.variant(row) for row in rows))
    place = {name: left * (right / left) ** ((i + 1) / (len(names) + 1)) for i, name in enumerate(names)}
    marks = [mark for row in rows for mark in marks_of(row)]
    largest = 3.0 * max([wrong for wrong, _, _ in marks] + [one * 10.0])
    for axis, kind in zip(axes, kinds):
        points = []
        for row in (row for row in rows if row["rays"] == kind):
            name = style.variant(row)
            for wrong, speed, in_batches in marks_of(row):
                points.append((wrong, -speed["median"]))
                axis.errorbar(wrong or place[name], speed["median"],
                              yerr=[[speed["median"] - speed["min"]], [speed["max"] - speed["median"]]], elinewidth=1,
                              capsize=2, alpha=0.9, label=None if in_batches else name,
                              **style.look_of(row).dot(hollow=in_batches))
        xs, ys = zip(*front(points))
        axis.step([*(x or left for x in xs), largest], [*(-y for y in ys), -ys[-1]], where="post", color=style.GREY,
                  linewidth=1, linestyle=":", zorder=0, label="Pareto line")
        axis.set_yscale("log")
        style.zone_of_none(axis, left, right, largest)
        axis.set_title(KINDS[kind])
        axis.set_xlabel("wrong answers in a million")
    for axis in axes:
        axis.set_ylim(min(s["min"] for _, s, _ in marks) / 1.3, max(s["max"] for _, s, _ in marks) * 1.3)
        style.logarithmic(axis.yaxis)
        axis.tick_params(labelleft=True)
    axes[0].set_ylabel("million rays a second, one thread")
    axes[0].plot([], [], **style.Look(style.GREY, "o", "-").dot(hollow=True), label="hollow: in batches")
    style.finish(figure, f"{scene}: speed against wrong answers (up and to the left is better)", results,
                 style.legend_of(axes))
    return figure


def one_a_tree(rows):
    """A row for each accelerator and way to build it: of its watertight test, or of what it has."""
    best = {}
    for row in rows:
        name = style.variant({**row, "intersector": ""})
        if row.get("intersector", "watertight") == "watertight" or name not in best:
            best[name] = row
    return best


def compared(rows):
    """The kind of rays by which trees are compared, and the rows of it."""
    kind = "diffuse" if any(row["rays"] == "diffuse" for row in rows) else rows[0]["rays"]
    return kind, one_a_tree([row for row in rows if row["rays"] == kind])


def break_even(results, scenes):
    """Build and trace together over those of the fastest, against the number of rays."""
    figure, axes = style.panels(len(scenes), 3, width=4.4, height=3.6)
    counts = [10.0 ** (k / 16.0) for k in range(3 * 16, 9 * 16 + 1)]
    for axis, (scene, rows) in zip(axes, scenes.items()):
        kind, best = compared(rows)
        fastest = [min(seconds(row, n) for row in best.values()) for n in counts]
        axis.set_xscale("log")
        axis.set_yscale("log")
        for name, row in best.items():
            look = style.look_of(row)
            ys = [seconds(row, n) / least for n, least in zip(counts, fastest)]
            axis.plot(counts, ys, color=look.color, linestyle=look.line, marker=look.marker, markevery=24, markersize=5)
            style.label_end(axis, counts[-1], ys[-1], name, look.color)
        axis.set_ylim(0.9, max(axis.get_ylim()[1], 2.0))
        style.logarithmic(axis.yaxis)
        style.logarithmic(axis.xaxis)
        for n, name in lead_changes(best):
            axis.axvline(n, color=style.look_of(best[name]).color, linestyle=":", linewidth=1)
        axis.set_title(f"{scene}, {kind} rays")
        axis.set_xlabel("rays traced")
        axis.set_ylabel("build + trace, over the fastest")
    style.finish(figure, "Build against trace: how many rays pay for a better tree (one thread)", results)
    return figure


def seconds(row, rays):
    """To build, and to trace so many rays one by one."""
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


def leaders(scenes):
    """Who is the fastest from how many rays on, as a sentence."""
    parts = []
    for scene, rows in scenes.items():
        _, best = compared(rows)
        first = min(best, key=lambda name: seconds(best[name], 1000.0))
        parts.append(f"on {scene} {first}" + "".join(f", from {style.number(n)} rays on {name}"
                                                     for n, name in lead_changes(best)))
    return "Building and tracing ray by ray takes least: " + "; ".join(parts) + "."


def on_the_line(scene, rows):
    """Who is on the Pareto line of each kind of rays, as a sentence."""
    kinds_of = {}
    for kind in dict.fromkeys(row["rays"] for row in rows):
        names = {(wrong, -speed["median"]): style.variant(row) + (" in batches" if in_batches else "")
                 for row in rows if row["rays"] == kind for wrong, speed, in_batches in marks_of(row)}
        for point in front(names):
            kinds_of.setdefault(names[point], []).append(KINDS[kind].removesuffix(" rays"))
    parts = [f"{name} ({', '.join(kinds)})" for name, kinds in kinds_of.items()]
    alone = dict.fromkeys(style.variant(row) for row in rows if "mrays_per_second_batch" not in row)
    text = f"{scene}, on the Pareto line: {'; '.join(parts)}."
    return text + (f" Not measured in batches: {', '.join(alone)}." if alone else "")


def charts(results, _):
    scenes = answers.measured(results)
    for scene, rows in scenes.items():
        first = next(iter(scenes))
        yield style.Chart(
            f"rays-{scene}", on_the_line(scene, rows), f"Read as that of {first}." if scene != first else
            "Each mark is an accelerator with a triangle test; bars span all repeats. Filled marks: ray by ray; hollow "
            "marks: in batches of 512, as the renderer sends them. The shaded zone at the left holds what answered no "
            f"checked ray wrongly (of {max(row['rays_checked'] for row in rows):,}); within it the place across means "
            "nothing. No mark beats those on the dotted Pareto line in both speed and accuracy.",
            lambda scene=scene, rows=rows: accuracy(results, scene, rows))
    if scenes:
        yield style.Chart("break-even", leaders(scenes), "A line at 1 is the fastest; a dotted upright line is where "
                          "the lead changes, in the colour of the new leader.", lambda: break_even(results, scenes))


def tables(results):
    """HTML of our Embree backends beside bare loops over the library's calls."""
    scenes = style.by_scene(row for row in results["rows"] if row["suite"] == "embree")
    if scenes:
        body = [[scene, style.variant(row), row["rays"], spread_cell(row["mrays_per_second"]),
                 spread_cell(row["mrays_per_second_batch"]), row["fastest_bare"],
                 number_cell(row["mrays_per_second_bare"]), number_cell(row["batch_of_fastest_bare"]),
                 number_cell(row["bvh_of_fastest_bare"])]
                for scene, rows in scenes.items() for row in rows]
        yield ("<h2>Embree behind our interface, beside bare loops</h2>\n<p>Speeds in million rays a second.</p>" +
               table(["scene", "accelerator", "rays", "single", "batch", "fastest bare loop", "its speed",
                      "batch over bare", "bvh's batch over bare"], body))
