"""A Raylab scene file as Mitsuba 3 objects in memory.

What is the same: camera, lens, geometry, materials, textures, lights, background, a box filter one pixel wide, the
number of path segments (both count the camera ray). What Mitsuba does in its own way:

- Its emitters shine from the front only, Raylab's from both sides. So an emitter gets a reversed copy behind it, at
  1e-5 of the largest coordinate of the emitter or the camera: more than float rounding, less than a picture shows.
  Half of the light samples then fall on the copy that faces away; `two_sided_lights=False` leaves the copies out
  where only fronts are seen.
- It chooses among emitters with equal probability, Raylab by power.
- It interpolates environment pictures, Raylab takes the nearest texel. A gradient is tabulated (1,025 rows).
- Fuzzy metal and checkers by world position are plugins of ours (mitsuba_plugins.py).
- Where an interpolated normal faces away from the viewer, Mitsuba shades the surface's other side; Raylab takes the
  geometric normal instead and lets no light through. On smooth meshes the outlines differ by a little.
"""

import tomllib
from pathlib import Path

import mitsuba as mi
import mitsuba_plugins
import numpy as np
from wavefront import InputError, Part, read_mtl, read_obj

GRADIENT_ROWS = 1025
LIGHT_COPY_OFFSET = 1e-5


def load_description(file: Path) -> dict:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{file}: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: {error}") from error


