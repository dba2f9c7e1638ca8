"""A Raylab scene file as the peers need it: materials looked up, meshes read and placed.

The reader shares no code with Raylab's own, so that an error in either shows. What a peer cannot express it refuses
by InputError, or names among its differences.
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from wavefront import InputError, Part, read_mtl, read_obj

VERSION = 1  # of the format of scene files; those that name none are of the first
LIGHT_COPY_OFFSET = 1e-5
BLACK = {"type": "lambertian", "albedo": [0.0] * 3}


@dataclass
class Camera:
    look_from: list[float]
    look_at: list[float]
    up: list[float]
    vfov: float  # degrees
    focus_distance: float
    lens_radius: float  # 0: a pinhole


@dataclass
class Surface:
    """Triangles of one material, or a sphere."""

    material: dict
    part: Part | None = None
    center: list[float] | None = None
    radius: float = 0.0

    @property
    def radiance(self):
        """Of a light, else None."""
        return self.material.get("radiance", [1.0] * 3) if self.material["type"] == "diffuse_light" else None


class SceneFile:
    def __init__(self, file: Path):
        try:
            description = tomllib.loads(file.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(f"{file}: {error.strerror}") from error
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise InputError(f"{file}: {error}") from error
        if (version := description.get("version", VERSION)) not in range(1, VERSION + 1):
            raise InputError(f"{file}: version: found {version}, and this program reads {VERSION}")
        self.name = file.stem
        self.folder = file.resolve().parent
        settings = description.get("render", {})
        self.width, self.height = int(settings.get("width", 800)), int(settings.get("height", 800))
        self.samples_per_pixel = int(settings.get("samples_per_pixel", 64))
        self.max_depth = int(settings.get("max_depth", 7))
        self.background = description.get("background", {})
        self.camera = _camera(description.get("camera", {}))
        self.materials = description.get("material", {})
        self.surfaces = []
        try:
            for entry in description.get("mesh", []):
                self._add_mesh(entry)
            for entry in description.get("sphere", []):
                material = self.materials[entry["material"]]
                self.surfaces.append(Surface(material, center=entry["center"], radius=float(entry["radius"])))
        except KeyError as error:
            raise InputError(f"no {error} in the scene file or a file that it names") from error
        except OSError as error:
            raise InputError(f"{error.filename}: {error.strerror}") from error

    def _add_mesh(self, entry: dict):
        obj = read_obj(self.folder / entry["obj"])
        if "material" in entry:
            named = {part.material: self.materials[entry["material"]] for part in obj.parts}
        else:
            named = {None: {"type": "lambertian"}}
            for library in obj.libraries:
                named.update(read_mtl(library))
        for part in obj.parts:
            _place(part, entry)
            surface = Surface(named[part.material], part)
            if surface.radiance is not None:
                part.normals = None
            self.surfaces.append(surface)

    def picture(self, color) -> Path | None:
        """The file of a colour that is a picture; None: it is a constant or a checker."""
        return self.folder / color["image"] if "image" in color else None

    def picture_size(self, width: int | None, height: int | None) -> tuple[int, int]:
        """What is not given keeps the scene's aspect ratio."""
        if width and not height:
            return width, max(1, int(width * self.height / self.width + 0.5))
        if height and not width:
            return max(1, int(height * self.width / self.height + 0.5)), height
        return width or self.width, height or self.height

    def reversed_light(self, light: Surface) -> Surface:
        """A light that shines backwards, behind one that shines from its front only. Its distance is 1e-5 of the
        largest coordinate of light or camera: more than float rounding, less than a picture shows."""
        extent = light.part.positions if light.part else np.add(light.center, light.radius)
        offset = LIGHT_COPY_OFFSET * max(np.abs(extent).max(), np.abs(self.camera.look_from).max())
        if light.part:
            return Surface(light.material, _reversed(light.part, offset))
        return Surface(light.material, center=light.center, radius=light.radius - offset)


def _camera(values: dict) -> Camera:
    focus_distance = float(values.get("focus_distance", 10.0))
    return Camera(
        look_from=values.get("look_from", [0, 0, 0]),
        look_at=values.get("look_at", [0, 0, -1]),
        up=values.get("up", [0, 1, 0]),
        vfov=float(values.get("vfov", 90.0)),
        focus_distance=focus_distance,
        lens_radius=focus_distance * float(np.tan(np.radians(0.5 * values.get("defocus_angle", 0.0)))),
    )


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


def as_triangles(sphere: Surface, camera: Camera) -> Surface:
    """For peers that have no spheres: smooth rings around an axis, for a ball larger than the view around the axis
    that points to what is looked at, and finer towards it. The radius is a little larger, so that the silhouette has
    the ball's area."""
    center = np.array(sphere.center, dtype=float)
    if abs(sphere.radius) > np.linalg.norm(np.subtract(camera.look_at, camera.look_from)):
        sectors, angles = 512, np.concatenate([[0.0], np.geomspace(1e-4, np.pi, 840)])
        y = (camera.look_at - center) / np.linalg.norm(camera.look_at - center)
        x = np.cross(y, np.eye(3)[np.argmin(np.abs(y))])
        x /= np.linalg.norm(x)
    else:
        sectors, angles = 64, np.linspace(0.0, np.pi, 33)
        x, y = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    z = np.cross(x, y)
    turn = np.linspace(0.0, 2.0 * np.pi, sectors + 1)
    polar, azimuth = (grid.ravel()[:, None] for grid in np.meshgrid(angles, turn, indexing="ij"))
    normals = np.sin(polar) * (np.cos(azimuth) * x - np.sin(azimuth) * z) + np.cos(polar) * y
    radius = sphere.radius * (1.0 + (2.0 * np.pi / sectors) ** 2 / 12.0 if sectors == 64 else 1.0)
    corner = np.arange(len(angles) - 1)[:, None] * (sectors + 1) + np.arange(sectors)
    a, b, c, d = (corner + step for step in (0, 1, sectors + 2, sectors + 1))
    part = Part(
        material=None,
        positions=center + radius * normals,
        texcoords=np.hstack([azimuth / (2.0 * np.pi), 1.0 - polar / np.pi]),
        normals=normals,
        triangles=np.stack([a, c, b, a, d, c], axis=-1).reshape(-1, 3),
    )
    # At the poles two corners of every other triangle coincide.
    p = part.positions[part.triangles]
    part.triangles = part.triangles[np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) > 0.0]
    return Surface(sphere.material, part)
