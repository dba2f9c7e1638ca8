#!/usr/bin/env python3
"""Render a Raylab scene with Mitsuba 3 and time it.

    bench/peers/mitsuba_render.py scenes/cornell.toml --width 400 --spp 64 --repeats 5 --json cornell.json

Needs the Python package mitsuba, and for llvm_ad_rgb the library LLVM 19 (on Debian libllvm19), found by itself or
named by DRJIT_LIBLLVM_PATH. Reading the scene, building its accelerator and compiling kernels are not in the times;
they are reported apart. mitsuba_scene.py says where the two renderers differ.
"""

import argparse
import ctypes.util
import os
import re
import subprocess
import sys

sys.dont_write_bytecode = True
from peer import Command, Peer, Rendered, Watch, positive
import numpy as np  # after peer, which says in one line that it is missing

SAMPLES_PER_PASS = 1 << 24  # in flight at once, of the whole picture: bounds the memory of vectorised variants


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


def import_mitsuba(command: Command, variant: str):
    if variant.startswith("llvm"):
        library = os.environ.get("DRJIT_LIBLLVM_PATH") or find_llvm()
        if library is None:
            command.fail("LLVM 19 is not installed (Debian package libllvm19); or name it by DRJIT_LIBLLVM_PATH")
        try:
            ctypes.CDLL(library)
        except OSError as error:
            command.fail(f"LLVM cannot be loaded: {error}")
        os.environ["DRJIT_LIBLLVM_PATH"] = library
    try:
        import mitsuba
    except ImportError as error:
        command.fail(f"Mitsuba is not installed (Python package mitsuba): {error}")
    mitsuba.set_variant(variant)
    return mitsuba


def render(scene, seed: int, spp: int, pixels: int) -> Rendered:
    """Renders that differ in seed share no random numbers."""
    import drjit

    # In passes that fit in memory, of nearly equal size: kernels are compiled once and serve any size.
    passes = min(spp, -(-spp * pixels // SAMPLES_PER_PASS))
    sampler = scene.sensors()[0].sampler()
    total, taken = 0.0, 0
    watch = Watch()
    for i in range(passes):
        samples = spp * (i + 1) // passes - spp * i // passes
        picture = scene.integrator().render(scene, seed=seed * passes + i, spp=samples)
        drjit.eval(picture)
        drjit.sync_thread()
        count = sampler.sample_count()  # some samplers take only squares or primes
        total, taken = total + np.array(picture, dtype=np.float64) * count, taken + count
    return Rendered(total / taken, *watch.stop(), taken)


def compile_kernels(scene, spp: int, pixels: int) -> float:
    """Renders once to warm up. Returns the seconds in which kernels were generated and compiled: next to nothing for
    those that Dr.Jit keeps on disk from an earlier run."""
    import drjit

    with drjit.scoped_set_flag(drjit.JitFlag.KernelHistory, True):
        drjit.kernel_history_clear()
        render(scene, 0, spp, pixels)
        history = drjit.kernel_history()
    return sum(kernel.get("codegen_time", 0.0) + kernel.get("backend_time", 0.0) for kernel in history) / 1000.0


def main():
    command = Command("mitsuba", __doc__, ["llvm_ad_rgb", "scalar_rgb"],
                      ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"])
    command.parser.add_argument("--rr-depth", type=positive, help="segments before Russian roulette")
    command.parser.add_argument("--one-sided-lights", action=argparse.BooleanOptionalAction,
                                help="no copies of the emitters that shine backwards")
    arguments = command.parse()
    mi = import_mitsuba(command, arguments.variant)
    if arguments.probe:
        return
    import drjit
    import mitsuba_scene

    start_up = {"import": command.seconds()}
    drjit.set_thread_count(arguments.threads)
    with command.telling_errors():
        file = command.read_scene(arguments)
        start_up["read"] = command.seconds()
        width, height, max_depth = arguments.width, arguments.height, arguments.max_depth
        exporter = mitsuba_scene.SceneExport(file, not arguments.one_sided_lights)
        scene = exporter.scene(width, height, max_depth, arguments.rr_depth, arguments.sampler)
    start_up["build"] = command.seconds()

    def prepare(spp: int):
        if arguments.variant.startswith("llvm"):
            start_up["compile"] = compile_kernels(scene, spp, width * height)

    peer = Peer(
        name="mitsuba",
        version=mi.__version__,
        width=width,
        height=height,
        max_depth=max_depth,
        settings={
            "sampler": arguments.sampler,
            "rr_depth": arguments.rr_depth,
            "one_sided_lights": arguments.one_sided_lights,
        },
        differences=mitsuba_scene.differences(file, not arguments.one_sided_lights),
        render=lambda seed, spp: render(scene, seed, spp, width * height),
        start_up=start_up,
        prepare=prepare,
    )
    command.measure(arguments, peer)


if __name__ == "__main__":
    main()
