"""How every chart looks: one look a method, lines labelled at their ends, and files that repeat to the byte."""

import io
import math
import textwrap
from itertools import count
from typing import Callable, NamedTuple

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the backend is chosen)
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator  # noqa: E402

INK, MUTED, GRID, ZONE, PAPER = "#222222", "#666666", "#DDDDDD", "#EAF3EA", "#FFFFFF"
# Okabe and Ito's colours, and of Tol's muted ones those that differ from them: told apart by colour-blind eyes too.
BLUE, ORANGE, GREEN, PINK, VERMILION, SKY = "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9"
GREY, WINE, OLIVE, INDIGO = "#777777", "#882255", "#999933", "#332288"
# What a page in dark colours shows in their place.
DARK = {INK: "#E8E8E8", MUTED: "#A9AFB5", GRID: "#3A4046", ZONE: "#20302A", PAPER: "#15181B", BLUE: "#4FA8E0",
        ORANGE: "#F0B840", GREEN: "#2FC79A", PINK: "#E7A6CB", VERMILION: "#F58549", SKY: "#9AD4F5", GREY: "#9A9A9A",
        WINE: "#D9698F", OLIVE: "#C6C65A", INDIGO: "#9A8CF0"}

COLORS = {"list": GREY, "rtiow": ORANGE, "bvh": BLUE, "embree": GREEN, "embree-robust": PINK, "exact": INK,
          "mitsuba": VERMILION}
KNOWN = len(COLORS)
SPARE_COLORS = [SKY, WINE, OLIVE, INDIGO, VERMILION, GREEN, BLUE, PINK]
SERIES = [BLUE, ORANGE, GREEN, PINK, VERMILION, SKY, WINE, OLIVE, INDIGO, GREY]
TEST_MARKERS = {"book": "X", "fast": "^", "watertight": "o"}
QUALITY_LINES = {"fast": "-.", "best": "--"}
MARKERS = ["s", "D", "v", "P", "<", ">", "p", "h", "*", "o", "^", "X"]

plt.rcParams.update({
    "svg.hashsalt": "raylab", "svg.fonttype": "none", "font.sans-serif": ["DejaVu Sans", "Verdana", "sans-serif"],
    "font.size": 10, "axes.titlesize": 11, "axes.grid": True, "grid.color": GRID, "grid.linewidth": 0.6,
    "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True, "legend.frameon": False,
    "figure.facecolor": PAPER, "axes.facecolor": PAPER, "text.color": INK, "axes.edgecolor": INK,
    "axes.labelcolor": INK, "axes.titlecolor": INK, "xtick.color": INK, "ytick.color": INK,
})


class Chart(NamedTuple):
    """What the page shows of a chart: what its rows say, how its marks are read, and how it is drawn."""

    name: str
    says: str
    reading: str
    draw: Callable


class Look(NamedTuple):
    color: str
    marker: str
    line: str

    def dot(self, hollow=False):
        """Keywords of a mark without a line."""
        return {"color": self.color, "marker": self.marker, "markersize": 7, "linestyle": "none",
                "markerfacecolor": "none" if hollow else self.color}


LOOKS = {}  # those given so far, by the method's name


def color(accel):
    if accel not in COLORS:
        COLORS[accel] = SPARE_COLORS[(len(COLORS) - KNOWN) % len(SPARE_COLORS)]
    return COLORS[accel]


def look(name, accel, marker="s", line="-"):
    """How a method is drawn everywhere: in its accelerator's colour, by another marker than any of that colour."""
    if name not in LOOKS:
        taken = {(given.color, given.marker) for given in LOOKS.values()}
        numbers = (f"${i}$" for i in count(1))  # after the last marker, so that no number of methods is too large
        free = next(m for m in (marker, *MARKERS, *(next(numbers) for _ in LOOKS)) if (color(accel), m) not in taken)
        LOOKS[name] = Look(color(accel), free, line)
    return LOOKS[name]


