"""A glass ball and a mirror ball under a small lamp."""

from .obj import Obj

TOML = """\
# A glass ball and a mirror ball under a small lamp. Made by generate.py.

[camera]
look_from = [0, 3.1, 7.5]
look_at   = [0, 0.8, 0]
up        = [0, 1, 0]
vfov      = 36

[render]
width = 900
height = 600
samples_per_pixel = 64
max_depth = 8

[background]
color = [0, 0, 0]

[material.glass]
type = "dielectric"
index = 1.5

[material.mirror]
type = "metal"
albedo = [0.95, 0.93, 0.88]
fuzz = 0

[[mesh]]
obj = "caustics.obj"

[[sphere]]
center = [-1.2, 1.001, 0.2]
radius = 1
material = "glass"

[[sphere]]
center = [1.3, 1.001, -0.2]
radius = 1
material = "mirror"
"""

MTL = """\
# Made by generate.py.
newmtl paper
illum 2
Kd 0.7 0.66 0.6

newmtl light
illum 2
Kd 0 0 0
Ke 620 580 520
"""


def files():
    stage = Obj("caustics.mtl", "A floor, a wall and a lamp. Made by generate.py.")
    stage.use("paper")
    stage.face([(-8, 0, -3), (-8, 0, 8), (8, 0, 8), (8, 0, -3)])
    stage.face([(-8, 0, -3), (8, 0, -3), (8, 7, -3), (-8, 7, -3)])
    stage.use("light")
    stage.face([(-0.1, 4.6, -2.2), (0.1, 4.6, -2.2), (0.1, 4.6, -2), (-0.1, 4.6, -2)])
    return {"caustics.toml": TOML.encode(), "caustics.mtl": MTL.encode(), "caustics.obj": stage.encode()}
