"""How little a scene can be rendered with."""

from matplotlib.ticker import PercentFormatter

import style
from markup import table
from rays_charts import front
from render_charts import dots, logarithmic_across
from style import number


def energy(results, scenes):
    figure, (axis,) = style.panels(1, 1, width=7.5, height=3.8)
    for i, (scene, rows) in enumerate(scenes.items()):
        rows = sorted(rows, key=lambda row: row["segment"])
        color = style.SERIES[i % len(style.SERIES)]
        ys = [max(100.0 * row["missing_energy"], 1e-3) for row in rows]
        axis.plot([row["segment"] for row in rows], ys, color=color,
                  marker=style.MARKERS[(i + i // len(style.SERIES)) % len(style.MARKERS)], markersize=4)
        style.label_end(axis, rows[-1]["segment"], ys[-1], scene, color)
    for percent in (1.0, 0.1):
        axis.axhline(percent, color=style.GREY, linestyle=":", linewidth=1)
    axis.set_yscale("log")
    style.logarithmic(axis.yaxis)
    axis.yaxis.set_major_formatter(PercentFormatter(decimals=2))
    axis.set_xlabel("path segments, camera ray included")
    axis.set_ylabel("light that is missing")
    style.finish(figure, "How deep paths must go", results)
    return figure


def depths(scenes):
    """The segments that find all but 1% of the light of each scene."""
    found = {scene: min((row["segment"] for row in rows if row["missing_energy"] < 0.01), default=None)
             for scene, rows in scenes.items()}
    return "All but 1% of the light is found " + "; ".join(
        f"on {scene} by paths of {most} segments" if most else f"on {scene} by none of the depths measured"
        for scene, most in found.items()) + "."


def strategy_name(row):
    return f"{row['integrator']}, {row['sampler']}" + (", sky sampled" if row.get("needs") == "all" else "")


def strategies(results, scenes):
    most = max(len(rows) for rows in scenes.values())
    figure, axes = style.panels(len(scenes), 3, width=4.8, height=0.8 + 0.32 * most)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        rows = sorted(rows, key=lambda row: row["relmse_seconds"])
        prices = [row["relmse_seconds"] / rows[0]["relmse_seconds"] for row in rows]
        looks = [style.Look(style.BLUE if row["integrator"] == "path" else style.ORANGE,
                            "o" if row["integrator"] == "path" else "X", "-") for row in rows]
        dots(axis, rows, [strategy_name(row) for row in rows], prices, looks,
             lambda row, _: f"{row['relmse']:.2g} in {row['seconds']:.2g} s")
        logarithmic_across(axis, prices)
        axis.set_title(f"{scene}, {rows[0]['spp']} spp")
        axis.set_xlabel("relMSE × seconds, best = 1")
    style.finish(figure, "What each sampling strategy costs (beside it: relMSE and seconds)", results)
    return figure


def prices(scenes):
    parts = []
    for scene, rows in scenes.items():
        first, last = (edge(rows, key=lambda row: row["relmse_seconds"]) for edge in (min, max))
        parts.append(f"on {scene} {strategy_name(first)} costs least, {strategy_name(last)} "
                     f"{number(last['relmse_seconds'] / first['relmse_seconds'])} times as much")
    return f"For the same error: {'; '.join(parts)}."


def added_errors(results, scenes):
    """Seconds of a picture against the error that its accelerator and triangle test add to it."""
    figure, axes = style.panels(len(scenes), 3, width=4.2, height=3.6)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        seen = [row["relmse"] for row in rows if row["relmse"] > 0.0] or [1e-9]
        right = min(seen) / 3.0
        left = right / 30.0
        for i, row in enumerate(rows):
            place = left * (right / left) ** ((i + 1) / (len(rows) + 1))
            axis.plot(row["relmse"] or place, row["seconds"], label=style.variant(row), **style.look_of(row).dot())
        edge = front([(row["relmse"], row["seconds"]) for row in rows])
        axis.step([*(x or left for x, _ in edge), 5.0 * max(seen)], [*(y for _, y in edge), edge[-1][1]], where="post",
                  color=style.GREY, linestyle=":", linewidth=1, zorder=0, label="Pareto line")
        axis.set_yscale("log")
        style.zone_of_none(axis, left, right, 5.0 * max(seen))
        style.logarithmic(axis.yaxis)
        axis.set_title(f"{scene}, {rows[0]['integrator']}, {rows[0]['sampler']}", fontsize=10)
        axis.set_xlabel("relMSE that the accelerator adds")
        axis.set_ylabel("seconds")
    style.finish(figure, "Whole pictures: what each accelerator and triangle test adds to the error", results,
                 style.legend_of(axes))
    return figure


def added(scenes):
    parts = []
    for scene, rows in scenes.items():
        worst, first = max(rows, key=lambda row: row["relmse"]), min(rows, key=lambda row: row["seconds"])
        text = f"on {scene} {style.variant(first)} is the fastest and adds {number(first['relmse'])}"
        if worst["relmse"] > first["relmse"]:
            text += f", {style.variant(worst)} adds most, {number(worst['relmse'])}"
        parts.append(text)
    return f"Of relMSE: {'; '.join(parts)}."


def charts(results, _):
    rows = [row for row in results["rows"] if row["suite"] == "needs"]
    of = {question: style.by_scene(row for row in rows if row["question"] == question)
          for question in ("energy by segment", "strategy", "accelerator")}
    if deep := of["energy by segment"]:
        yield style.Chart(
            "energy", depths(deep),
            "Light that paths of so many segments and fewer do not find, of what 256 segments find; the dotted lines "
            "are at 1% and 0.1%.",
            lambda: energy(results, deep))
    if strategy := of["strategy"]:
        yield style.Chart(
            "strategies", prices(strategy),
            "Light and BSDF sampling with weights (path) against BSDF sampling alone (book), and the two samplers. "
            "Twice the time halves the error, so their product is the price.",
            lambda: strategies(results, strategy))
    if accelerator := by_strategy(of["accelerator"]):
        yield style.Chart(
            "added-error", added(accelerator),
            "The picture of each accelerator and triangle test against that of the first, at equal random numbers. "
            "The shaded zone holds those that add nothing; no mark beats those on the dotted Pareto line in both.",
            lambda: added_errors(results, accelerator))


def by_strategy(scenes):
    """Each scene's rows of the integrator and sampler that most of its rows have: only these compare."""
    chosen = {}
    for scene, rows in scenes.items():
        ways = [(row["integrator"], row["sampler"], row["width"], row["spp"], row["max_depth"]) for row in rows]
        usual = max(ways, key=ways.count)
        chosen[scene] = [row for row, way in zip(rows, ways) if way == usual]
    return chosen


def tables(results):
    """HTML of the cheapest way found for each scene, or of what tied for it."""
    scenes = style.by_scene(row for row in results["rows"] if row["suite"] == "needs" and row["question"] == "cheapest")
    if not scenes:
        return
    body = []
    for rows in scenes.values():
        first = min(rows, key=lambda row: row["seconds"])
        for row in rows:
            tie = row["seconds_min"] <= first["seconds_max"]
            if not tie:
                continue
            error = f" ± {number(row['relmse_error'])}" if "relmse_error" in row else ""
            body.append([row["scene"] + (", tied" if row is not first else ""), number(row["allowed_relmse"]),
                         number(row["relmse"]) + error,
                         f"{number(row['seconds'])} ({number(row['seconds_min'])} to {number(row['seconds_max'])})",
                         str(row["width"]), row["scene_file"].replace("[render]\n", "").replace("\n", ", "),
                         row["command"]])
    yield ("<h2>The cheapest way found to keep the error</h2>" +
           table(["scene", "allowed relMSE", "relMSE", "seconds", "width", "scene file", "command"], body))
