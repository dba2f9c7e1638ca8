"""Known failures: how often each method fails, against what breaks it, and from where on."""

from html import escape

from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

import intervals
import style
from markup import Cell, missing, table
from style import number

LIGHT_COLORS = {"path": style.BLUE, "path, book offset": style.ORANGE, "book": style.GREEN,
                "book, book offset": style.VERMILION, "reference": style.PINK}
OTHER_COLORS = {"raylab": style.BLUE, "bounds offset": style.BLUE, "book offset": style.ORANGE}

PROMISES = {
    "list": "every primitive tested; watertight: no leak at edges and vertices",
    "rtiow": "none: the book's boxes and, with book, its triangle test, faults kept",
    "bvh": "with watertight, the answers of list watertight, in single rays and in batches to the bit",
    "embree": "none at edges; in batches other rounding than in single rays",
    "embree-robust": "no leak at edges; vertices are not promised",
    "exact": "the judge: no rounding at all",
    "path": "no light through surfaces, the mean of the light transport equation",
    "book": "the same mean, found without light sampling",
    "reference": "the bits of path",
    "bounds": "the ray starts on its side of the surface for every accelerator's arithmetic",
    "raylab": "what stands beside each case; shaded in the charts",
}


def is_light(row):
    return "integrator" in row


def method(row):
    """The method as a name, single or in batches alike."""
    if is_light(row):
        name = row["integrator"] + (", book offset" if row["ray_offset"] == "book" else "")
        return name if row["accel"] == "bvh" else f"{name} {row['accel']}"
    if "ray_offset" in row:
        return f"{row['ray_offset']} offset"
    return " ".join(part for part in (style.variant(row), row.get("isa_asked", "")) if part) or "raylab"


def cases_of(results):
    """{case: {method: {queries: [row by value]}}}, by the cases' numbers."""
    cases = {}
    for row in results["rows"]:
        if row["suite"] == "stability":
            found = cases.setdefault(row["case"], {}).setdefault(method(row), {})
            found.setdefault(row.get("queries", "single"), []).append(row)
    for methods in cases.values():
        for ways in methods.values():
            for rows in ways.values():
                rows.sort(key=lambda row: row["value"])
    return dict(sorted(cases.items()))


def first_of(methods):
    return next(iter(next(iter(methods.values())).values()))[0]


def look(name, row):
    if is_light(row):
        return style.Look(LIGHT_COLORS.get(name, style.GREY), "o", "-")
    if name in OTHER_COLORS:
        return style.Look(OTHER_COLORS[name], "o", "-")
    return style.look_of(row)


def counts(rows):
    return [(row["failures"], row["trials"]) for row in rows]


def lines_of(methods):
    """(name, rows, whether in batches) of each method that fails somewhere; batches where they differ."""
    for name, ways in methods.items():
        single = next(iter(ways.values()))
        if any(row["failures"] for row in single):
            yield name, single, False
        if "batch" in ways and "single" in ways and counts(ways["batch"]) != counts(ways["single"]):
            yield f"{name} batch", ways["batch"], True


def joined(names):
    """Names in one, what they have in common once: list, bvh book."""
    by_rest = {}
    if any(", " in name for name in names):
        return "; ".join(names)
    for name in names:
        accel, _, rest = name.partition(" ")
        by_rest.setdefault(rest, []).append(accel)
    return "; ".join(f"{', '.join(accels)} {rest}".strip() for rest, accels in by_rest.items())


def apart(lines):
    """(names, rows, whether in batches), lines that lie on each other as one."""
    found = {}
    for name, rows, batch in lines:
        places = tuple((row["value"], row["failures"], row["trials"]) for row in rows)
        found.setdefault((places, batch), ([], rows))[0].append(name)
    return [(names, rows, batch) for (_, batch), (names, rows) in found.items()]


