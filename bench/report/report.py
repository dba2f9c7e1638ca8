#!/usr/bin/env python3
"""Draws the charts of a folder of results, from its results.json alone, and index.html that
shows them beneath the tables that answer first.

    bench/report/report.py DIR [--png]

Called by `raylab-bench report DIR`. Needs matplotlib and scipy (Debian packages python3-matplotlib, python3-scipy).
"""

import argparse
import sys
from pathlib import Path

sys.dont_write_bytecode = True

try:
    import answers
    import difference_charts
    import ladder_charts
    import needs_charts
    import page
    import process_charts
    import rays_charts
    import render_charts
    import rows
    import scale_charts
    import stability_charts
    import style
except ModuleNotFoundError as missing:
    print(f"report.py: no module {missing.name}; Debian: apt-get install python3-{missing.name}", file=sys.stderr)
    sys.exit(1)

SUITES = [rays_charts, render_charts, difference_charts, ladder_charts, scale_charts, needs_charts, process_charts,
          stability_charts]


def charts_of(results, folder):
    """All charts; the folder holds the pictures of differences."""
    for suite in SUITES:
        yield from suite.charts(results, folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--png", action="store_true", help="also as PNG")
    options = parser.parse_args()
    file = options.folder / "results.json"
    try:
        results = rows.read_results(file)
        figures = []
        for chart in charts_of(results, options.folder):
            drawings = {shape: style.drawn(chart, shape == "narrow") for shape in ("wide", "narrow")}
            (options.folder / f"{chart.name}.svg").write_text(drawings["wide"], encoding="utf-8")
            if options.png:
                style.save(chart.draw(), options.folder / f"{chart.name}.png", "png")
            figures.append(page.figure(chart, drawings))
        tables = [part for suite in SUITES if hasattr(suite, "tables") for part in suite.tables(results)]
        page.write(options.folder, results, answers.html(results), figures, tables)
    except (rows.RowError, ValueError) as error:
        print(f"report.py: {file}: {error}", file=sys.stderr)
        return 3
    except OSError as error:
        print(f"report.py: {error}", file=sys.stderr)
        return 3 if error.filename == str(file) else 4
    print(options.folder / "index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
