"""A Raylab scene as Mitsuba 3 objects in memory.

What is the same: camera, lens, geometry, materials, textures, lights, background, a box filter one pixel wide, the
number of path segments (both count the camera ray). What is not stands in differences().

Mitsuba's emitters shine from the front only, Raylab's from both sides. So an emitter gets a reversed copy behind it.
Half of the light samples then fall on the copy that faces away; `two_sided_lights=False` leaves the copies out where
only fronts are seen.
"""

import mitsuba as mi
import mitsuba_plugins
import numpy as np
from scene_file import BLACK, InputError, SceneFile, Surface

GRADIENT_ROWS = 1025

def differences(file: SceneFile, two_sided_lights: bool) -> list[str]:
    lights = [surface for surface in file.surfaces if surface.radiance is not None]
    metals = [surface for surface in file.surfaces if surface.material.get("fuzz", 0.0) > 0.0]
    smooth = [surface for surface in file.surfaces if surface.part and surface.part.normals is not None]
    found = {
        "lights shine from the front only": lights and not two_sided_lights,
        "a light is two emitters, back to back": lights and two_sided_lights,
        "among emitters each is as likely as the other, in Raylab by power": lights,
        "fuzzy metal is a plugin in Python, which scalar_rgb interprets call by call": metals,
        "where a vertex normal faces away from the viewer the other side is shaded, in Raylab the geometric normal "
        "counts and lets no light through": smooth,
        f"the gradient of the background is a table of {GRADIENT_ROWS} rows": "bottom" in file.background,
        "the background's picture is interpolated, in Raylab the nearest texel counts": "image" in file.background,
    }
    return [text for text, holds in found.items() if holds]