def look_of(row):
    """How a row's accelerator, with its triangle test and how it is built, is drawn."""
    return look(variant(row), row["accel"], TEST_MARKERS.get(row.get("intersector"), "s"),
                QUALITY_LINES.get(row.get("quality"), "-"))


def variant(row):
    """The accelerator with its triangle test and how it is built, or the other renderer, as one name."""
    quality = row.get("quality", "balanced")
    parts = (row.get("accel", ""), row.get("intersector", ""), "" if quality == "balanced" else f"{quality} quality",
             "compact" if row.get("compact") else "")
    return " ".join(part for part in parts if part)


def by_scene(rows):
    """The rows of each scene, the dragon's first: it is the scene with the most to decide."""
    scenes = {}
    for row in rows:
        scenes.setdefault(row["scene"], []).append(row)
    return dict(sorted(scenes.items(), key=lambda item: item[0] != "dragon"))


RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value, _=None):
    """A number as a person writes it, in three digits, with a power of ten where it is very large or small."""
    if value == 0 or 1e-3 <= abs(value) < 1e6:
        return f"{float(f'{value:.3g}'):,.10g}"
    digits, power = f"{value:.2e}".split("e")
    raised = str(int(power)).translate(RAISED)
    digits = digits.rstrip("0").rstrip(".")
    return f"10{raised}" if digits == "1" else f"{digits}·10{raised}"


def tick(value, _=None):
    """A number beside an axis: short, so that neighbours do not meet."""
    power = round(math.log10(value)) if value > 0 else 0
    if power < 4 or abs(value / 10.0**power - 1.0) > 1e-9:
        return number(value)
    return "10" + str(power).translate(RAISED)


def log_ticks(low, high, most):
    """At most so many round numbers between the limits: as many as there is room for, at decades alone if need be."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for steps in ((1.0, 1.5, *range(2, 10)), (1.0, 1.5, 2.0, 3.0, 5.0, 7.0), (1.0, 2.0, 5.0), (1.0, 3.0), (1.0,)):
        ticks = [step * 10.0**power for power in powers for step in steps if low <= step * 10.0**power <= high]
        if len(ticks) <= most:
            break
    return ticks[::max(1, -(-len(ticks) // most))]


def logarithmic(side, most=6):
    """A logarithmic axis with plain numbers, and room between them."""
    side.set_major_locator(FixedLocator(log_ticks(*side.get_view_interval(), most)))
    side.set_major_formatter(FuncFormatter(tick))
    side.set_minor_formatter(NullFormatter())
    side.set_minor_locator(NullLocator())


def zone_of_none(axis, left, right, largest):
    """A logarithmic axis across to `largest` with a shaded zone, from left to right, for what is zero."""
    axis.set_xscale("log")
    axis.set_xlim(left, largest)
    axis.axvspan(left, right, color=ZONE, zorder=-1)
    decades = [10.0**k for k in range(math.ceil(math.log10(right)), math.ceil(math.log10(largest)))]
    axis.xaxis.set_major_locator(FixedLocator([(left * right) ** 0.5, *decades[::max(1, -(-len(decades) // 3))]]))
    axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: "none" if x < right else tick(x)))
    axis.xaxis.set_minor_locator(NullLocator())


narrow = False  # whether figures are drawn for a telephone: one panel under the other


def panels(number_of, columns, width=3.4, height=3.2, **kwargs):
    """A figure of so many axes in rows of `columns`; those left over are hidden."""
    columns = 1 if narrow else min(columns, number_of)
    least, width = (4.0, 4.0) if narrow else (6.5, width)
    rows = -(-number_of // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(max(width * columns, least), height * rows), squeeze=False,
                                **kwargs)
    flat = list(axes.flat)
    for spare in flat[number_of:]:
        spare.set_visible(False)
    return figure, flat[:number_of]


def label_end(axis, x, y, text, color):
    """Writes a line's name beside its last point, right of the axes. finish() moves names apart."""
    label = axis.annotate(text, (x, y), (1.02, y), textcoords=("axes fraction", "data"), color=color, fontsize=8,
                          va="center", annotation_clip=False,
                          arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.5, "shrinkA": 0, "shrinkB": 2,
                                  "relpos": (0.0, 0.5)})
    axis.end_labels = [*getattr(axis, "end_labels", []), label]


