#!/usr/bin/env python3
"""Render a Raylab scene with LuxCore and time it.

    bench/peers/luxcore_render.py scenes/cornell.toml --variant PATHCPU --width 400 --spp 64 --json cornell.json

Needs the Python package pyluxcore. Reading the scene and building its accelerator are not in the times. differences()
says where the two renderers differ.
"""

import argparse
import atexit
import sys
import time

sys.dont_write_bytecode = True
from peer import Command, Peer, Rendered, Watch, positive
import numpy as np  # after peer, which says in one line that it is missing
from scene_file import BLACK, InputError, SceneFile, Surface, as_triangles

GRADIENT_ROWS = 1024
NO_ROULETTE = 1 << 20  # segments: more than any scene's max_depth


def differences(file: SceneFile, variant: str, two_sided_lights: bool) -> list[str]:
    spheres = [surface for surface in file.surfaces if not surface.part]
    metals = [surface for surface in file.surfaces if surface.material.get("fuzz", 0.0) > 0.0]
    lights = [surface for surface in file.surfaces if surface.radiance is not None]
    found = {
        "subpaths from camera and light have max_depth segments each, so that longer paths count too":
            variant.startswith("BIDIR"),
        "merging of neighbouring vertices is biased": variant == "BIDIRVMCPU",
        "spheres are triangles with smooth normals": spheres,
        "fuzzy metal is a microfacet lobe (carpaint) of the same median width": metals,
        "lights shine from the front only": lights and not two_sided_lights,
        "a light is two, back to back": lights and two_sided_lights,
        "pictures are decoded by a power of 2.2, in Raylab by the curve of sRGB": any(
            isinstance(surface.material.get("albedo"), dict) for surface in file.surfaces),
        f"the gradient of the background is a picture of {GRADIENT_ROWS} rows": "bottom" in file.background,
    }
    return [text for text, holds in found.items() if holds]


class SceneExport:
    def __init__(self, file: SceneFile, two_sided_lights: bool):
        import pyluxcore

        self.lux = pyluxcore
        self.file = file
        self.scene = pyluxcore.Scene()
        self.materials = {}  # names by the text of the material
        self.objects = 0
        for surface in file.surfaces:
            surface = surface if surface.part else as_triangles(surface, file.camera)
            self._add_mesh(surface)
            if surface.radiance is not None and two_sided_lights:
                surface.part.normals = None
                self._add_mesh(file.reversed_light(surface))
        self._add_background(file.background)

    def _set(self, prefix: str, values: dict):
        properties = self.lux.Properties()
        for key, value in values.items():
            properties.Set(self.lux.Property(f"{prefix}.{key}", value))
        self.scene.Parse(properties)

    def _texture(self, color, name: str):
        if isinstance(color, list):
            return [float(c) for c in color]
        if not self.file.picture(color):
            raise InputError("LuxCore has no checker by world position")
        # Its pictures have v = 0 at the bottom, and gamma 2.2 stands near the curve of sRGB.
        self._set(f"scene.textures.{name}", {
            "type": "imagemap", "file": str(self.file.picture(color)), "colorspace": "luxcore", "gamma": 2.2,
            "mapping.type": "uvmapping2d", "mapping.uvscale": [1.0, -1.0], "mapping.uvdelta": [0.0, 1.0]})
        return name

    def _material(self, material: dict) -> str:
        name = self.materials.setdefault(repr(material), f"material{len(self.materials)}")
        kind = material["type"]
        if kind == "diffuse_light":
            values = {"type": "matte", "kd": BLACK["albedo"],
                      "emission": self._texture(material.get("radiance", [1.0] * 3), name + "_color")}
        elif kind == "lambertian":
            values = {"type": "matte", "kd": self._texture(material.get("albedo", [0.5] * 3), name + "_color")}
        elif kind == "metal" and material.get("fuzz", 0.0) == 0.0:
            values = {"type": "mirror", "kr": self._texture(material.get("albedo", [1.0] * 3), name + "_color")}
        elif kind == "metal":
            albedo = self._texture(material.get("albedo", [1.0] * 3), name + "_color")
            # A reflected ray leans by median 0.866 fuzz in Raylab, by 2 alpha here; alpha is the roughness. The paint's
            # first layer alone, and with all of its light reflected at any angle.
            black = BLACK["albedo"]
            values = {"type": "carpaint", "kd": black, "ka": black, "d": 0.0, "ks1": albedo, "r1": 1.0,
                      "m1": 0.433 * material["fuzz"], "ks2": black, "ks3": black}
        elif kind == "dielectric":
            values = {"type": "glass", "kr": [1.0] * 3, "kt": [1.0] * 3, "exteriorior": 1.0,
                      "interiorior": float(material.get("index", 1.5))}
        else:
            raise InputError(f"material type {kind!r} is not known")
        self._set(f"scene.materials.{name}", values)
        return name

    def _add_mesh(self, surface: Surface):
        part, name = surface.part, f"object{self.objects}"
        self.objects += 1
        arrays = [None if values is None else np.ascontiguousarray(values, dtype=np.float32)
                  for values in (part.positions, part.normals, part.texcoords)]
        positions, normals, texcoords = arrays
        self.scene.DefineMeshExt(name, positions, np.ascontiguousarray(part.triangles, dtype=np.uint32), normals,
                                 None if texcoords is None else [texcoords])
        self._set(f"scene.objects.{name}", {"material": self._material(surface.material), "shape": name})

    def _add_background(self, background: dict):
        if "image" in background:
            raise InputError("background pictures are not exported to LuxCore")
        if "bottom" in background:
            height = np.cos((np.arange(GRADIENT_ROWS) + 0.5) / GRADIENT_ROWS * np.pi)
            up = (0.5 * (height + 1.0))[:, None]
            rows = (1.0 - up) * np.array(background["bottom"]) + up * np.array(background["top"])
            texels = np.repeat(rows[:, None, :], 4, axis=1).astype(np.float32)
            self.scene.DefineImageMap("gradient", texels.ravel(), 1.0, 3, 4, GRADIENT_ROWS)
            # Its zenith is +z, Raylab's +y.
            self._set("scene.lights.sky", {"type": "infinite", "file": "gradient", "transformation": [
                1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1]})
        elif any(background.get("color", [0.0])):
            self._set("scene.lights.sky", {"type": "constantinfinite", "color": background["color"]})

    def set_camera(self, width: int, height: int):
        camera, aspect = self.file.camera, width / height
        lift = 2.0 / height  # a pixel: its rays go through the pixel below the one they count for
        self._set("scene.camera", {
            "type": "perspective", "lookat.orig": [float(x) for x in camera.look_from],
            "lookat.target": [float(x) for x in camera.look_at], "up": [float(x) for x in camera.up],
            "fieldofview": camera.vfov, "screenwindow": [-aspect, aspect, -1.0 - lift, 1.0 - lift],
            "autofocus.enable": False, "lensradius": camera.lens_radius, "focaldistance": camera.focus_distance})