def panel(axis, methods):
    first = first_of(methods)
    values = sorted({row["value"] for ways in methods.values() for rows in ways.values() for row in rows})
    place = {value: i for i, value in enumerate(values)}
    failing = list(lines_of(methods))
    failed = {name.removesuffix(" batch") for name, *_ in failing}
    least = 1.0
    for names, rows, batch in apart(failing):
        drawn = look(names[-1].removesuffix(" batch"), rows[0])
        xs, ys, below, above = [], [], [], []
        for row in rows:
            low, high = intervals.proportion(row["failures"], row["trials"])
            rate = row["failures"] / row["trials"] or high  # none: at the interval's upper end
            xs.append(place[row["value"]])
            ys.append(rate)
            below.append(rate - low if row["failures"] else 0.0)
            above.append(high - rate)
            least = min(least, rate)
        axis.errorbar(xs, ys, yerr=[below, above], marker=drawn.marker, markersize=4, color=drawn.color, capsize=2,
                      elinewidth=1, linewidth=1.2, linestyle=":" if batch else drawn.line)
        none = [(x, y) for x, y, row in zip(xs, ys, rows) if row["failures"] == 0]
        if none:  # hollow: nothing failed, and this is all that is known
            axis.plot(*zip(*none), marker=drawn.marker, markersize=4, color=drawn.color, linestyle="none",
                      markerfacecolor=style.PAPER, zorder=5)
        style.label_end(axis, xs[-1], ys[-1], joined(names), drawn.color)
    holding = [ways for name, ways in methods.items() if name not in failed]
    if holding:
        rows = next(iter(holding[0].values()))
        xs, ys = [place[row["value"]] for row in rows], [intervals.proportion(0, row["trials"])[1] for row in rows]
        least = min(least, *ys)
        label = "none fails" if not failing else f"{len(holding)} more: none fail"
        axis.plot(xs, ys, color=style.MUTED, linestyle="--", linewidth=1, marker="_")
        style.label_end(axis, xs[-1], ys[-1], label, style.MUTED)
    held = [place[row["value"]] for row in next(iter(next(iter(methods.values())).values())) if row["holds"]]
    if held:
        axis.axvspan(min(held) - 0.4, max(held) + 0.4, color=style.ZONE, zorder=-1)
    axis.set_yscale("log")
    least = min(least, 0.02)  # so that there are three decades, be there few trials
    axis.set_ylim(least / 2.0, 1.6)
    axis.yaxis.set_major_locator(FixedLocator([10.0 ** -k for k in range(0, 8) if 10.0 ** -k >= least / 2.0]))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{100.0 * y:g}%"))
    axis.yaxis.set_minor_locator(NullLocator())
    axis.set_xlim(-0.5, len(values) - 0.5)
    step = max(1, -(-len(values) // 5))
    axis.set_xticks(range(0, len(values), step), [number(value) for value in values[::step]], fontsize=7)
    axis.tick_params(axis="y", labelsize=7)
    axis.set_title(f"{first['case']} {first['scene']}", fontsize=9)
    axis.set_xlabel(first["swept"], fontsize=8)


def figure(results, theme, cases):
    drawn, axes = style.panels(len(cases), 3, width=4.3, height=2.3)
    for axis, methods in zip(axes, cases.values()):
        panel(axis, methods)
    style.finish(drawn, f"Known failures, {theme}: how often each method fails", results)
    return drawn


def says(cases):
    """What the worst of the rates are, and what none at all means."""
    rows = [row for methods in cases.values() for ways in methods.values() for found in ways.values() for row in found]
    failing = {}
    for case, methods in cases.items():
        for name, *_ in lines_of(methods):
            failing.setdefault(name.removesuffix(" batch"), set()).add(case)
    most = max(row["trials"] for row in rows)
    none = number(1e6 * intervals.proportion(0, most)[1])
    parts = "; ".join(f"{name} in {len(found)}" for name, found in
                      sorted(failing.items(), key=lambda item: -len(item[1])))
    what = f"Of {len(cases)} cases fail: {parts}" if parts else f"Nothing fails in {len(cases)} cases"
    return (f"{what}. "
            f"0 of {most:,} means below {none} in a million at 95%.")


def themes(results):
    found = {}
    for case, methods in cases_of(results).items():
        found.setdefault(first_of(methods)["theme"], {})[case] = methods
    return found


def charts(results, _):
    for theme, cases in themes(results).items():
        what = "; ".join(f"{case}: {row['title'][0].lower()}{row['title'][1:]} (fails: {row['fails']})"
                         for case, row in ((case, first_of(methods)) for case, methods in cases.items()))
        yield style.Chart(
            f"stability-{theme.replace(' ', '-')}", says(cases),
            "Rates with their 95% intervals (Clopper and Pearson); hollow, and dashed for all that never fail: none "
            "failed, at the interval's upper end. Dotted: batches, where they differ from single rays. Shaded: where "
            f"bvh and the default offsets are held to fail nowhere. {what}.",
            lambda theme=theme, cases=cases: figure(results, theme, cases))


def where(rows):
    """From where on a method fails, as a cell with the worst rate beneath."""
    failing = [row["failures"] > 0 for row in rows]
    if not any(failing):
        return Cell("holds", 0.0)
    worst = max(row["failures"] / row["trials"] for row in rows)
    values = [row["value"] for row, bad in zip(rows, failing) if bad]
    first, last = failing.index(True), len(failing) - 1 - failing[::-1].index(True)
    whole = all(failing[first:last + 1])
    if whole and first == 0 and last == len(rows) - 1:
        text = "everywhere"
    elif whole and last == len(rows) - 1:
        text = f"from {number(values[0])}"
    elif whole and first == 0:
        text = f"to {number(values[-1])}"
    elif len(values) == 1:
        text = f"at {number(values[0])}"
    else:
        text = f"{number(values[0])}–{number(values[-1])}" + ("" if whole else ", not all")
    return Cell(text, worst, f"{number(100.0 * worst)}%")


def cell(methods, name):
    """The worse of single rays and batches."""
    ways = methods.get(name)
    if ways is None:
        return missing("does not apply, or too large for it")
    cells = {how: where(rows) for how, rows in ways.items()}
    if "single" in cells and "batch" in cells and cells["single"].text != cells["batch"].text:
        return Cell(f"{cells['single'].text}; batch {cells['batch'].text}", cells["batch"].value, cells["batch"].below)
    return next(iter(cells.values()))


def matrix(cases):
    names = []
    for methods in cases.values():
        names += [name for name in methods if name not in names]
    body = [[f"{case} {first_of(methods)['scene']}", first_of(methods)["swept"],
             *(cell(methods, name) for name in names)] for case, methods in cases.items()]
    return table(["case", "swept", *names], body)


def promises(cases):
    """How many of its cases each method holds, beside what it promises."""
    held, tried = {}, {}
    for methods in cases.values():
        for name, ways in methods.items():
            good = all(row["failures"] == 0 for rows in ways.values() for row in rows)
            held[name] = held.get(name, 0) + good
            tried[name] = tried.get(name, 0) + 1
    rows = []
    for name, number_of in tried.items():
        promise = "none: a length is built in" if "book offset" in name else PROMISES.get(name.split()[0], "–")
        rows.append([name, promise, f"{held[name]} of {number_of}"])
    return table(["method", "what it promises", "cases in which nothing fails"], rows)


def tables(results):
    """HTML of the matrices of cases and methods, and of what each promises."""
    cases = cases_of(results)
    if not cases:
        return
    kinds = {"rays": {}, "light": {}, "ours": {}}
    for case, methods in cases.items():
        row = first_of(methods)
        kinds["light" if is_light(row) else "rays" if "accel" in row and "ray_offset" not in row else "ours"][case] = (
            methods)
    titles = {"rays": "Where accelerators fail", "light": "Where integrators fail", "ours": "Where the rest fails"}
    for kind, some in kinds.items():
        if some:
            yield (f"<h2>{escape(titles[kind])}</h2>\n<p>From which value of the swept quantity on each method fails, "
                   "and its worst rate beneath.</p>" + matrix(some))
    yield "<h2>What each method promises</h2>" + promises(cases)
