#!/usr/bin/env python3
"""Make every scene file, mesh and texture in this folder.

    scenes/generate.py             write all scenes
    scenes/generate.py forest      write one
    scenes/generate.py --check     write nothing; exit 1 and name what differs

The output is committed, so that nobody needs Python to render; this script is
its source. It uses the standard library alone, and a rerun changes no byte.
The scanned models are not made here: see the `fetch` script beside this one.
"""

import argparse
import sys
from pathlib import Path

sys.dont_write_bytecode = True

from generators import SCENES, png  # noqa: E402

HERE = Path(__file__).resolve().parent


def same(name, committed, made):
    """PNGs are compared by their pixels: zlib versions pack the same bytes differently."""
    if name.endswith(".png"):
        return png.decode(committed) == png.decode(made)
    return committed == made


def main():
    parser = argparse.ArgumentParser(description="Make the scenes that Raylab ships.")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"any of {', '.join(SCENES)} (default: all)")
    parser.add_argument("--check", action="store_true", help="compare with the files on disk instead of writing them")
    options = parser.parse_args()
    unknown = [name for name in options.scenes if name not in SCENES]
    if unknown:
        parser.error(f"no scene named {', '.join(unknown)}; there are {', '.join(SCENES)}")

    differing = []
    for scene in options.scenes or SCENES:
        for name, content in SCENES[scene]().items():
            path = HERE / name
            if not options.check:
                path.write_bytes(content)
                print(f"{name}: {len(content)} bytes")
            elif not path.is_file():
                differing.append(f"{name}: missing")
            elif not same(name, path.read_bytes(), content):
                differing.append(f"{name}: differs from what generate.py makes")
    print("\n".join(differing), end="\n" if differing else "", file=sys.stderr)
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