def main():
    command = Command("luxcore", __doc__, ["PATHCPU", "BIDIRCPU", "BIDIRVMCPU"], ["SOBOL", "RANDOM", "METROPOLIS"])
    command.parser.add_argument("--rr-depth", type=positive,
                                help="segments before Russian roulette; the bidirectional engines have none")
    command.parser.add_argument("--light-strategy", choices=["LOG_POWER", "POWER", "UNIFORM"])
    command.parser.add_argument("--one-sided-lights", action=argparse.BooleanOptionalAction,
                                help="no copies of the lights that shine backwards")
    arguments = command.parse()
    try:
        import pyluxcore
    except ImportError as error:
        command.fail(f"LuxCore is not installed (Python package pyluxcore): {error}")
    pyluxcore.Init(lambda message: None)
    atexit.register(pyluxcore.SetLogHandler, None)  # else it calls the handler after Python's end
    if arguments.probe:
        return
    start_up = {"import": command.seconds()}
    with command.telling_errors():
        file = command.read_scene(arguments)
        start_up["read"] = command.seconds()
        scene = SceneExport(file, not arguments.one_sided_lights)
    width, height, depth = arguments.width, arguments.height, arguments.max_depth
    scene.set_camera(width, height)
    start_up["build"] = command.seconds()
    # The roulette of the bidirectional engines is biased: with it mirror-room is brighter by 16%, without as ours.
    rr_depth = NO_ROULETTE if arguments.variant.startswith("BIDIR") else arguments.rr_depth
    settings = {
        "renderengine.type": arguments.variant,
        "sampler.type": arguments.sampler,
        "film.filter.type": "NONE",  # a box of one pixel; BOX of that width blurs what BIDIR splats
        "path.pathdepth.total": depth,
        "path.pathdepth.diffuse": depth,
        "path.pathdepth.glossy": depth,
        "path.pathdepth.specular": depth,
        "path.russianroulette.depth": rr_depth,
        "path.clamping.variance.maxvalue": 0.0,
        "path.maxdepth": depth,
        "light.maxdepth": depth,
        "lightstrategy.type": arguments.light_strategy,
        "batch.haltnoisethreshold": -1.0,
        "film.imagepipelines.0.0.type": "NOP",
        "native.threads.count": arguments.threads,
    }

    def render(seed: int, spp: int):
        properties = pyluxcore.Properties()
        run = {"film.width": width, "film.height": height, "batch.haltspp": spp, "renderengine.seed": seed + 1}
        for key, value in (settings | run).items():
            properties.Set(pyluxcore.Property(key, value))
        session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties, scene.scene))
        began = time.perf_counter()
        session.Start()
        start_up["accelerator"] = time.perf_counter() - began
        watch = Watch()
        while not session.HasDone():
            time.sleep(0.02)  # by so much a render may seem longer
            session.UpdateStats()
        session.Stop()
        seconds, cpu_seconds = watch.stop()
        taken = session.GetStats().Get("stats.renderengine.pass").GetInt()
        picture = np.zeros((height, width, 3), dtype=np.float32)
        session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, picture)
        return Rendered(picture[::-1].astype(np.float64), seconds, cpu_seconds, taken)

    peer = Peer(
        name="luxcore",
        version=pyluxcore.Version(),
        width=width,
        height=height,
        max_depth=depth,
        settings=settings | {"one_sided_lights": arguments.one_sided_lights},
        differences=differences(file, arguments.variant, not arguments.one_sided_lights),
        render=render,
        start_up=start_up,
    )
    command.measure(arguments, peer)


if __name__ == "__main__":
    main()
