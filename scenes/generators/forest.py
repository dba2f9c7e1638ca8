"""A low-poly forest by a lake, lit by the sky alone."""

import math
import random

from . import png
from .obj import Obj
from .shapes import circle, loop, prism

TOML = """\
# A low-poly forest: flat normals, one palette texture, light from the sky alone. Made by generate.py.

[camera]
look_from = [6, 17, 74]
look_at   = [-1, 9.6, 0]
up        = [0, 1, 0]
vfov      = 35

[render]
width = 1200
height = 800
samples_per_pixel = 64
max_depth = 6

[background]
color = [0.53, 0.91, 0.92]

[[mesh]]
obj = "forest.obj"
"""

MTL = """\
# Made by generate.py.
newmtl palette
illum 2
Kd 1 1 1
map_Kd forest-palette.png
"""

# Linear colours. One name with a digit at its end is one shade of a family.
PALETTE = {
    "grass1": (0.240, 0.300, 0.060), "grass2": (0.290, 0.330, 0.070), "grass3": (0.200, 0.260, 0.050),
    "pine1": (0.035, 0.120, 0.050), "pine2": (0.050, 0.150, 0.060), "pine3": (0.030, 0.095, 0.055),
    "leaf1": (0.330, 0.340, 0.050), "leaf2": (0.420, 0.330, 0.040), "leaf3": (0.260, 0.310, 0.060),
    "autumn1": (0.720, 0.250, 0.040), "autumn2": (0.820, 0.360, 0.060), "autumn3": (0.600, 0.160, 0.040),
    "trunk1": (0.180, 0.095, 0.050), "trunk2": (0.130, 0.070, 0.040),
    "rock1": (0.360, 0.310, 0.290), "rock2": (0.290, 0.250, 0.240), "rock3": (0.430, 0.380, 0.350),
    "snow1": (0.900, 0.870, 0.880), "snow2": (0.820, 0.790, 0.810),
    "sand1": (0.640, 0.500, 0.300), "water1": (0.090, 0.290, 0.400),
}
CELL = 8  # pixels; a uv in the middle of a cell is out of reach of the neighbours, whatever the filter
SEED = 20
LAKE = (-9, 15, 22, 10)  # centre x, z and half extents
WATER = -1.6
SNOWLINE = 27


def family(name):
    return [key for key in PALETTE if key.rstrip("0123456789") == name]


class Painted:
    """An OBJ whose faces take their colour from the palette, a random shade of the family for each."""

    def __init__(self, rng):
        self.obj = Obj("forest.mtl", "A low-poly forest. Made by generate.py.", decimals=2)
        self.obj.use("palette")
        self.rng = rng
        self.shades = list(PALETTE)

    def face(self, points, color):
        shade = self.rng.choice(family(color))
        self.obj.face(points, ((self.shades.index(shade) + 0.5) / len(PALETTE), 0.5))


def palette():
    row = b"".join(bytes(png.srgb8(c) for c in color) * CELL for color in PALETTE.values())
    return png.encode(CELL * len(PALETTE), [row] * CELL)


def ground(x, z):
    """Height of the land: hills, a hollow for the lake, a slope towards the mountains."""
    hills = 1.5 * math.sin(0.05 * x + 1) * math.cos(0.06 * z) + 0.7 * math.sin(0.13 * x - 0.09 * z)
    cx, cz, rx, rz = LAKE
    hollow = max(0.0, 1.5 - math.hypot((x - cx) / rx, (z - cz) / rz))
    rise = max(0.0, -z - 20) * 0.12
    return hills + rise - 5 * hollow


def land(out, rng, step=3.5):
    columns, rows = 72, 60
    points = []
    for j in range(rows + 1):
        for i in range(columns + 1):
            x = (i - columns / 2 + rng.uniform(-0.3, 0.3)) * step
            z = 76 - (j + rng.uniform(-0.3, 0.3)) * step
            points.append((x, ground(x, z) + rng.uniform(-0.2, 0.2), z))
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            for corner in ((a, b, c), (a, c, d)) if (i + j) % 2 else ((a, b, d), (b, c, d)):
                triangle = [points[k] for k in corner]
                height = sum(p[1] for p in triangle) / 3
                out.face(triangle, "sand" if height < WATER + 0.5 else "grass")
    cx, cz, rx, rz = LAKE
    shore = [(cx + 1.7 * rx * x, WATER, cz + 1.7 * rz * z) for x, _, z in circle(0, 0, 0, 1, 24)]
    for a, b in loop(shore):
        out.face([a, b, (cx, WATER, cz)], "water")


def trunk(out, rng, x, y, z, radius, height, sides=6):
    phase = rng.uniform(0, 1)
    bottom, top = circle(x, y, z, radius, sides, phase), circle(x, y + height, z, 0.7 * radius, sides, phase)
    prism(out, bottom, top, color="trunk")


def pine(out, rng, x, y, z, size):
    """Skirts of needles one above the other, each a pointed cone with a hollow underside."""
    trunk(out, rng, x, y - 0.5, z, 0.09 * size, 0.35 * size)
    tiers = rng.choice((4, 5))
    for tier in range(tiers):
        t = tier / tiers
        base, radius = y + size * (0.18 + 0.72 * t), size * 0.36 * (1 - t) ** 0.8
        rim = [
            (px, py + rng.uniform(-0.03, 0.03) * size, pz)
            for px, py, pz in circle(x, base, z, radius, 9, rng.uniform(0, 1))
        ]
        lean = rng.uniform(-0.02, 0.02) * size
        tip, inside = (x + lean, base + size * (0.38 - 0.1 * t), z - lean), (x, base + 0.06 * size, z)
        for a, b in loop(rim):
            out.face([a, b, tip], "pine")
            out.face([b, a, inside], "pine")


