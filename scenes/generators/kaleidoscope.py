"""Two mirrors that meet at 60 degrees, with three balls and a small lamp between them."""

from math import cos, radians, sin

from .obj import Obj

TOML = """\
# Two mirrors that meet at 60 degrees, with three balls and a small lamp between them. Made by generate.py.

[camera]
look_from = [0.3, 3.6, 7]
look_at   = [0, 0.7, 1.2]
up        = [0, 1, 0]
vfov      = 42

[render]
width = 900
height = 600
samples_per_pixel = 64
max_depth = 12

[background]
color = [0, 0, 0]

[material.red]
type = "lambertian"
albedo = [0.7, 0.12, 0.08]

[material.blue]
type = "lambertian"
albedo = [0.1, 0.25, 0.65]

[material.yellow]
type = "lambertian"
albedo = [0.75, 0.6, 0.1]

[[mesh]]
obj = "kaleidoscope.obj"

[[sphere]]
center = [0.6, 0.351, 2.4]
radius = 0.35
material = "red"

[[sphere]]
center = [-0.7, 0.301, 2.9]
radius = 0.3
material = "blue"

[[sphere]]
center = [-0.1, 0.201, 1.5]
radius = 0.2
material = "yellow"
"""

MTL = """\
# Made by generate.py.
newmtl floor
illum 2
Kd 0.6 0.6 0.6

newmtl mirror
illum 3
Ks 0.92 0.92 0.92
Ns 1000

newmtl light
illum 2
Kd 0 0 0
Ke 240 224 200
"""

LENGTH, HEIGHT = 4, 2.6


def files():
    stage = Obj("kaleidoscope.mtl", "A floor, two mirrors and a lamp. Made by generate.py.")
    stage.use("floor")
    stage.face([(-7, 0, -7), (-7, 0, 7), (7, 0, 7), (7, 0, -7)])
    stage.use("mirror")
    for angle in (radians(30), radians(-30)):
        x, z = LENGTH * sin(angle), LENGTH * cos(angle)
        stage.face([(0, 0, 0), (x, 0, z), (x, HEIGHT, z), (0, HEIGHT, 0)])
    stage.use("light")
    stage.face([(0.1, 2.2, 2.2), (0.3, 2.2, 2.2), (0.3, 2.2, 2.4), (0.1, 2.2, 2.4)])
    return {
        "kaleidoscope.toml": TOML.encode(),
        "kaleidoscope.mtl": MTL.encode(),
        "kaleidoscope.obj": stage.encode(),
    }
