"""What each step from the book's tree to bvh buys."""

from html import escape

import style

KINDS = ["primary", "diffuse", "shadow"]
SPEED_COLORS = {"primary": "#0072B2", "diffuse": "#E69F00", "shadow": "#009E73"}
WRONG_COLORS = {"edge": "#D55E00", "vertex": "#CC79A7"}


def by_scene(results):
    scenes = {}
    for row in results["rows"]:
        if row["suite"] == "ladder":
            scenes.setdefault(row["scene"], {}).setdefault(row["step"], {})[row["rays"]] = row
    return scenes


def steps_chart(results, scenes):
    figure, axes = style.panels(2 * len(scenes), 2, width=5.0, height=3.6)
    for i, (scene, steps) in enumerate(scenes.items()):
        speed, wrong = axes[2 * i], axes[2 * i + 1]
        places = range(len(steps))
        for kind in KINDS:
            rows = [steps[step].get(kind) for step in steps]
            if None in rows:
                continue
            speed.plot(places, [row["mrays_per_second"]["median"] for row in rows], marker="o", color=SPEED_COLORS[kind],
                       label=kind)
            speed.plot(places, [row["mrays_per_second_batch"]["median"] for row in rows], marker="o", markerfacecolor="none",
                       linestyle=":", color=SPEED_COLORS[kind], label=f"{kind}, 512 side by side")
        speed.set_yscale("log")
        speed.set_title(f"{scene}: million rays per second")
        for kind, color in WRONG_COLORS.items():
            rows = [steps[step].get(kind) for step in steps]
            if None not in rows:
                wrong.plot(places, [1e6 * row["wrong"] / row["rays_checked"] for row in rows], marker="X", color=color,
                           label=f"rays at {'edges' if kind == 'edge' else 'vertices'}")
        wrong.set_yscale("symlog", linthresh=10)
        wrong.set_ylim(bottom=-1)
        wrong.set_title(f"{scene}: wrong answers per million")
        for axis in (speed, wrong):
            axis.set_xticks(list(places), [step.replace(" ", "\n") for step in steps], fontsize=8)
    style.finish(figure, "From the book's tree to bvh, step by step (one thread)", results, ["ladder"],
                 style.legend_of(axes), legend_columns=4)
    return figure


def charts(results):
    scenes = by_scene(results)
    if scenes:
        yield ("ladder", "What each step buys, single rays and batches of 512, and what is wrong at edges and vertices.",
               steps_chart(results, scenes))


def tables(results):
    """HTML of the same with building time, memory and SAH cost."""
    parts = []
    for scene, steps in by_scene(results).items():
        parts.append(f"<h2>{escape(scene)}, step by step</h2><table><tr><th>step</th><th>build, s</th>"
                     "<th>bytes per primitive</th><th>SAH cost</th>" +
                     "".join(f"<th>{kind}, Mrays/s (batches)</th>" for kind in KINDS) + "<th>wrong of checked</th></tr>")
        for step, kinds in steps.items():
            row = next(iter(kinds.values()))
            cells = [step, f"{row['build_seconds']:.3g}", f"{row['bytes'] / (row['triangles'] + row['spheres']):.1f}",
                     f"{row['sah_cost']:.3g}" if "sah_cost" in row else ""]
            cells += [f"{kinds[kind]['mrays_per_second']['median']:.3g} ({kinds[kind]['mrays_per_second_batch']['median']:.3g})"
                      if kind in kinds else "" for kind in KINDS]
            cells.append(f"{sum(r['wrong'] for r in kinds.values())} of {sum(r['rays_checked'] for r in kinds.values())}")
            parts.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>")
        parts.append("</table>")
    return parts