def ico_ball():
    """An icosahedron split once: 42 unit vectors and 80 faces."""
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    points += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2)]
    faces += [(10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5)]
    faces += [(2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    middles = {}

    def middle(a, b):
        key = (min(a, b), max(a, b))
        if key not in middles:
            middles[key] = len(points)
            points.append(tuple((p + q) / 2 for p, q in zip(points[a], points[b])))
        return middles[key]

    split = []
    for a, b, c in faces:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        split += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return [tuple(c / math.hypot(*p) for c in p) for p in points], split


BALL = ico_ball()


def lump(out, rng, center, radii, roughness, color):
    """A ball with uneven radii: a crown of leaves, a bush or a rock."""
    turn = rng.uniform(0, 2 * math.pi)
    cos, sin = math.cos(turn), math.sin(turn)
    points = []
    for x, y, z in BALL[0]:
        r = 1 + rng.uniform(-roughness, roughness)
        local = ((x * cos + z * sin) * r, y * r, (z * cos - x * sin) * r)
        points.append(tuple(c + s * p for c, s, p in zip(center, radii, local)))
    for face in BALL[1]:
        out.face([points[i] for i in face], color)


def leafy(out, rng, x, y, z, size):
    trunk(out, rng, x, y - 0.5, z, 0.07 * size, 0.55 * size)
    color = rng.choice(("leaf", "leaf", "autumn"))
    lump(out, rng, (x, y + 0.68 * size, z), (0.34 * size, 0.36 * size, 0.34 * size), 0.13, color)
    side = rng.uniform(0, 2 * math.pi)
    dx, dz = 0.22 * size * math.cos(side), 0.22 * size * math.sin(side)
    lump(out, rng, (x + dx, y + 0.55 * size, z + dz), (0.2 * size, 0.19 * size, 0.2 * size), 0.13, color)


def rock(out, rng, x, y, z, size):
    lump(out, rng, (x, y + 0.1 * size, z), (size, 0.65 * size, 0.8 * size), 0.2, "rock")


def mountain(out, rng, x, z, radius, height):
    """A cone of rough rings, with snow if it is high enough."""
    sides, rings = 22, 12
    ridge = [rng.uniform(0.7, 1.3) for _ in range(sides)]
    previous = None
    for ring in range(rings):
        t = ring / rings
        current = []
        for (px, _, pz), stretch in zip(circle(0, 0, 0, 1, sides, 0.5 * ring * math.pi / sides), ridge):
            r = radius * (1 - t) ** 1.25 * (1 + (stretch - 1) * (1 - 0.5 * t)) * rng.uniform(0.93, 1.07)
            current.append((x + r * px, height * (t + rng.uniform(-0.025, 0.025)), z + r * pz))
        if previous:
            for (a, b), (d, c) in zip(loop(previous), loop(current)):
                for triangle in ([a, b, c], [a, c, d]):
                    middle = sum(p[1] for p in triangle) / 3 + rng.uniform(-2.5, 2.5)
                    out.face(triangle, "snow" if middle > SNOWLINE else "rock")
        previous = current
    for a, b in loop(previous):
        out.face([a, b, (x, height, z)], "snow" if height > SNOWLINE else "rock")


def scatter(rng, count, taken, distance, allowed):
    """Up to `count` places that are `distance` apart from each other and from those taken."""
    places = []
    for _ in range(count * 20):
        x, z = rng.uniform(-85, 85), rng.uniform(-80, 62)
        if allowed(x, z) and all(math.hypot(x - a, z - b) >= max(distance, d) for a, b, d in taken):
            places.append((x, z))
            taken.append((x, z, distance))
            if len(places) == count:
                break
    return places


def files():
    rng = random.Random(SEED)
    out = Painted(rng)
    land(out, rng)

    def dry(x, z):
        return ground(x, z) > WATER + 0.6

    def in_view(x, z):
        """Away from the camera, and no farther to the sides than it can see."""
        return z < 48 and abs(x - 2) < 12 + 0.62 * (74 - z)

    def wood(x, z):
        """Behind the lake and on both sides of it; the near bank stays open."""
        return dry(x, z) and in_view(x, z) and (z < 8 or abs(x) > 17 + 0.1 * z)

    taken = []
    for x, z in scatter(rng, 260, taken, 3.4, wood):
        pine(out, rng, x, ground(x, z), z, rng.uniform(6, 11))
    for x, z in scatter(rng, 110, taken, 3.2, wood):
        leafy(out, rng, x, ground(x, z), z, rng.uniform(5, 8))
    for x, z in scatter(rng, 90, taken, 2, lambda x, z: ground(x, z) > WATER - 1 and in_view(x, z)):
        rock(out, rng, x, ground(x, z), z, rng.uniform(0.4, 1.6))
    for x, z in scatter(rng, 60, taken, 1.5, lambda x, z: dry(x, z) and in_view(x, z)):
        lump(out, rng, (x, ground(x, z) + 0.2, z), (0.9, 0.7, 0.9), 0.15, rng.choice(("leaf", "pine")))
    for x, z, radius, height in (
        (-72, -98, 40, 42), (-30, -112, 42, 50), (8, -104, 34, 38), (44, -116, 44, 54), (88, -100, 40, 42),
        (-112, -110, 44, 50), (24, -88, 22, 18), (-50, -84, 20, 17),
    ):
        mountain(out, rng, x, z, radius, height)
    return {
        "forest.toml": TOML.encode(),
        "forest.mtl": MTL.encode(),
        "forest.obj": out.obj.encode(),
        "forest-palette.png": palette(),
    }
