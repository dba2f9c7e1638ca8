"""Whole pictures: error against time, time to a given error, and where pictures differ."""

from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

import style

SAMPLER_STYLES = {"sobol": "-", "independent": "--"}
INTEGRATOR_MARKERS = {"path": "o", "book": "X"}


def name_of(row):
    """What sets a way of rendering apart: the usual integrator and sampler go without saying."""
    if row.get("renderer"):
        return f"Mitsuba 3 ({row['renderer'].split()[-1]})"
    extras = [row.get("integrator", "path")] * (row.get("integrator", "path") != "path")
    extras += [row.get("sampler", "sobol")] * (row.get("sampler", "sobol") != "sobol")
    return style.variant(row) + (", " + ", ".join(extras) if extras else "")


def by_scene(rows):
    scenes = {}
    for row in rows:
        scenes.setdefault(row["scene"], []).append(row)
    return scenes


def plain_number(x, _=None):
    return f"{x:g}" if 1e-4 <= x < 1e5 else f"{x:.0e}"


def number_decades(side):
    """Numbers along a logarithmic axis: at the decades, and between them where there are few."""
    low, high = side.get_view_interval()
    between = (1.0, 2.0, 5.0) if high < 50.0 * low else (1.0,)
    side.set_major_locator(LogLocator(subs=between, numticks=7))
    side.set_major_formatter(FuncFormatter(plain_number))
    side.set_minor_formatter(NullFormatter())


def convergence(results, scenes):
    figure, axes = style.panels(len(scenes), 3, width=4.4, height=4.0)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        ways = {}
        for row in rows:
            ways.setdefault(name_of(row), []).append(row)
        for name, points in ways.items():
            points.sort(key=lambda row: row["spp"])
            row = points[0]
            axis.errorbar([p["seconds"] for p in points], [p["relmse"] for p in points],
                          yerr=[[min(p.get("relmse_error", 0.0), 0.9 * p["relmse"]) for p in points],
                                [p.get("relmse_error", 0.0) for p in points]],
                          xerr=[[p["seconds"] - p["seconds_min"] for p in points],
                                [p["seconds_max"] - p["seconds"] for p in points]],
                          color=style.color(row["accel"]), linestyle=SAMPLER_STYLES.get(row.get("sampler", "sobol"), "-"),
                          marker=INTEGRATOR_MARKERS.get(row.get("integrator", "path"), "s"), markersize=5, capsize=2,
                          elinewidth=0.8, linewidth=1.3, alpha=0.9, label=name)
        axis.axhline(rows[0]["reference_relmse"], color="#999999", linestyle=":", linewidth=1,
                     label="the reference's own relMSE")
        axis.set_xscale("log")
        axis.set_yscale("log")
        for side in (axis.xaxis, axis.yaxis):
            number_decades(side)
        size = f"{rows[0]['width']} × {rows[0]['height']}"
        spp = sorted({row["spp"] for row in rows})
        axis.set_title(f"{scene}, {size}, {rows[0]['threads']} threads\n{', '.join(map(str, spp))} samples per pixel",
                       fontsize=10)
        axis.set_xlabel("seconds of rendering")
    axes[0].set_ylabel("relMSE")
    style.finish(figure, "Error against time (down and to the left is better)", results, ["render"],
                 style.legend_of(axes), legend_columns=4)
    return figure


def time_to_error(results, scenes):
    rows_most = max(len(rows) for rows in scenes.values())
    figure, axes = style.panels(len(scenes), 3, width=4.6, height=0.8 + 0.3 * rows_most)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        rows = sorted(rows, key=lambda row: -row["seconds"])
        names = [name_of(row) for row in rows]
        bars = axis.barh(names, [row["seconds"] for row in rows], color=[style.color(row["accel"]) for row in rows],
                         height=0.7)
        axis.bar_label(bars, [f" {row['seconds']:.3g} s{' *' if row.get('extrapolated') else ''}" for row in rows],
                       fontsize=8)
        axis.set_xscale("log")
        low, high = min(row["seconds"] for row in rows), max(row["seconds"] for row in rows)
        axis.set_xlim(low / 2.0, high * (high / low) ** 0.35 * 2.0)
        number_decades(axis.xaxis)
        axis.grid(False, axis="y")
        axis.set_title(f"{scene}: relMSE {rows[0]['target_relmse']:g}")
        axis.set_xlabel("seconds")
    style.finish(figure, "Time to a given error (* extrapolated: error × seconds constant)", results, ["render"])
    return figure


def differences(results, scenes):
    """Share of pixels that differ at equal random numbers."""
    figure, axes = style.panels(len(scenes), 3, width=4.2, height=2.0)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        shares = [100.0 * row["different_pixels"] / row["pixels"] for row in rows]
        bars = axis.barh([style.variant(row) for row in rows], shares,
                         color=[style.color(row["accel"]) for row in rows], height=0.7)
        axis.bar_label(bars, [f" {share:.2g}%, relMSE {row['relmse']:.1g}" for share, row in zip(shares, rows)],
                       fontsize=8)
        axis.set_xlim(0.0, 2.0 * max(shares + [0.01]))
        axis.grid(False, axis="y")
        axis.set_title(f"{scene} against {rows[0]['against']}, {rows[0]['spp']} spp", fontsize=10)
        axis.set_xlabel("% of pixels that differ by more than 0.1%")
    style.finish(figure, "Pictures of two accelerators at equal random numbers", results, ["render"])
    return figure


def charts(results):
    rows = [row for row in results["rows"] if row["suite"] == "render"]
    measured = by_scene(row for row in rows if "question" not in row and "reference_relmse" in row)
    if measured:
        yield ("convergence", "relMSE against the seconds of rendering: mean of independent runs with its standard error; "
               "seconds: median and range. Below the dotted line the reference is the noisier of the two. Unless it is "
               "said, the integrator is path and the sampler sobol.", convergence(results, measured))
    targets = by_scene(row for row in rows if row.get("question") == "time to error")
    if targets:
        yield ("time-to-error", "Seconds to a given relMSE, interpolated between the measured points.",
               time_to_error(results, targets))
    different = by_scene(row for row in rows if row.get("question") == "difference")
    if different:
        yield ("differences", "Same scene, same random numbers, another accelerator: what is left is what the "
               "accelerators do differently.", differences(results, different))


def pictures(results):
    """(file, caption) of the pictures of differences."""
    for row in results["rows"]:
        if row.get("picture"):
            yield (row["picture"], f"{row['scene']}: {style.variant(row)} against {row['against']}; relative error, white "
                   "is 10% and more")
