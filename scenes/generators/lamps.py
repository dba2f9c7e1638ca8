"""A hall of pillars under 1,000 lamps, small ones and large ones, dim and bright."""

import math
import random

from .obj import Obj, number

SEED = 3
LAMPS = 1000
WIDTH, HEIGHT, LENGTH = 2400, 900, 6000  # centimetres
TINTS = {"white": (1, 1, 1), "warm": (1, 0.65, 0.3), "blue": (0.35, 0.6, 1), "red": (1, 0.25, 0.2)}
STEPS = 7  # of radiance, a factor of 3 each

TOML = """\
# A hall under 1,000 lamps of very different power. Made by generate.py.

[camera]
look_from = [1000, 330, 120]
look_at   = [1350, 270, 2400]
up        = [0, 1, 0]
vfov      = 55

[render]
width = 1200
height = 800
samples_per_pixel = 128
max_depth = 7

[background]
color = [0, 0, 0]

[[mesh]]
obj = "lamps.obj"
"""

MTL = """\
# Made by generate.py.
newmtl plaster
illum 2
Kd 0.75 0.72 0.68

newmtl floor
illum 2
Kd 0.4 0.38 0.36

newmtl wood
illum 2
Kd 0.5 0.3 0.15
"""


def box(obj, low, high):
    x0, y0, z0 = low
    x1, y1, z1 = high
    for face in (
        [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)],
        [(x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1)],
        [(x0, y0, z0), (x0, y1, z0), (x1, y1, z0), (x1, y0, z0)],
        [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
        [(x0, y1, z0), (x0, y1, z1), (x1, y1, z1), (x1, y1, z0)],
    ):
        obj.face(face)


def walls(obj):
    w, h, n = WIDTH, HEIGHT, LENGTH
    obj.use("floor")
    obj.face([(0, 0, 0), (0, 0, n), (w, 0, n), (w, 0, 0)])
    obj.use("plaster")
    obj.face([(0, h, 0), (w, h, 0), (w, h, n), (0, h, n)])
    obj.face([(0, 0, 0), (0, h, 0), (0, h, n), (0, 0, n)])
    obj.face([(w, 0, 0), (w, 0, n), (w, h, n), (w, h, 0)])
    obj.face([(0, 0, 0), (w, 0, 0), (w, h, 0), (0, h, 0)])
    obj.face([(0, 0, n), (0, h, n), (w, h, n), (w, 0, n)])
    for z in range(600, n, 900):
        for x in (500, w - 600):
            box(obj, (x, 0, z), (x + 100, h, z + 100))
    obj.use("wood")
    for z in range(400, n - 400, 450):
        box(obj, (900, 0, z), (1500, 80, z + 150))


def quad(obj, middle, size, xi):
    """A square, turned at random."""
    z = 2 * xi() - 1
    turn, spin = 2 * math.pi * xi(), 2 * math.pi * xi()
    r = math.sqrt(1 - z * z)
    n = (r * math.cos(turn), z, r * math.sin(turn))
    a = (math.sin(turn), 0, -math.cos(turn))
    b = (n[1] * a[2] - n[2] * a[1], n[2] * a[0] - n[0] * a[2], n[0] * a[1] - n[1] * a[0])
    corners = []
    for k in range(4):
        c, s = (size * f(spin + k * math.pi / 2) for f in (math.cos, math.sin))
        corners.append([m + c * x + s * y for m, x, y in zip(middle, a, b)])
    obj.face(corners)


def files():
    xi = random.Random(SEED).random
    obj = Obj("lamps.mtl", "Made by generate.py.", decimals=1)
    walls(obj)
    names = [f"{tint}_{step}" for tint in TINTS for step in range(STEPS)]
    mtl = MTL
    for name in names:
        tint, step = name.split("_")
        ke = " ".join(number(c * 3 ** (int(step) - 2), 3) for c in TINTS[tint])
        mtl += f"\nnewmtl {name}\nillum 2\nKd 0 0 0\nKe {ke}\n"
    spheres = []
    quads = {name: [] for name in names}
    for i in range(LAMPS):
        # They hang anywhere above the tables; few are bright.
        middle = (30 + (WIDTH - 60) * xi(), 230 + (HEIGHT - 260) * xi(), 30 + (LENGTH - 60) * xi())
        size = 3 * 8 ** xi()
        name = f"{list(TINTS)[int(4 * xi())]}_{int(STEPS * xi() ** 1.5)}"
        if i % 2:
            quads[name].append((middle, size))
            continue
        center = ", ".join(number(c, 0) for c in middle)
        spheres.append(f'\n[[sphere]]\ncenter = [{center}]\nradius = {number(size, 1)}\nmaterial = "{name}"\n')
    for name, hung in quads.items():
        if hung:
            obj.use(name)
        for middle, size in hung:
            quad(obj, middle, size, xi)
    lamps = "\n[material]\n"
    for name in names:
        tint, step = name.split("_")
        radiance = ", ".join(number(c * 3 ** (int(step) - 2), 3) for c in TINTS[tint])
        lamps += f'{name} = {{ type = "diffuse_light", radiance = [{radiance}] }}\n'
    return {
        "lamps.toml": (TOML + lamps + "".join(spheres)).encode(),
        "lamps.obj": obj.encode(),
        "lamps.mtl": mtl.encode(),
    }
