"""A globe with a drawn map on a turned wooden stand."""

import math

from . import earth
from .obj import Obj
from .shapes import cross, turned, unit

TOML = """\
# A globe on a wooden stand in front of a paper backdrop. Made by generate.py.

[camera]
look_from = [0, 7.6, 24]
look_at   = [0.25, 4.95, 0]
up        = [0, 1, 0]
vfov      = 27

[render]
width = 800
height = 800
samples_per_pixel = 128
max_depth = 7

[background]
color = [0, 0, 0]

[[mesh]]
obj = "globe.obj"
"""

MTL = """\
# Made by generate.py.
newmtl map
illum 2
Kd 1 1 1
map_Kd earth.png

newmtl wood
illum 2
Kd 0.078 0.026 0.004

newmtl paper
illum 2
Kd 0.62 0.55 0.46

newmtl light
illum 2
Kd 0 0 0
Ke 52 50 46
"""

RADIUS = 3.4
CENTER = (0, 6, 0)
TILT = math.radians(23.4)  # of the axis, to the right
FACING = 10  # the longitude that faces the camera
ARM = 3.95  # radius of the middle of the arm


def tilted(p):
    """From the globe's own frame, axis upwards, to that of the stand."""
    x, y, z = p
    cos, sin = math.cos(TILT), math.sin(TILT)
    return (x * cos + y * sin, y * cos - x * sin, z)


def at_center(p):
    return tuple(a + b for a, b in zip(p, CENTER))


def sphere(obj, columns, rows):
    """The globe's ball: u is longitude from -180 degrees eastwards, v is latitude from the south pole."""

    def corner(i, j):
        lon = math.radians(360 * (i % columns) / columns - 180 - FACING)
        lat = math.radians(180 * j / rows - 90)
        r = 0 if j in (0, rows) else math.cos(lat)
        normal = tilted((r * math.sin(lon), math.sin(lat), r * math.cos(lon)))
        middle = 0.5 if j in (0, rows) else 0
        return at_center([RADIUS * c for c in normal]), ((i + middle) / columns, j / rows), normal

    for j in range(rows):
        for i in range(columns):
            corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]
            if j == 0:
                del corners[1]
            if j == rows - 1:
                del corners[-1]
            obj.face(*zip(*corners))


def arm(obj, steps, sides):
    """The half ring that holds the axis, a little longer than from pole to pole: a swept ellipse."""
    reach = math.radians(93)

    def ring(angle):
        """Points and normals of one cross-section; `angle` is the latitude it stands at."""
        out = (math.cos(angle), math.sin(angle))
        for side in range(sides):
            b = 2 * math.pi * side / sides
            x, z = 0.13 * math.cos(b), 0.24 * math.sin(b)
            nx, nz = unit((x / 0.13**2, z / 0.24**2))
            point = ((ARM + x) * out[0], (ARM + x) * out[1], z)
            yield at_center(tilted(point)), tilted((nx * out[0], nx * out[1], nz))

    rings = [list(ring(reach * (2 * step / steps - 1))) for step in range(steps + 1)]
    for low, high in zip(rings, rings[1:]):
        for i in range(sides):
            j = (i + 1) % sides
            points, normals = zip(low[j], low[i], high[i], high[j])
            obj.face(points, normals=normals)
    for sign, end in ((-1, rings[0]), (1, rings[-1][::-1])):
        normal = tilted((-math.sin(reach), sign * math.cos(reach), 0))
        obj.face([point for point, _ in end], normals=[normal] * sides)


def stand(obj):
    foot = [(0, 0), (2.3, 0), (2.4, 0.1), (2.4, 0.25), (2.3, 0.35), (2.05, 0.4), (2.0, 0.48), (1.6, 0.58), (0.95, 0.72)]
    column = [(0.55, 0.9), (0.36, 1.1), (0.32, 1.2), (0.46, 1.3), (0.5, 1.4), (0.46, 1.5), (0.3, 1.6), (0.26, 1.75)]
    head = [(0.3, 1.9), (0.42, 1.98), (0.42, 2.1), (0, 2.1)]
    turned(obj, foot + column + head, 64)
    arm(obj, 64, 16)
    pin = [(0, RADIUS - 0.1), (0.12, RADIUS - 0.1), (0.12, 4.08), (0.28, 4.08), (0.3, 4.14), (0.2, 4.24)]
    knob = [(0.26, 4.36), (0.22, 4.5), (0.1, 4.58), (0, 4.6)]
    turned(obj, pin + knob, 32, CENTER, tilted)
    turned(obj, pin + knob, 32, CENTER, lambda p: tilted((p[0], -p[1], -p[2])))


def backdrop(obj, half, front, back, radius, height, steps):
    """Paper that lies on the table and sweeps up behind: a floor, a quarter circle and a wall."""
    path = [((front, 0), (0, 1))]
    for step in range(steps + 1):
        a = math.pi / 2 * step / steps
        path.append(((back - radius * math.sin(a), radius - radius * math.cos(a)), (math.sin(a), math.cos(a))))
    path.append(((back - radius, height), (1, 0)))
    for ((z0, y0), n0), ((z1, y1), n1) in zip(path, path[1:]):
        points = [(-half, y0, z0), (half, y0, z0), (half, y1, z1), (-half, y1, z1)]
        normals = [(0, n[1], n[0]) for n in (n0, n0, n1, n1)]
        obj.face(points, normals=normals)


def lamp(obj, center, target, half):
    """A square that faces `target`."""
    forward = unit([t - c for c, t in zip(center, target)])
    right = unit(cross(forward, (0, 1, 0)))
    up = cross(right, forward)
    corners = ((-1, -1), (-1, 1), (1, 1), (1, -1))
    obj.face([[c + half * (a * r + b * u) for c, r, u in zip(center, right, up)] for a, b in corners])


def files():
    globe = Obj("globe.mtl", "A globe, its stand, a backdrop and a lamp. Made by generate.py.", decimals=4)
    globe.use("map")
    sphere(globe, 96, 48)
    globe.use("wood")
    stand(globe)
    globe.use("paper")
    backdrop(globe, half=60, front=40, back=-8, radius=10, height=50, steps=24)
    globe.use("light")
    lamp(globe, (-9, 16, 12), CENTER, 3)
    return {
        "globe.toml": TOML.encode(),
        "globe.mtl": MTL.encode(),
        "globe.obj": globe.encode(),
        "earth.png": earth.draw(),
    }