class SceneExport:
    """Makes the mitsuba.Scene of a scene file. The variant must have been set before."""

    def __init__(self, file: SceneFile, two_sided_lights: bool):
        self.file = file
        self.two_sided_lights = two_sided_lights
        self.made = {}  # BSDFs by the text of their material, so that equal ones are shared
        self.objects = {"type": "scene"}

    def scene(self, width: int, height: int, max_depth: int, rr_depth: int, sampler: str) -> mi.Scene:
        mitsuba_plugins.register()
        try:
            for surface in self.file.surfaces:
                self._add_surface(surface, is_reversed=False)
                if surface.radiance is not None and self.two_sided_lights:
                    self._add_surface(self.file.reversed_light(surface), is_reversed=True)
            self._add_background(self.file.background)
        except RuntimeError as error:  # Mitsuba's own: a picture that is missing or damaged
            raise InputError(str(error)) from error
        self.objects["sensor"] = self._sensor(width, height, sampler)
        self.objects["integrator"] = {"type": "path", "max_depth": max_depth, "rr_depth": rr_depth}
        return mi.load_dict(self.objects)

    def _add(self, item):
        self.objects[f"item_{len(self.objects)}"] = item

    # Materials

    def _texture(self, color) -> dict:
        if isinstance(color, list):
            return {"type": "rgb", "value": [float(c) for c in color]}
        if self.file.picture(color):
            return {
                "type": "bitmap",
                "filename": str(self.file.picture(color)),
                "filter_type": "bilinear",
                "wrap_mode": "repeat",
                "format": "variant",  # else 8-bit pictures are kept in half precision
            }
        return {
            "type": mitsuba_plugins.CHECKER,
            "size": float(color["checker"]),
            "even": self._texture(color["even"]),
            "odd": self._texture(color["odd"]),
        }

    def _bsdf(self, material: dict) -> mi.BSDF:
        key = repr(material)
        if key not in self.made:
            self.made[key] = mi.load_dict(self._bsdf_dict(material))
        return self.made[key]

    def _bsdf_dict(self, material: dict) -> dict:
        kind = material["type"]
        if kind == "lambertian":
            return _both_sides({"type": "diffuse", "reflectance": self._texture(material.get("albedo", [0.5] * 3))})
        if kind == "metal":
            albedo = self._texture(material.get("albedo", [1.0] * 3))
            fuzz = float(material.get("fuzz", 0.0))
            if fuzz > 0.0:
                return {"type": mitsuba_plugins.METAL, "albedo": albedo, "fuzz": fuzz}
            return _both_sides({"type": "conductor", "material": "none", "specular_reflectance": albedo})
        if kind == "dielectric":
            return {"type": "dielectric", "int_ior": float(material.get("index", 1.5)), "ext_ior": 1.0}
        if kind == "diffuse_light":
            return self._bsdf_dict(BLACK)
        raise InputError(f"material type {kind!r} is not known")

    # Shapes

    def _add_surface(self, surface: Surface, is_reversed: bool):
        emitter = None if surface.radiance is None else {"type": "area", "radiance": self._texture(surface.radiance)}
        if surface.part:
            self._add_part(surface, emitter)
        else:
            self._add_ball(surface, emitter, is_reversed)

    def _add_part(self, surface: Surface, emitter: dict | None):
        part = surface.part
        properties = mi.Properties()
        properties["bsdf"] = self._bsdf(surface.material)
        if emitter is not None:
            properties["emitter"] = mi.load_dict(emitter)
        mesh = mi.Mesh(
            part.material or "mesh",
            len(part.positions),
            len(part.triangles),
            properties,
            has_vertex_normals=part.normals is not None,
            has_vertex_texcoords=part.texcoords is not None,
        )
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = part.positions.astype(np.float32).ravel()
        parameters["faces"] = part.triangles.astype(np.uint32).ravel()
        if part.texcoords is not None:
            # Mitsuba's pictures have v = 0 at the top.
            flipped = part.texcoords * [1.0, -1.0] + [0.0, 1.0]
            parameters["vertex_texcoords"] = flipped.astype(np.float32).ravel()
        if part.normals is not None:
            parameters["vertex_normals"] = part.normals.astype(np.float32).ravel()
        parameters.update()
        self._add(mesh)

    def _add_ball(self, surface: Surface, emitter: dict | None, flip_normals: bool):
        # Mitsuba's texture coordinates turn around z from +x; here around y from -x.
        (x, y, z), radius = surface.center, surface.radius
        turned = np.array([[-radius, 0, 0, x], [0, 0, radius, y], [0, radius, 0, z], [0, 0, 0, 1]])
        ball = {
            "type": "sphere",
            "to_world": mi.ScalarTransform4f(turned),
            "flip_normals": flip_normals,
            "bsdf": self._bsdf(surface.material),
        }
        if emitter is not None:
            ball["emitter"] = emitter
        self._add(ball)

    # Background and camera

    def _add_background(self, background: dict):
        if self.file.picture(background):
            texels = np.array(mi.Bitmap(str(self.file.picture(background))).convert(
                mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False))
            self._add({"type": "envmap", "bitmap": mi.Bitmap(_on_envmap_grid(texels))})
        elif "bottom" in background:
            height = np.cos(np.linspace(0.0, np.pi, GRADIENT_ROWS))
            up = (0.5 * (height + 1.0))[:, None, None]
            rows = (1.0 - up) * np.array(background["bottom"]) + up * np.array(background["top"])
            self._add({"type": "envmap", "bitmap": mi.Bitmap(np.repeat(rows, 4, axis=1).astype(np.float32))})
        elif any(background.get("color", [0.0])):
            self._add({"type": "constant", "radiance": self._texture(background["color"])})

    def _sensor(self, width: int, height: int, sampler: str) -> dict:
        camera = self.file.camera
        distance = float(np.linalg.norm(np.subtract(camera.look_at, camera.look_from)))
        sensor = {
            "type": "perspective",
            "fov": camera.vfov,
            "fov_axis": "y",
            "near_clip": 1e-4 * distance,
            "far_clip": 1e5 * distance,
            "to_world": mi.ScalarTransform4f().look_at(
                origin=camera.look_from, target=camera.look_at, up=camera.up),
            "film": {
                "type": "hdrfilm",
                "width": width,
                "height": height,
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": sampler},
        }
        if camera.lens_radius > 0.0:
            sensor["type"] = "thinlens"
            sensor["focus_distance"] = camera.focus_distance
            sensor["aperture_radius"] = camera.lens_radius
        return sensor


def _both_sides(bsdf: dict) -> dict:
    return {"type": "twosided", "bsdf": bsdf}


def _on_envmap_grid(texels: np.ndarray) -> np.ndarray:
    """Mitsuba's envmap has its first and last row at the poles, Raylab's picture has texels of equal height; and the
    middle of Raylab's picture looks along -z, Mitsuba's along +z. Fine enough that interpolation changes little."""
    height, width = texels.shape[:2]
    finer = max(2, min(32, 8192 // width))
    # Rows of the grid lie on the texels' borders too: there the mean of both keeps the border in its place.
    position = np.arange(finer * height + 1) / finer
    above = np.maximum(np.ceil(position).astype(int) - 1, 0)
    below = np.minimum(np.floor(position).astype(int), height - 1)
    rows = 0.5 * (texels[above] + texels[below])
    columns = np.roll(np.repeat(np.arange(width), finer), finer * width // 2)
    return np.ascontiguousarray(rows[:, columns], dtype=np.float32)
