#!/usr/bin/env python3
"""Render a Raylab scene with Mitsuba 3 and time it.

    bench/peers/mitsuba_render.py scenes/cornell.toml --width 400 --spp 64 --repeats 5 --json cornell.json

Needs the Python package mitsuba, and for llvm_ad_rgb the library LLVM 19 (on Debian libllvm19), found by itself or
named by DRJIT_LIBLLVM_PATH. Reading the scene, building its accelerator and compiling kernels are not in the times;
the warm-up that does the latter is reported apart. mitsuba_scene.py says where the two renderers differ.
"""

import argparse
import ctypes.util
import json
import os
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True

NO_ROULETTE = 1 << 20  # segments: more than any scene's max_depth
SAMPLES_PER_PASS = 1 << 24  # in flight at once, of the whole picture: bounds the memory of vectorised variants


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=Path, nargs="?", help="Raylab scene file (TOML)")
    parser.add_argument("--probe", action="store_true", help="only say whether Mitsuba and the variant can be used")
    parser.add_argument("--variant", choices=["llvm_ad_rgb", "scalar_rgb"], default="llvm_ad_rgb")
    parser.add_argument("--width", type=_positive, help="pixels; alone, it keeps the scene's aspect ratio")
    parser.add_argument("--height", type=_positive, help="pixels; alone, it keeps the scene's aspect ratio")
    parser.add_argument("--spp", type=_positive, help="samples per pixel (default: the scene's)")
    parser.add_argument("--max-depth", type=_positive, help="path segments (default: the scene's)")
    parser.add_argument("--rr-depth", type=_positive, default=NO_ROULETTE,
                        help="segments before Russian roulette (default: none; Mitsuba's own default is 5)")
    parser.add_argument("--repeats", type=_positive, default=3, help="timed renders (default: 3)")
    parser.add_argument("--threads", type=_positive, default=os.cpu_count(), help="default: all")
    parser.add_argument("--seed", type=int, default=0, help="of the first timed render; the others follow it")
    parser.add_argument("--one-sided-lights", action="store_true",
                        help="no copies of the emitters that shine backwards: faster, right where only fronts are seen")
    parser.add_argument("-o", "--output", type=Path, help="EXR of the first timed render, float RGB; "
                        "with {seed} in its name, one of each")
    parser.add_argument("--json", type=Path, help="write the result to this file")
    arguments = parser.parse_args()
    if not arguments.scene and not arguments.probe:
        parser.error("a scene file is missing")
    return arguments


def _positive(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"found {value}, expected at least 1")
    return value


def fail(message: str):
    sys.exit(f"mitsuba_render.py: {message}")  # exit code 1


def find_llvm() -> str | None:
    """LLVM 19 under the names that distributions give it."""
    names = [name for name in (ctypes.util.find_library("LLVM-19"), ctypes.util.find_library("LLVM")) if name]
    for ldconfig in ("ldconfig", "/sbin/ldconfig"):
        try:
            names += re.findall(r"=> (\S+)", subprocess.run([ldconfig, "-p"], capture_output=True, text=True).stdout)
            break
        except OSError:
            continue
    return next((name for name in names if re.search(r"libLLVM(-19\.so|\.so\.19)", name)), None)


def import_mitsuba(variant: str):
    if variant.startswith("llvm"):
        library = os.environ.get("DRJIT_LIBLLVM_PATH") or find_llvm()
        if library is None:
            fail("LLVM 19 is not installed (Debian package libllvm19); or name it by DRJIT_LIBLLVM_PATH")
        try:
            ctypes.CDLL(library)
        except OSError as error:
            fail(f"LLVM cannot be loaded: {error}")
        os.environ["DRJIT_LIBLLVM_PATH"] = library
    try:
        import mitsuba
    except ImportError as error:
        fail(f"Mitsuba is not installed (Python package mitsuba): {error}")
    mitsuba.set_variant(variant)
    return mitsuba


def picture_size(arguments, settings: dict) -> tuple[int, int]:
    width, height = int(settings.get("width", 800)), int(settings.get("height", 800))
    if arguments.width and not arguments.height:
        return arguments.width, max(1, int(arguments.width * height / width + 0.5))
    if arguments.height and not arguments.width:
        return max(1, int(arguments.height * width / height + 0.5)), arguments.height
    return arguments.width or width, arguments.height or height


