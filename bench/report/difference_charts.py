"""Where pictures of two accelerators differ at equal random numbers."""

import math

from matplotlib.image import imread
from matplotlib.ticker import MaxNLocator

import style
from render_charts import by_size, dots
from style import number


def differences(results, scenes):
    """Share of pixels that differ at equal random numbers."""
    most = max(len(rows) for rows in scenes.values())
    figure, axes = style.panels(len(scenes), 3, width=4.4, height=0.9 + 0.3 * most)
    for axis, (scene, rows) in zip(axes, scenes.items()):
        shares = [100.0 * row["different_pixels"] / row["pixels"] for row in rows]
        dots(axis, rows, [style.variant(row) for row in rows], shares, map(style.look_of, rows),
             lambda row, share: f"{number(share)}%, relMSE {row['relmse']:.1g}" if share else "none")
        axis.set_xlim(-0.05 * max(shares + [0.01]), 1.2 * max(shares + [0.01]))
        axis.xaxis.set_major_locator(MaxNLocator(3))
        axis.set_title(f"{scene} against {rows[0]['against']}, {rows[0]['spp']} spp", fontsize=10)
        axis.set_xlabel("% of pixels that differ by more than 0.1%", fontsize=9)
    style.finish(figure, "Pictures of two accelerators at equal random numbers", results)
    return figure


FULL_SCALE = 10.0  # % of relative error that a picture of differences shows as white
ERROR_DOTS = [(0.0, "below 0.1%", style.SKY, 8), (0.1, "0.1% to 1%", style.ORANGE, 16),
              (1.0, "1% to 10%", style.VERMILION, 26), (10.0, "10% and more", style.INK, 40)]


def where(results, folder, rows):
    """A dot at each pixel that differs, larger than the pixel, in colour and size of how much."""
    figure, axes = style.panels(len(rows), 4, width=3.0, height=3.5)
    limits = [least for least, *_ in ERROR_DOTS] + [math.inf]
    for axis, row in zip(axes, rows):
        picture = imread(folder / row["picture"])[..., :3]
        error = FULL_SCALE * picture.sum(axis=2) / 3.0  # a third of the ramp in each of red, green and blue
        for (least, label, color, size), beyond in zip(ERROR_DOTS, limits[1:]):
            ys, xs = ((error > 0.0) & (error >= least) & (error < beyond)).nonzero()
            axis.scatter(xs, ys, s=size, color=color, label=label)
        axis.set_xlim(0, picture.shape[1])
        axis.set_ylim(picture.shape[0], 0)
        axis.set_aspect("equal")
        axis.set_xticks([])
        axis.set_yticks([])
        for side in ("top", "right"):
            axis.spines[side].set_visible(True)
        axis.set_title(f"{row['scene']}: {style.variant(row)}\nagainst {row['against']}", fontsize=9)
    style.finish(figure, "Where pictures differ at equal random numbers", results, style.legend_of(axes))
    return figure


def most_different(scenes):
    rows = [row for rows in scenes.values() for row in rows]
    same = [row for row in rows if row["different_pixels"] == 0]
    most = max(rows, key=lambda row: row["different_pixels"] / row["pixels"])
    says = f"{len(same)} of {len(rows)} pictures are the same in every pixel within 0.1%"
    if most not in same:
        says += (f"; most differ {style.variant(most)} and {most['against']} on {most['scene']}: "
                 f"{most['different_pixels']} of {most['pixels']:,} pixels, relMSE {number(most['relmse'])}")
    return says + "."


def charts(results, folder):
    rows = [row for row in results["rows"] if row["suite"] == "render"]
    different = by_size(row for row in rows if row.get("question") == "difference")
    if different:
        yield style.Chart(
            "differences", most_different(different),
            "Same scene, same random numbers, another accelerator: what is left is what the accelerators do "
            "differently.",
            lambda: differences(results, different))
    seen = [row for rows in different.values() for row in rows
            if row["different_pixels"] and (folder / row.get("picture", "")).is_file()]
    if seen:
        yield style.Chart(
            "where", f"{len(seen)} pictures differ somewhere; each dot is a pixel that does.",
            "Dots are large enough to be seen, and tell the pixel's relative error by colour and size: one of 0.01% is "
            "seen as well as one of 10%, which amplifies it by 1,000.",
            lambda: where(results, folder, seen))
