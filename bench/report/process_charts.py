"""Whole processes of raylab-render, speed-up with threads, and the share of the accelerator."""

from html import escape

from matplotlib.ticker import MaxNLocator

import style

# Parts of a process, in the order in which they happen.
PARTS = {"load": "#56B4E9", "build": "#E69F00", "render": "#0072B2", "start and writing": "#999999"}
SHARES = {"closest hits": "#0072B2", "shadow rays": "#56B4E9", "outside the accelerator": "#E69F00"}


def rows_of(results, suite):
    return [row for row in results["rows"] if row["suite"] == suite]


def name_of(row):
    parts = [row["scene"], style.variant(row), row.get("overrides", "")]
    return ", ".join(part for part in parts if part) + (", all needs" if row.get("needs") == "all" else "")


def stacked(axis, rows, colors, values):
    """A bar for each row, made of the values of the named parts, the first row on top."""
    names = [name_of(row) for row in rows]
    left = [0.0] * len(rows)
    for part, color in colors.items():
        widths = [values(row)[part] for row in rows]
        axis.barh(range(len(rows)), widths, left=left, height=0.7, color=color, label=part)
        left = [a + b for a, b in zip(left, widths)]
    axis.set_yticks(range(len(rows)), names)
    axis.invert_yaxis()
    axis.grid(False, axis="y")
    axis.set_xlim(0.0, 1.35 * max(left))
    axis.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    for place, (row, end) in enumerate(zip(rows, left)):
        axis.annotate(f" relMSE {row.get('estimated_relmse', float('nan')):.2g} (estimated)", (end, place), va="center", fontsize=8)


def process_parts(row):
    known = {"load": row["load_seconds"]["median"], "build": row["build_seconds"], "render": row["seconds"]}
    return {**known, "start and writing": max(0.0, row["process_seconds"]["median"] - sum(known.values()))}


def profile_parts(row):
    parts = {"closest hits": row["intersect_seconds"]["median"], "shadow rays": row["occluded_seconds"]["median"]}
    shares = {name: 100.0 * value / row["seconds"] for name, value in parts.items()}
    return {**shares, "outside the accelerator": max(0.0, 100.0 - sum(shares.values()))}


def bars(results, suite, title, label, colors, values):
    rows = rows_of(results, suite)
    figure, (axis,) = style.panels(1, 1, width=9.0, height=0.9 + 0.32 * len(rows))
    stacked(axis, rows, colors, values)
    axis.set_xlabel(label)
    style.finish(figure, title, results, [suite], style.legend_of([axis]))
    return figure


def charts(results):
    if rows_of(results, "process"):
        yield ("process", "Wall-clock seconds of whole processes of raylab-render: medians.",
               bars(results, "process", "Whole processes", "seconds", PARTS, process_parts))
    if rows_of(results, "profile"):
        yield ("profile", "Share of the seconds of rendering that is spent in the accelerator, on one thread.",
               bars(results, "profile", "Where a render's time goes", "% of the seconds of rendering", SHARES,
                    profile_parts))


def table(title, head, rows):
    return [f"<h2>{escape(title)}</h2><table><tr>" + "".join(f"<th>{escape(cell)}</th>" for cell in head) + "</tr>",
            *("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows), "</table>"]


def spread(value):
    return f"{value['median']:.3f} ({value['min']:.2f} to {value['max']:.2f})"


def error(row):
    return f"{row['estimated_relmse']:.4f}" if "estimated_relmse" in row else ""


def tables(results):
    """HTML of the speed-up with threads, and of what a scene does without."""
    parts = []
    if threads := rows_of(results, "threads"):
        parts += table("Speed-up with threads, and of processes that share nothing",
                       ["scene", "processes", "threads of each", "seconds", "speed-up", "estimated relMSE"],
                       [[name_of(row), str(row["processes"]), str(row["threads"]), f"{row['seconds']:.3f}",
                         spread(row["speedup"]), error(row)] for row in threads])
    if compared := [row for row in rows_of(results, "process") if "seconds_ratio" in row]:
        parts += table("Everything switched on, against what a scene needs",
                       ["scene", "scene bytes", "light bytes", "seconds", "times as long", "pixels that differ",
                        "estimated relMSE"],
                       [[name_of(row), str(row["scene_bytes"]), str(row["light_bytes"]), f"{row['seconds']:.3f}",
                         spread(row["seconds_ratio"]), f"{row['different_pixels']} of {row['pixels']}", error(row)]
                        for row in compared])
    return parts