def spread(places, gap):
    """The places moved as little as it takes to be `gap` apart, in their order."""
    groups = []  # of neighbours that touch: [sum of wishes for the group's first place, number]
    for i, place in enumerate(sorted(places)):
        groups.append([place, 1])
        while len(groups) > 1 and groups[-2][0] / groups[-2][1] + groups[-2][1] * gap > groups[-1][0] / groups[-1][1]:
            wish, size = groups.pop()
            groups[-1][0] += wish - size * groups[-1][1] * gap
            groups[-1][1] += size
    apart = [wish / size + k * gap for wish, size in groups for k in range(size)]
    ranks = sorted(range(len(places)), key=places.__getitem__)
    return [apart[ranks.index(i)] for i in range(len(places))]


def part_labels(axis):
    labels = getattr(axis, "end_labels", [])
    wishes = [axis.transData.transform(label.xy)[1] for label in labels]
    points = axis.figure.dpi / 72.0
    for label, y in zip(labels, spread(wishes, 9.5 * points)):
        label.set_position((1.02, axis.transData.inverted().transform((0.0, y))[1]))


def finish(figure, title, results, legend=None, legend_columns=6):
    """Title above, legend and machine below, nothing on top of anything."""
    width, height = figure.get_size_inches()
    footer = textwrap.wrap(machine_of(results), int(width * 15))
    title = textwrap.wrap(title, int(width * 10.5))
    legend_columns = min(legend_columns, max(1, int(width / 2.0)))  # inches that the longest name takes
    legend_rows = -(-len(legend[0]) // legend_columns) if legend else 0
    below = 0.125 * len(footer) + 0.12
    legend_height = 0.22 * legend_rows + (0.12 if legend_rows else 0.0)
    top = 0.15 + 0.22 * len(title)
    total = height + below + legend_height + top
    figure.set_size_inches(width, total)
    figure.suptitle("\n".join(title), x=0.5, y=1.0 - 0.08 / total, va="top", fontsize=12).set_in_layout(False)
    figure.text(0.01, 0.06 / total, "\n".join(footer).replace("$", r"\$"), fontsize=7, color=MUTED, va="bottom")
    if legend:
        figure.legend(*legend, loc="lower center", bbox_to_anchor=(0.5, below / total), ncol=legend_columns,
                      fontsize=9, borderaxespad=0.0)
    figure.tight_layout(rect=(0.0, (below + legend_height) / total, 1.0, 1.0 - top / total))
    for axis in figure.axes:
        part_labels(axis)


def machine_of(results):
    machine = results["machine"]
    return (f"{machine.get('cpu', '?')}, {machine.get('threads', '?')} threads, {machine.get('memory_gib', '?')} GiB; "
            f"{machine.get('system', '?')}; {machine.get('compiler', '?')}; Raylab {machine.get('raylab', '?')}")


def save(figure, file, ending="svg"):
    """Writes a figure to a path or an open file."""
    figure.savefig(file, format=ending, dpi=110,
                   metadata={"Software": None} if ending == "png" else {"Date": None, "Creator": None})
    plt.close(figure)


def drawn(chart, for_narrow):
    """The SVG text of a chart, for wide or for narrow windows."""
    global narrow
    narrow = for_narrow
    file = io.StringIO()
    save(chart.draw(), file)
    narrow = False
    return file.getvalue()


def legend_of(axes):
    """Handles and labels of all axes, each label once, in order of appearance."""
    found = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            found.setdefault(label, handle)
    return list(found.values()), list(found)
