"""What each step from the book's tree to bvh buys."""

from html import escape

import intervals
import style
from markup import table
from style import number

SPEED_COLORS = {"primary": style.BLUE, "diffuse": style.ORANGE, "shadow": style.GREEN}
WRONG_COLORS = {"edge": style.VERMILION, "vertex": style.PINK}
KINDS = list(SPEED_COLORS)


def by_step(results):
    """{scene: {step: {kind of rays: row}}}"""
    scenes = style.by_scene(row for row in results["rows"] if row["suite"] == "ladder")
    for scene, rows in scenes.items():
        scenes[scene] = {}
        for row in rows:
            scenes[scene].setdefault(row["step"], {})[row["rays"]] = row
    return scenes



def speeds(axis, steps):
    for kind, color in SPEED_COLORS.items():
        rows = [steps[step].get(kind) for step in steps]
        if None in rows:
            continue
        for field, name, look in (("mrays_per_second", kind, {}), ("mrays_per_second_batch", f"{kind}, batch",
                                                                  {"markerfacecolor": "none", "linestyle": ":"})):
            ys = [row[field]["median"] for row in rows]
            axis.plot(range(len(ys)), ys, marker="o", color=color, **look)
            style.label_end(axis, len(ys) - 1, ys[-1], name, color)
    axis.set_yscale("log")
    style.logarithmic(axis.yaxis)


def wrongs(axis, steps):
    """Wrong answers with their intervals: where there are none, the interval alone, from the least to be seen."""
    floor = 1.0
    for aside, (kind, color) in zip((-0.08, 0.08), WRONG_COLORS.items()):  # so that equals are seen beside each other
        rows = [steps[step].get(kind) for step in steps]
        if None in rows:
            continue
        limits = [[1e6 * limit for limit in intervals.proportion(row["wrong"], row["rays_checked"])] for row in rows]
        ys = [max(1e6 * row["wrong"] / row["rays_checked"], floor) for row in rows]
        below = [y - max(low, floor) for y, (low, _) in zip(ys, limits)]
        above = [high - y for y, (_, high) in zip(ys, limits)]
        axis.errorbar([place + aside for place in range(len(ys))], ys, yerr=[below, above], marker="X", capsize=2,
                      color=color)
        style.label_end(axis, len(ys) - 1, ys[-1], "edges" if kind == "edge" else "vertices", color)
    axis.set_yscale("log")
    axis.set_ylim(floor / 2.0, 1e6)
    style.logarithmic(axis.yaxis)
    axis.set_yticks([floor, 100, 10000, 1e6], ["none", "100", "10⁴", "10⁶"])


def steps_chart(results, scenes):
    figure, axes = style.panels(2 * len(scenes), 2, width=5.6, height=3.6)
    for i, (scene, steps) in enumerate(scenes.items()):
        speeds(axes[2 * i], steps)
        axes[2 * i].set_title(f"{scene}: million rays a second")
        wrongs(axes[2 * i + 1], steps)
        axes[2 * i + 1].set_title(f"{scene}: wrong answers in a million")
        for axis in axes[2 * i:2 * i + 2]:
            names = [step.split()[0] if style.narrow else step.replace(" ", "\n") for step in steps]
            axis.set_xticks(range(len(steps)), names, fontsize=7)
    style.finish(figure, "From the book's tree to bvh, step by step (one thread)", results)
    return figure


def gains(scenes):
    """The step that buys most speed on each scene, and the one from which on nothing is wrong."""
    parts = []
    for scene, steps in scenes.items():
        names = list(steps)
        kind = "diffuse" if "diffuse" in steps[names[0]] else next(iter(steps[names[0]]))
        speed = [steps[name][kind]["mrays_per_second"]["median"] for name in names if kind in steps[name]]
        gain = {name: after / before for name, before, after in zip(names[1:], speed, speed[1:])}
        wrong = [sum(row["wrong"] for row in steps[name].values()) for name in names]
        clean = next((names[i] for i in range(len(names)) if not any(wrong[i:])), None)
        text = f"on {scene} "
        if gain:
            most = max(gain, key=gain.get)
            text += f"step {most} buys most, {number(gain[most])} times the {kind} rays"
        parts.append(text + (f", and from step {clean} on no checked answer is wrong" if clean else
                             ", and some answers are wrong at every step" if wrong[-1] else ""))
    return f"Of single rays: {'; '.join(parts)}."


def charts(results, _):
    scenes = by_step(results)
    if scenes:
        yield style.Chart(
            "ladder", gains(scenes),
            "Filled marks: single rays; hollow marks: batches of 512. Bars of wrong answers are 95% intervals "
            "(Clopper and Pearson): where none was wrong, they say how many there may be. The table "
            "below names the steps.",
            lambda: steps_chart(results, scenes))


def tables(results):
    """HTML of the same with building time, memory and SAH cost."""
    for scene, steps in by_step(results).items():
        head = ["step", "build, s", "bytes a primitive", "SAH cost"]
        head += [f"{kind}, {how}" for kind in KINDS for how in ("single", "batch")] + ["wrong answers of checked"]
        body = []
        for step, kinds in steps.items():
            row = next(iter(kinds.values()))
            cells = [step, number(row["build_seconds"]), number(row["bytes"] / (row["triangles"] + row["spheres"])),
                     number(row["sah_cost"]) if "sah_cost" in row else "–"]
            for kind in KINDS:
                cells += [number(kinds[kind][field]["median"]) if kind in kinds else "–"
                          for field in ("mrays_per_second", "mrays_per_second_batch")]
            body.append([*cells, f"{sum(r['wrong'] for r in kinds.values()):,} of "
                                 f"{sum(r['rays_checked'] for r in kinds.values()):,}"])
        yield (f"<h2>{escape(scene)}, step by step</h2>\n<p>Speeds in million rays a second, one thread.</p>" +
               table(head, body))
