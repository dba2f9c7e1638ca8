#!/usr/bin/env python3
"""Draws the charts of a folder of results, from its results.json alone, and index.html that shows them.

    bench/report/report.py DIR [--png]

Called by `raylab-bench report DIR`. Needs matplotlib and scipy (Debian packages python3-matplotlib, python3-scipy).
"""

import argparse
import sys
from pathlib import Path

sys.dont_write_bytecode = True

try:
    import intervals  # noqa: F401
    import ladder_charts
    import needs_charts
    import page
    import process_charts
    import rays_charts
    import render_charts
    import rows
    import scale_charts
    import style
except ModuleNotFoundError as missing:
    print(f"report.py: no module {missing.name}; Debian: apt-get install python3-{missing.name}", file=sys.stderr)
    sys.exit(1)

SUITES = [rays_charts, ladder_charts, render_charts, scale_charts, needs_charts, process_charts]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--png", action="store_true", help="also as PNG")
    options = parser.parse_args()
    file = options.folder / "results.json"
    shown = []
    try:
        results = rows.read_results(file)
        for suite in SUITES:
            for name, caption, figure in suite.charts(results):
                style.save(figure, options.folder, name, options.png)
                shown.append((name, caption))
        page.write(options.folder, results, shown, list(render_charts.pictures(results)),
                   [part for suite in SUITES if hasattr(suite, "tables") for part in suite.tables(results)])
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