def render(scene, seed: int, spp: int, pixels: int):
    """Picture and seconds. Renders that differ in seed share no random numbers."""
    import drjit
    import numpy

    # In passes that fit in memory, of nearly equal size: kernels are compiled once and serve any size.
    passes = min(spp, -(-spp * pixels // SAMPLES_PER_PASS))
    total = 0.0
    start = time.perf_counter()
    for i in range(passes):
        samples = spp * (i + 1) // passes - spp * i // passes
        picture = scene.integrator().render(scene, seed=seed * passes + i, spp=samples)
        drjit.eval(picture)
        drjit.sync_thread()
        total = total + numpy.array(picture, dtype=numpy.float64) * (samples / spp)
    return total, time.perf_counter() - start


def warm_up(scene, seed: int, spp: int, pixels: int, is_vectorised: bool):
    """Picture, seconds, and of these the seconds in which kernels were generated and compiled, or None. Kernels that
    Dr.Jit keeps on disk from an earlier run cost next to nothing."""
    import drjit

    if not is_vectorised:
        return *render(scene, seed, spp, pixels), None
    with drjit.scoped_set_flag(drjit.JitFlag.KernelHistory, True):
        drjit.kernel_history_clear()
        picture, seconds = render(scene, seed, spp, pixels)
        history = drjit.kernel_history()
    spent = sum(kernel.get("codegen_time", 0.0) + kernel.get("backend_time", 0.0) for kernel in history)
    return picture, seconds, spent / 1000.0


def mean_and_error(pictures):
    """Mean of each channel over all pictures and pixels, and its standard error from the spread of each pixel. Under
    a box filter pixels are independent."""
    import numpy

    stack = numpy.stack(pictures)
    count, pixels = len(pictures), stack[0].shape[0] * stack[0].shape[1]
    variance = stack.var(axis=0, ddof=1) / count
    return stack.mean(axis=(0, 1, 2)), numpy.sqrt(variance.sum(axis=(0, 1))) / pixels


def replace_file(file: Path, write):
    """Writes beside the file, then renames: what was there stays until the new one is whole."""
    partial = file.with_name(f".partial-{file.name}")
    try:
        write(partial)
        partial.replace(file)
    except (OSError, RuntimeError) as error:
        partial.unlink(missing_ok=True)
        fail(f"{file} could not be written: {error}")


def main():
    arguments = parse_arguments()
    mi = import_mitsuba(arguments.variant)
    if arguments.probe:
        return
    import drjit
    import mitsuba_scene
    import numpy

    drjit.set_thread_count(arguments.threads)
    try:
        description = mitsuba_scene.load_description(arguments.scene)
        settings = description.get("render", {})
        width, height = picture_size(arguments, settings)
        spp = arguments.spp or int(settings.get("samples_per_pixel", 64))
        max_depth = arguments.max_depth or int(settings.get("max_depth", 7))
        exporter = mitsuba_scene.SceneExport(arguments.scene, description, not arguments.one_sided_lights)
        scene = exporter.scene(width, height, max_depth, arguments.rr_depth)
    except mitsuba_scene.InputError as error:
        fail(str(error))

    # The warm-up has a seed of its own, so that its picture can serve for the mean.
    is_vectorised = arguments.variant.startswith("llvm")
    picture, warm_up_seconds, compile_seconds = warm_up(
        scene, arguments.seed + arguments.repeats, spp, width * height, is_vectorised)
    pictures, times = [picture], []
    for repeat in range(arguments.repeats):
        picture, seconds = render(scene, arguments.seed + repeat, spp, width * height)
        pictures.append(picture)
        times.append(seconds)

    mean, error = mean_and_error(pictures)
    median = statistics.median(times)
    row = {
        "renderer": "mitsuba",
        "version": mi.__version__,
        "variant": arguments.variant,
        "scene": arguments.scene.stem,
        "width": width,
        "height": height,
        "spp": spp,
        "max_depth": max_depth,
        "rr_depth": None if arguments.rr_depth == NO_ROULETTE else arguments.rr_depth,
        "one_sided_lights": arguments.one_sided_lights,
        "threads": arguments.threads,
        "seed": arguments.seed,
        "seconds": {"median": median, "min": min(times), "max": max(times)},
        "all_seconds": times,
        "warm_up_seconds": warm_up_seconds,
        "compile_seconds": compile_seconds,
        "mpaths_per_second": width * height * spp / median * 1e-6,
        "mean": mean.tolist(),
        "mean_standard_error": error.tolist(),
    }
    print(f"{row['scene']}: Mitsuba {row['version']} {row['variant']}, {width} x {height}, {spp} spp, "
          f"{max_depth} segments, {arguments.threads} threads")
    print(f"  {median:.3f} s, median of {len(times)} ({min(times):.3f} to {max(times):.3f}), "
          f"{row['mpaths_per_second']:.3f} Mpaths/s; apart from that a warm-up of {warm_up_seconds:.3f} s"
          + (f", {compile_seconds:.3f} s of it compiling" if compile_seconds is not None else ""))
    print("  mean " + "  ".join(f"{name} {m:.6f} ± {e:.6f}" for name, m, e in zip("RGB", mean, error)))
    if not numpy.isfinite(mean).all():
        print("  some pixels are not finite", file=sys.stderr)
    if arguments.output:
        timed = pictures[1:] if "{seed}" in arguments.output.name else pictures[1:2]
        for repeat, picture in enumerate(timed):
            bitmap = mi.Bitmap(picture.astype(numpy.float32))
            name = arguments.output.name.replace("{seed}", str(arguments.seed + repeat))
            replace_file(arguments.output.with_name(name), lambda file: bitmap.write(str(file)))
    if arguments.json:
        replace_file(arguments.json, lambda file: file.write_text(json.dumps(row, indent=2) + "\n"))


if __name__ == "__main__":
    main()
