"""The Stanford bunny in glass, through a thin lens; the bunny itself is fetched."""

import math

from .obj import Obj
from .shapes import circle, loop, prism, square

TOML = """\
# The Stanford bunny in glass on a dark mirror, seen through a thin lens. Made by generate.py.
# models/bunny.obj is not ours: the fetch script beside this file gets it.

[camera]
look_from = [0, 4.5, 22]
look_at   = [0, 2.95, 0]
up        = [0, 1, 0]
vfov      = 22
defocus_angle  = 2.5
focus_distance = 21

[render]
width = 1000
height = 800
samples_per_pixel = 128
max_depth = 16

[background]
bottom = [0.95, 0.62, 0.38]
top    = [0.55, 0.42, 0.36]

[material.glass]
type = "dielectric"
index = 1.5

[[mesh]]
obj = "bunny-stage.obj"

[[mesh]]
obj = "models/bunny.obj"
material = "glass"
"""

MTL = """\
# Made by generate.py.
newmtl mirror
illum 3
Ks 0.058 0.047 0.137
Ns 980

newmtl red
illum 2
Kd 0.80 0.25 0.23

newmtl yellow
illum 2
Kd 0.83 0.74 0.23

newmtl light
illum 2
Kd 0 0 0
Ke 10 10 10
"""


def cube(obj, x, z, half, degrees):
    """A cube that stands on y = 0, turned about its upright axis."""
    diagonal, turn = half * math.sqrt(2), math.radians(45 + degrees)
    prism(obj, circle(x, 0, z, diagonal, 4, turn), circle(x, 2 * half, z, diagonal, 4, turn))


def cone(obj, x, z, radius, height, sides):
    """A cone that stands on y = 0."""
    rim = circle(x, 0, z, radius, sides)
    for a, b in loop(rim):
        obj.face([a, b, (x, height, z)])
    obj.face(rim[::-1])


def files():
    stage = Obj("bunny-stage.mtl", "What stands around the bunny. Made by generate.py.")
    stage.use("mirror")
    stage.face(square(500, 0))
    stage.use("red")
    cube(stage, -6.2, -16, 2.7, 32)
    stage.use("yellow")
    cone(stage, 6.5, -18, 3.6, 8.5, 64)
    stage.use("light")
    stage.face(square(4, 14)[::-1])
    return {"bunny.toml": TOML.encode(), "bunny-stage.mtl": MTL.encode(), "bunny-stage.obj": stage.encode()}