class SceneExport:
    """Makes the mitsuba.Scene of a scene file. The variant must have been set before."""

    def __init__(self, file: Path, description: dict, two_sided_lights: bool = True):
        self.folder = file.resolve().parent
        self.description = description
        self.two_sided_lights = two_sided_lights
        self.materials = description.get("material", {})
        self.made = {}  # BSDFs by the text of their material, so that equal ones are shared
        self.objects = {"type": "scene"}

    def scene(self, width: int, height: int, max_depth: int, rr_depth: int) -> mi.Scene:
        mitsuba_plugins.register()
        try:
            for mesh in self.description.get("mesh", []):
                self._add_mesh(mesh)
            for sphere in self.description.get("sphere", []):
                self._add_sphere(sphere)
            self._add_background(self.description.get("background", {}))
        except KeyError as error:
            raise InputError(f"no {error} in the scene file or a file that it names") from error
        except OSError as error:
            raise InputError(f"{error.filename}: {error.strerror}") from error
        except RuntimeError as error:  # Mitsuba's own: a picture that is missing or damaged
            raise InputError(str(error)) from error
        self.objects["sensor"] = self._sensor(width, height)
        self.objects["integrator"] = {"type": "path", "max_depth": max_depth, "rr_depth": rr_depth}
        return mi.load_dict(self.objects)

    def _add(self, item):
        self.objects[f"item_{len(self.objects)}"] = item

    # Materials

    def _texture(self, color) -> dict:
        if isinstance(color, list):
            return {"type": "rgb", "value": [float(c) for c in color]}
        if "image" in color:
            return {
                "type": "bitmap",
                "filename": str(self.folder / color["image"]),
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
            return _both_sides({"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}})
        raise InputError(f"material type {kind!r} is not known")

    def _emitter(self, material: dict) -> dict | None:
        if material["type"] != "diffuse_light":
            return None
        return {"type": "area", "radiance": self._texture(material.get("radiance", [1.0] * 3))}

    def _copy_offset(self, positions: np.ndarray) -> float:
        camera = self.description.get("camera", {}).get("look_from", [0, 0, 0])
        return LIGHT_COPY_OFFSET * max(np.abs(positions).max(), np.abs(camera).max())

    # Shapes

    def _add_mesh(self, entry: dict):
        file = self.folder / entry["obj"]
        obj = read_obj(file)
        if "material" in entry:
            named = {part.material: self.materials[entry["material"]] for part in obj.parts}
        else:
            named = {None: {"type": "lambertian"}}
            for library in obj.libraries:
                named.update(read_mtl(library))
        for part in obj.parts:
            _place(part, entry)
            material = named[part.material]
            emitter = self._emitter(material)
            if emitter is not None:
                part.normals = None
            self._add_part(part, material, emitter)
            if emitter is not None and self.two_sided_lights:
                self._add_part(_reversed(part, self._copy_offset(part.positions)), material, emitter)

    def _add_part(self, part: Part, material: dict, emitter: dict | None):
        properties = mi.Properties()
        properties["bsdf"] = self._bsdf(material)
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

    def _add_sphere(self, entry: dict):
        material = self.materials[entry["material"]]
        center = np.array(entry["center"], dtype=float)
        radius = float(entry["radius"])
        emitter = self._emitter(material)
        self._add_ball(center, radius, material, emitter, flip_normals=False)
        if emitter is not None and self.two_sided_lights:
            inner = radius - self._copy_offset(center + radius)
            self._add_ball(center, inner, material, emitter, flip_normals=True)

    def _add_ball(self, center, radius: float, material: dict, emitter: dict | None, flip_normals: bool):
        # Mitsuba's texture coordinates turn around z from +x; here around y from -x.
        x, y, z = center
        turned = np.array([[-radius, 0, 0, x], [0, 0, radius, y], [0, radius, 0, z], [0, 0, 0, 1]])
        ball = {
            "type": "sphere",
            "to_world": mi.ScalarTransform4f(turned),
            "flip_normals": flip_normals,
            "bsdf": self._bsdf(material),
        }
        if emitter is not None:
            ball["emitter"] = emitter
        self._add(ball)

    # Background and camera

    def _add_background(self, background: dict):
        if "image" in background:
            texels = np.array(mi.Bitmap(str(self.folder / background["image"])).convert(
                mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False))
            self._add({"type": "envmap", "bitmap": mi.Bitmap(_on_envmap_grid(texels))})
        elif "bottom" in background:
            height = np.cos(np.linspace(0.0, np.pi, GRADIENT_ROWS))
            up = (0.5 * (height + 1.0))[:, None, None]
            rows = (1.0 - up) * np.array(background["bottom"]) + up * np.array(background["top"])
            self._add({"type": "envmap", "bitmap": mi.Bitmap(np.repeat(rows, 4, axis=1).astype(np.float32))})
        elif any(background.get("color", [0.0])):
            self._add({"type": "constant", "radiance": self._texture(background["color"])})

    def _sensor(self, width: int, height: int) -> dict:
        camera = self.description.get("camera", {})
        origin = camera.get("look_from", [0, 0, 0])
        target = camera.get("look_at", [0, 0, -1])
        distance = float(np.linalg.norm(np.subtract(target, origin)))
        sensor = {
            "type": "perspective",
            "fov": float(camera.get("vfov", 90.0)),
            "fov_axis": "y",
            "near_clip": 1e-4 * distance,
            "far_clip": 1e5 * distance,
            "to_world": mi.ScalarTransform4f().look_at(origin=origin, target=target, up=camera.get("up", [0, 1, 0])),
            "film": {
                "type": "hdrfilm",
                "width": width,
                "height": height,
                "pixel_format": "rgb",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        }
        angle = float(camera.get("defocus_angle", 0.0))
        if angle > 0.0:
            sensor["type"] = "thinlens"
            sensor["focus_distance"] = float(camera.get("focus_distance", 10.0))
            sensor["aperture_radius"] = sensor["focus_distance"] * float(np.tan(np.radians(0.5 * angle)))
        return sensor


def _both_sides(bsdf: dict) -> dict:
    return {"type": "twosided", "bsdf": bsdf}


def _place(part: Part, entry: dict):
    angle = np.radians(float(entry.get("rotate_y", 0.0)))
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    part.positions = part.positions @ turn.T * float(entry.get("scale", 1.0)) + entry.get("translate", [0.0] * 3)
    if part.normals is not None:
        part.normals = part.normals @ turn.T


def _reversed(part: Part, offset: float) -> Part:
    """The triangles from behind, each moved by offset against its normal."""
    corners = part.positions[part.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    moved = corners - offset * normals[:, None, :]
    return Part(
        material=part.material,
        positions=moved.reshape(-1, 3),
        texcoords=None if part.texcoords is None else part.texcoords[part.triangles].reshape(-1, 2),
        normals=None,
        triangles=np.arange(3 * len(corners)).reshape(-1, 3)[:, ::-1],
    )


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
