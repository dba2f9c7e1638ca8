"""How every chart looks, and how it is saved so that equal results give equal files."""

import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the backend is chosen)

# Okabe and Ito's colours: told apart by colour-blind eyes too.
COLORS = {"list": "#777777", "rtiow": "#E69F00", "bvh": "#0072B2", "embree": "#009E73", "embree-robust": "#CC79A7",
          "exact": "#000000", "mitsuba": "#D55E00"}
SPARE_COLORS = ["#56B4E9", "#F0E442", "#8C564B"]
LINES = {"fast": "-.", "best": "--"}
MARKERS = {"book": "X", "fast": "^", "watertight": "o", "": "s"}

plt.rcParams.update({
    "svg.hashsalt": "raylab", "font.size": 10, "axes.titlesize": 11, "axes.grid": True, "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6, "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
    "legend.frameon": False, "figure.facecolor": "white",
})


def color(accel):
    if accel not in COLORS:
        COLORS[accel] = SPARE_COLORS[len(COLORS) % len(SPARE_COLORS)]
    return COLORS[accel]


def variant(row):
    """The accelerator with its triangle test and how it is built, or the other renderer, as one name."""
    quality = row.get("quality", "balanced")
    parts = (row.get("accel", ""), row.get("intersector", ""), "" if quality == "balanced" else f"{quality} quality",
             "compact" if row.get("compact") else "")
    return " ".join(part for part in parts if part)


def panels(count, columns, width=3.4, height=3.2, **kwargs):
    """A figure of `count` axes in rows of `columns`; those left over are hidden."""
    columns = min(columns, count)
    rows = -(-count // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(max(width * columns, 6.5), height * rows), squeeze=False, **kwargs)
    flat = list(axes.flat)
    for spare in flat[count:]:
        spare.set_visible(False)
    return figure, flat[:count]


def finish(figure, title, results, suites, legend=None, legend_columns=6):
    """Title above, legend and footer below, nothing on top of anything."""
    width, height = figure.get_size_inches()
    footer = footer_lines(results, suites, int(width * 17))
    legend_columns = min(legend_columns, max(1, int(width / 2.1)))  # inches that the longest name takes
    legend_rows = -(-len(legend[0]) // legend_columns) if legend else 0
    below = 0.125 * len(footer) + 0.12
    legend_height = 0.22 * legend_rows + (0.12 if legend_rows else 0.0)
    top = 0.15 + 0.22 * len(textwrap.wrap(title, int(width * 10)))
    total = height + below + legend_height + top
    figure.set_size_inches(width, total)
    figure.suptitle("\n".join(textwrap.wrap(title, int(width * 10))), x=0.5, y=1.0 - 0.08 / total, va="top", fontsize=13).set_in_layout(False)
    figure.text(0.01, 0.06 / total, "\n".join(footer), fontsize=7, color="#555555", va="bottom")
    if legend:
        figure.legend(*legend, loc="lower center", bbox_to_anchor=(0.5, below / total), ncol=legend_columns,
                      fontsize=9, borderaxespad=0.0)
    figure.tight_layout(rect=(0.0, (below + legend_height) / total, 1.0, 1.0 - top / total))


def footer_lines(results, suites, width):
    machine = results["machine"]
    lines = [f"{machine.get('cpu', '?')}, {machine.get('threads', '?')} threads, {machine.get('memory_gib', '?')} GiB; "
             f"{machine.get('system', '?')}; {machine.get('compiler', '?')}; Raylab {machine.get('raylab', '?')}"]
    for run in results.get("runs", []):
        if run["suite"] in suites:
            text = f"{run['command']}, {run['date'][:10]}" + ("" if run.get("complete", True) else " (interrupted)")
            lines += textwrap.wrap(text, width, subsequent_indent="    ", break_on_hyphens=False)
    return [line.replace("$", r"\$") for line in lines]


def save(figure, folder, name, png):
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None, "Creator": None})
    if png:
        figure.savefig(folder / f"{name}.png", dpi=110, metadata={"Software": None})
    plt.close(figure)


def legend_of(axes):
    """Handles and labels of all axes, each label once, in order of appearance."""
    found = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            found.setdefault(label, handle)
    return list(found.values()), list(found)
