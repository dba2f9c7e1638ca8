"""OBJ and MTL files as Raylab reads them, for peers that have other conventions.

Numbers are as in the file: texture coordinates with v upwards, colours linear.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


class InputError(Exception):
    """A file that cannot be exported, and where."""


@dataclass
class Part:
    """The triangles of one OBJ file that share a material and have the same attributes."""

    material: str | None  # as in usemtl; None: the file names none
    positions: np.ndarray  # (vertices, 3)
    texcoords: np.ndarray | None  # (vertices, 2)
    normals: np.ndarray | None  # (vertices, 3)
    triangles: np.ndarray  # (triangles, 3) into the arrays above


@dataclass
class ObjFile:
    parts: list[Part] = field(default_factory=list)
    libraries: list[Path] = field(default_factory=list)


def read_obj(file: Path) -> ObjFile:
    values = {"v": [], "vt": [], "vn": []}
    lengths = {"v": 3, "vt": 2, "vn": 3}
    corners_of = {}  # (material, has texcoords, has normals): list of (v, vt, vn), three a triangle
    obj = ObjFile()
    material = None
    with open(file, encoding="utf-8", errors="replace") as lines:
        for number, line in enumerate(lines, 1):
            words = line.split()
            if not words or words[0].startswith("#"):
                continue
            keyword = words[0]
            if keyword in values:
                values[keyword].append([float(word) for word in words[1 : 1 + lengths[keyword]]])
            elif keyword == "f":
                counts = [len(values[key]) for key in ("v", "vt", "vn")]
                polygon = [_corner(word, counts) for word in words[1:]]
                if len(polygon) > 3 and not _is_convex([values["v"][corner[0]] for corner in polygon]):
                    raise InputError(f"{file}:{number}: a polygon that is not convex")
                key = (material, polygon[0][1] >= 0, polygon[0][2] >= 0)
                corners = corners_of.setdefault(key, [])
                for i in range(1, len(polygon) - 1):
                    corners += (polygon[0], polygon[i], polygon[i + 1])
            elif keyword == "usemtl":
                material = line.split(maxsplit=1)[1].strip()
            elif keyword == "mtllib":
                obj.libraries.append(file.parent / line.split(maxsplit=1)[1].strip())
    arrays = [np.array(values[key], dtype=np.float64).reshape(-1, lengths[key]) for key in ("v", "vt", "vn")]
    obj.parts = [_part(key, np.array(corners, dtype=np.int64), arrays) for key, corners in corners_of.items()]
    return obj


def _corner(word: str, counts: list[int]) -> tuple[int, int, int]:
    """Indices from 0 of position, texture coordinate and normal; -1 where absent."""
    fields = (word.split("/") + ["", ""])[:3]
    indices = []
    for text, count in zip(fields, counts):
        index = int(text) if text else 0
        indices.append(index - 1 if index >= 0 else count + index)
    return tuple(indices)


def _is_convex(points: list[list[float]]) -> bool:
    p = np.array(points)
    edges = np.roll(p, -1, axis=0) - p
    turns = np.cross(edges, np.roll(edges, -1, axis=0))
    return bool((turns @ turns.sum(axis=0) >= 0.0).all())


def _part(key, corners: np.ndarray, arrays: list[np.ndarray]) -> Part:
    material, has_texcoords, has_normals = key
    positions, texcoords, normals = arrays
    # A vertex is a combination that occurs, so that what the file shares stays shared.
    code = (corners[:, 0] * (len(texcoords) + 1) + corners[:, 1] + 1) * (len(normals) + 1) + corners[:, 2] + 1
    _, first, triangles = np.unique(code, return_index=True, return_inverse=True)
    vertices = corners[first]
    return Part(
        material=material,
        positions=positions[vertices[:, 0]],
        texcoords=texcoords[vertices[:, 1]] if has_texcoords else None,
        normals=normals[vertices[:, 2]] if has_normals else None,
        triangles=triangles.reshape(-1, 3),
    )


def read_mtl(file: Path) -> dict[str, dict]:
    """Materials by name, in the words of a scene file's [material.NAME] tables."""
    statements = {}
    current = {}
    for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        rest = line.split(maxsplit=1)[1].strip() if len(words) > 1 else ""
        if words[0] == "newmtl":
            current = statements.setdefault(rest, {})
        else:
            current[words[0]] = rest
    return {name: _material(name, values, file) for name, values in statements.items()}


def _material(name: str, statements: dict[str, str], file: Path) -> dict:
    def color(key, otherwise):
        return [float(word) for word in statements[key].split()[:3]] if key in statements else otherwise

    illum = int(statements.get("illum", "2"))
    if illum == 3:
        shininess = min(max(float(statements.get("Ns", "1000")), 0.0), 1000.0)
        return {"type": "metal", "albedo": color("Ks", [1.0] * 3), "fuzz": 1.0 - shininess / 1000.0}
    if illum == 6:
        return {"type": "dielectric", "index": float(statements.get("Ni", "1.5"))}
    emission = color("Ke", [0.0] * 3)
    if any(emission):
        return {"type": "diffuse_light", "radiance": emission}
    if "map_Kd" in statements:
        if statements["map_Kd"].startswith("-"):
            raise InputError(f"{file}: material {name}: map_Kd with options")
        return {"type": "lambertian", "albedo": {"image": str(file.parent / statements["map_Kd"])}}
    return {"type": "lambertian", "albedo": color("Kd", [0.5] * 3)}
