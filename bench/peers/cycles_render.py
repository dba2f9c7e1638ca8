#!/usr/bin/env python3
"""Render a Raylab scene with Cycles, Blender's path tracer, and time it.

    bench/peers/cycles_render.py scenes/cornell.toml --width 400 --spp 64 --json cornell.json

Needs the Python package bpy. Blender's start, reading the scene, copying it into Cycles and building its accelerator
are not in the times. differences() says where the two renderers differ.
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
from peer import Command, Peer, Rendered, Watch
import numpy as np  # after peer, which says in one line that it is missing
from scene_file import BLACK, InputError, SceneFile, Surface, as_triangles


def differences(file: SceneFile) -> list[str]:
    metals = [surface for surface in file.surfaces if surface.material.get("fuzz", 0.0) > 0.0]
    found = {
        "spheres that are glass, lights or have pictures are triangles with smooth normals":
            any(not surface.part and not is_point(surface) for surface in file.surfaces),
        "fuzzy metal is a Beckmann lobe of the same mean square width": metals,
        "Russian roulette begins when it likes to": True,
    }
    return [text for text, holds in found.items() if holds]


def is_point(surface: Surface) -> bool:
    """Whether a point of Cycles can be the sphere: points are seen from outside only, are no lights and have no
    texture coordinates."""
    return surface.material["type"] in ("lambertian", "metal") and isinstance(surface.material.get("albedo", []), list)


class SceneExport:
    def __init__(self, file: SceneFile, arguments):
        import bpy

        self.bpy = bpy
        self.file = file
        self.emission_sampling = arguments.emission_sampling
        self.materials = {}  # by the text of the material
        for entry in list(bpy.data.objects):
            bpy.data.objects.remove(entry)
        points = {}  # spheres by the text of their material
        for surface in file.surfaces:
            if surface.part:
                self._add_mesh(surface)
            elif is_point(surface):
                points.setdefault(repr(surface.material), []).append(surface)
            else:
                self._add_mesh(as_triangles(surface, file.camera))
        for surfaces in points.values():
            self._add_points(surfaces)
        self._set_background(file.background, arguments.background_sampling)

    def _color(self, tree, socket, color):
        if isinstance(color, list):
            socket.default_value = [*color, 1.0]
            return
        if not self.file.picture(color):
            raise InputError("checkers by world position are not exported to Cycles")
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = self.bpy.data.images.load(str(self.file.picture(color)), check_existing=True)
        tree.links.new(node.outputs["Color"], socket)

    def _material(self, material: dict):
        key = repr(material)
        if key in self.materials:
            return self.materials[key]
        made = self.materials[key] = self.bpy.data.materials.new(f"material{len(self.materials)}")
        tree = made.node_tree
        tree.nodes.clear()
        kind = material["type"]
        if kind == "diffuse_light":
            node = tree.nodes.new("ShaderNodeEmission")
            node.inputs["Strength"].default_value = 1.0
            self._color(tree, node.inputs["Color"], material.get("radiance", [1.0] * 3))
            made.cycles.emission_sampling = self.emission_sampling
        elif kind == "lambertian":
            node = tree.nodes.new("ShaderNodeBsdfDiffuse")
            self._color(tree, node.inputs["Color"], material.get("albedo", [0.5] * 3))
        elif kind == "metal":
            node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
            node.distribution = "BECKMANN"
            # A reflected ray leans by fuzz² 2/3 in the mean square in Raylab, by 4 alpha² here; the roughness is the
            # root of alpha.
            node.inputs["Roughness"].default_value = (material.get("fuzz", 0.0) / 6.0**0.5) ** 0.5
            self._color(tree, node.inputs["Color"], material.get("albedo", [1.0] * 3))
        elif kind == "dielectric":
            node = tree.nodes.new("ShaderNodeBsdfGlass")
            node.distribution = "BECKMANN"
            node.inputs["Roughness"].default_value = 0.0
            node.inputs["Color"].default_value = [1.0] * 4
            node.inputs["IOR"].default_value = float(material.get("index", 1.5))
        else:
            raise InputError(f"material type {kind!r} is not known")
        tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        return made

    def _add(self, data, material: dict):
        data.materials.append(self._material(material))
        entry = self.bpy.data.objects.new(data.name, data)
        entry.shadow_terminator_geometry_offset = 0.0  # which moves shadow rays of smooth meshes
        self.bpy.context.scene.collection.objects.link(entry)

    def _add_mesh(self, surface: Surface):
        part = surface.part
        mesh = self.bpy.data.meshes.new("mesh")
        corners = part.triangles.astype(np.int32).ravel()
        mesh.vertices.add(len(part.positions))
        mesh.vertices.foreach_set("co", part.positions.astype(np.float32).ravel())
        mesh.loops.add(len(corners))
        mesh.loops.foreach_set("vertex_index", corners)
        mesh.polygons.add(len(part.triangles))
        mesh.polygons.foreach_set("loop_start", np.arange(0, len(corners), 3, dtype=np.int32))
        if part.texcoords is not None:
            mesh.uv_layers.new().uv.foreach_set("vector", part.texcoords[corners].astype(np.float32).ravel())
        mesh.update(calc_edges=True)
        mesh.polygons.foreach_set("use_smooth", np.full(len(part.triangles), part.normals is not None))
        if part.normals is not None:
            normals = mesh.attributes.new("custom_normal", "FLOAT_VECTOR", "POINT")
            normals.data.foreach_set("vector", part.normals.astype(np.float32).ravel())
        self._add(mesh, surface.material)

    def _add_points(self, surfaces: list[Surface]):
        points = self.bpy.data.pointclouds.new("points")
        points.resize(len(surfaces))
        centers = np.array([surface.center for surface in surfaces], dtype=np.float32)
        points.attributes["position"].data.foreach_set("vector", centers.ravel())
        radii = points.attributes.get("radius") or points.attributes.new("radius", "FLOAT", "POINT")
        radii.data.foreach_set("value", np.array([abs(surface.radius) for surface in surfaces], dtype=np.float32))
        self._add(points, surfaces[0].material)

    def _set_background(self, background: dict, sampling: str):
        if "image" in background:
            raise InputError("background pictures are not exported to Cycles")
        world = self.bpy.context.scene.world = self.bpy.data.worlds.new("background")
        world.cycles.sampling_method = sampling
        tree = world.node_tree
        tree.nodes.clear()
        light = tree.nodes.new("ShaderNodeBackground")
        light.inputs["Color"].default_value = [*background.get("color", [0.0] * 3), 1.0]
        if "bottom" in background:
            # bottom + (direction.y / 2 + 1 / 2) (top - bottom)
            split = tree.nodes.new("ShaderNodeSeparateXYZ")
            mixed = tree.nodes.new("ShaderNodeVectorMath")
            mixed.operation = "MULTIPLY_ADD"
            bottom, top = background["bottom"], background["top"]
            mixed.inputs[1].default_value = [0.5 * (t - b) for b, t in zip(bottom, top)]
            mixed.inputs[2].default_value = [0.5 * (t + b) for b, t in zip(bottom, top)]
            tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], split.inputs[0])
            tree.links.new(split.outputs["Y"], mixed.inputs[0])
            tree.links.new(mixed.outputs[0], light.inputs["Color"])
        tree.links.new(light.outputs[0], tree.nodes.new("ShaderNodeOutputWorld").inputs["Surface"])

    def set_camera(self):
        import mathutils
        camera = self.file.camera
        backward = np.subtract(camera.look_from, camera.look_at).astype(float)
        backward /= np.linalg.norm(backward)
        right = np.cross(camera.up, backward)
        right /= np.linalg.norm(right)
        axes = np.stack([right, np.cross(backward, right), backward, np.array(camera.look_from, dtype=float)], axis=1)
        data = self.bpy.data.cameras.new("camera")
        data.sensor_fit = "VERTICAL"
        data.angle = np.radians(camera.vfov)
        distance = float(np.linalg.norm(np.subtract(camera.look_from, camera.look_at)))
        data.clip_start, data.clip_end = 1e-4 * distance, 1e5 * distance
        if camera.lens_radius > 0.0:
            data.dof.use_dof = True
            data.dof.focus_distance = camera.focus_distance
            data.dof.aperture_fstop = data.lens * 1e-3 / (2.0 * camera.lens_radius)
        entry = self.bpy.data.objects.new("camera", data)
        entry.matrix_world = mathutils.Matrix([*axes.tolist(), [0.0, 0.0, 0.0, 1.0]])
        self.bpy.context.scene.collection.objects.link(entry)
        self.bpy.context.scene.camera = entry


def main():
    command = Command("cycles", __doc__, ["CPU"], ["TABULATED_SOBOL", "BLUE_NOISE"])
    add = command.parser.add_argument
    add("--rr-depth", type=int, help="bounces before Russian roulette may begin (min_light_bounces)")
    add("--emission-sampling", choices=["NONE", "AUTO", "FRONT", "BACK", "FRONT_BACK"],
        help="sides of a light that are sampled as such; all shine")
    add("--background-sampling", choices=["NONE", "AUTOMATIC"], help="whether the background is sampled as a light")
    add("--light-tree", action=argparse.BooleanOptionalAction)
    add("--guiding", action=argparse.BooleanOptionalAction, help="path guiding")
    arguments = command.parse()
    try:
        import bpy
    except ImportError as error:
        command.fail(f"Cycles is not installed (Python package bpy): {error}")
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    if arguments.probe:
        return
    start_up = {"import": command.seconds()}
    with command.telling_errors():
        file = command.read_scene(arguments)
        start_up["read"] = command.seconds()
        exporter = SceneExport(file, arguments)
    exporter.set_camera()
    width, height, depth = arguments.width, arguments.height, arguments.max_depth
    bounces = max(0, depth - 2)  # the last segment that finds a light does not count
    settings = {
        "device": "CPU",
        "sampling_pattern": arguments.sampler,
        "use_light_tree": arguments.light_tree,
        "use_guiding": arguments.guiding,
        "min_light_bounces": arguments.rr_depth,
        "max_bounces": bounces,
        "diffuse_bounces": bounces,
        "glossy_bounces": bounces,
        "transmission_bounces": bounces,
        "light_sampling_threshold": 0.0,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,
        "blur_glossy": 0.0,
        "caustics_reflective": True,
        "caustics_refractive": True,
        "pixel_filter_type": "BOX",
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "use_auto_tile": False,
    }
    for name, value in settings.items():
        setattr(scene.cycles, name, value)
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", arguments.threads
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    start_up["build"] = command.seconds()

    def render(seed: int, spp: int) -> Rendered:
        scene.cycles.seed, scene.cycles.samples = seed, spp
        with tempfile.TemporaryDirectory() as folder:
            scene.render.filepath = str(Path(folder) / "picture.exr")
            whole, sampling, spent = Watch(), [], []

            def follow(text, _=None):
                if "Sample 0/" in text and not sampling:
                    sampling.append(Watch())
                    start_up["copy_and_accelerator"] = whole.stop()[0]
                elif text.endswith("Finished") and sampling and not spent:
                    spent.extend(sampling[0].stop())

            bpy.app.handlers.render_stats.append(follow)
            bpy.ops.render.render(write_still=True)
            bpy.app.handlers.render_stats.remove(follow)
            picture = bpy.data.images.load(scene.render.filepath)
            values = np.empty(width * height * 4, dtype=np.float32)
            picture.pixels.foreach_get(values)
            bpy.data.images.remove(picture)
        rgb = values.reshape(height, width, 4)[::-1, :, :3].astype(np.float64)
        return Rendered(rgb, *spent, spp)

    peer = Peer(
        name="cycles",
        version=bpy.app.version_string,
        width=width,
        height=height,
        max_depth=depth,
        settings=settings | {"emission_sampling": arguments.emission_sampling,
                             "background_sampling": arguments.background_sampling},
        differences=differences(file),
        render=render,
        start_up=start_up,
    )
    command.measure(arguments, peer)


if __name__ == "__main__":
    main()
