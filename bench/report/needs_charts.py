"""How little a scene can be rendered with."""

from html import escape

from matplotlib.ticker import FuncFormatter, NullFormatter, PercentFormatter

import style

SCENE_COLORS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]


def by_scene(rows):
    scenes = {}
    for row in rows:
        scenes.setdefault(row["scene"], []).append(row)
    return scenes


def energy(results, scenes):
    figure, (axis,) = style.panels(1, 1, width=7.5, height=3.8)
    for i, (scene, rows) in enumerate(scenes.items()):
        rows.sort(key=lambda row: row["segment"])
        axis.plot([row["segment"] for row in rows], [max(100.0 * row["missing_energy"], 1e-3) for row in rows],
                  marker=".", color=SCENE_COLORS[i % len(SCENE_COLORS)], label=scene)
    for percent in (1.0, 0.1):
        axis.axhline(percent, color="#999999", linestyle=":", linewidth=1)
    axis.set_yscale("log")
    axis.yaxis.set_major_formatter(PercentFormatter(decimals=2))
    axis.yaxis.set_minor_formatter(NullFormatter())
    axis.set_xlabel("path segments, camera ray included")
    axis.set_ylabel("light that is missing")
    style.finish(figure, "How deep paths must go", results, ["needs"], style.legend_of([axis]))
    return figure


def strategy_name(row):
    return f"{row['integrator']}, {row['sampler']}" + (", sky sampled" if row.get("needs") == "all" else "")


def strategies(results, scenes):
    most = max(len(rows) for rows in scenes.values())
    figure, axes = style.panels(len(scenes), 3, width=4.8, height=0.8 + 0.32 * most)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        rows = sorted(rows, key=lambda row: -row["relmse_seconds"])
        best = rows[-1]["relmse_seconds"]
        bars = axis.barh([strategy_name(row) for row in rows], [row["relmse_seconds"] / best for row in rows], height=0.7,
                         color=["#0072B2" if row["integrator"] == "path" else "#E69F00" for row in rows])
        axis.bar_label(bars, [f" {row['relmse']:.2g} in {row['seconds']:.2g} s" for row in rows], fontsize=8)
        axis.set_xscale("log")
        axis.set_xlim(0.7, 6.0 * max(2.0, rows[0]["relmse_seconds"] / best))
        axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.grid(False, axis="y")
        axis.set_title(f"{scene}, {rows[0]['spp']} samples")
        axis.set_xlabel("relMSE × seconds, over that of the best")
    style.finish(figure, "What each sampling strategy costs (label: relMSE and seconds)", results, ["needs"])
    return figure


def charts(results):
    rows = [row for row in results["rows"] if row["suite"] == "needs"]
    deep = by_scene(row for row in rows if row["question"] == "energy by segment")
    if deep:
        yield ("energy", "Light that paths of so many segments and fewer do not find, of what 256 segments find.",
               energy(results, deep))
    strategy = by_scene(row for row in rows if row["question"] == "strategy")
    if strategy:
        yield ("strategies", "Light and BSDF sampling with weights (path) against BSDF sampling alone (book), and the two "
               "samplers. Twice the time halves the error, so their product is the price.", strategies(results, strategy))


def tables(results):
    """HTML of the cheapest way found for each scene."""
    cheapest = [row for row in results["rows"] if row["suite"] == "needs" and row["question"] == "cheapest"]
    if not cheapest:
        return []
    parts = ["<h2>The cheapest way found to keep the error</h2><table><tr><th>scene</th><th>allowed relMSE</th>"
             "<th>relMSE</th><th>seconds</th><th>width</th><th>scene file</th><th>command</th></tr>"]
    for row in cheapest:
        cells = [row["scene"], f"{row['allowed_relmse']:g}",
                 f"{row['relmse']:.3g} ± {row.get('relmse_error', float('nan')):.1g}", f"{row['seconds']:.3f}",
                 str(row["width"])]
        parts.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) +
                     f"<td><pre>{escape(row['scene_file'])}</pre></td><td><code>{escape(row['command'])}</code></td></tr>")
    return [*parts, "</table>"]
