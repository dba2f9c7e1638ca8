"""Whole processes of raylab-render, speed-up with threads, and the share of the accelerator."""

from matplotlib.ticker import MaxNLocator

import style
from markup import missing, number_cell, spread_cell, table
from style import number

# Parts of a process, in the order in which they happen.
PARTS = {"load": style.SKY, "build": style.ORANGE, "render": style.BLUE, "start and writing": style.GREY}
SHARES = {"closest hits": style.BLUE, "shadow rays": style.SKY, "outside the accelerator": style.ORANGE}


def rows_of(results, suite):
    return [row for row in results["rows"] if row["suite"] == suite]


def name_of(row):
    parts = [row["scene"], style.variant(row), row.get("overrides", "")]
    return ", ".join(part for part in parts if part) + (", all needs" if row.get("needs") == "all" else "")


def stacked(axis, rows, colors, values):
    """A bar for each row, made of the values of the named parts, the first row on top."""
    left = [0.0] * len(rows)
    for part, color in colors.items():
        widths = [values(row)[part] for row in rows]
        axis.barh(range(len(rows)), widths, left=left, height=0.7, color=color, label=part)
        left = [a + b for a, b in zip(left, widths)]
    axis.set_yticks(range(len(rows)), [name_of(row) for row in rows])
    axis.invert_yaxis()
    axis.grid(False, axis="y")
    axis.set_xlim(0.0, 1.35 * max(left))
    axis.xaxis.set_major_locator(MaxNLocator(4 if style.narrow else 6, steps=[1, 2, 5, 10]))
    for place, (row, end) in enumerate(zip(rows, left)):
        error = f" relMSE {number(row['estimated_relmse'])} (estimated)" if "estimated_relmse" in row else ""
        axis.annotate(error, (end, place), va="center", fontsize=8)


def process_parts(row):
    known = {"load": row["load_seconds"]["median"], "build": row["build_seconds"], "render": row["seconds"]}
    return {**known, "start and writing": max(0.0, row["process_seconds"]["median"] - sum(known.values()))}


def profile_parts(row):
    parts = {"closest hits": row["intersect_seconds"]["median"], "shadow rays": row["occluded_seconds"]["median"]}
    shares = {name: 100.0 * value / row["seconds"] for name, value in parts.items()}
    return {**shares, "outside the accelerator": max(0.0, 100.0 - sum(shares.values()))}


def bars(results, suite, title, label, colors, values):
    """Stacked bars, on an axis that is not logarithmic: lengths add up."""
    rows = rows_of(results, suite)
    figure, (axis,) = style.panels(1, 1, width=9.0, height=0.9 + 0.32 * len(rows))
    stacked(axis, rows, colors, values)
    axis.set_xlabel(label)
    style.finish(figure, title, results, style.legend_of([axis]))
    return figure


def says_process(rows):
    most = max(rows, key=lambda row: process_parts(row)["render"] / sum(process_parts(row).values()))
    least = min(rows, key=lambda row: process_parts(row)["render"] / sum(process_parts(row).values()))
    share = [100.0 * process_parts(row)["render"] / sum(process_parts(row).values()) for row in (least, most)]
    return f"Rendering takes {share[0]:.0f}% ({name_of(least)}) to {share[1]:.0f}% ({name_of(most)}) of the process."


def says_profile(rows):
    outside = [(profile_parts(row)["outside the accelerator"], name_of(row)) for row in rows]
    (least, of_least), (most, of_most) = min(outside), max(outside)
    return f"Outside the accelerator go {least:.0f}% ({of_least}) to {most:.0f}% ({of_most}) of the seconds."


def charts(results, _):
    if rows := rows_of(results, "process"):
        yield style.Chart(
            "process", says_process(rows),
            "Wall-clock seconds of whole processes of raylab-render: medians.",
            lambda: bars(results, "process", "Whole processes", "seconds", PARTS, process_parts))
    if rows := rows_of(results, "profile"):
        yield style.Chart(
            "profile", says_profile(rows),
            "Share of the seconds of rendering that is spent in the accelerator, on one thread.",
            lambda: bars(results, "profile", "Where a render's time goes", "% of the seconds of rendering", SHARES,
                         profile_parts))


def error(row):
    return number_cell(row["estimated_relmse"]) if "estimated_relmse" in row else missing("the picture has no variance")


def tables(results):
    """HTML of the speed-up with threads, and of what a scene does without."""
    if threads := rows_of(results, "threads"):
        yield "<h2>Speed-up with threads, and of processes that share nothing</h2>" + table(
            ["scene", "processes", "threads of each", "seconds", "speed-up", "estimated relMSE"],
            [[name_of(row), str(row["processes"]), str(row["threads"]), number_cell(row["seconds"]),
              spread_cell(row["speedup"]), error(row)] for row in threads])
    if compared := [row for row in rows_of(results, "process") if "seconds_ratio" in row]:
        yield "<h2>Everything switched on, against what a scene needs</h2>" + table(
            ["scene", "scene bytes", "light bytes", "seconds", "times as long", "pixels that differ",
             "estimated relMSE"],
            [[name_of(row), f"{row['scene_bytes']:,}", f"{row['light_bytes']:,}", number_cell(row["seconds"]),
              spread_cell(row["seconds_ratio"]), f"{row['different_pixels']} of {row['pixels']:,}", error(row)]
             for row in compared])
