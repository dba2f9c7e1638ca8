"""The Cornell box with a mirror sphere and a glass sphere."""

from . import room
from .obj import Obj

TOML = """\
# The Cornell box with a mirror sphere and a glass sphere. Made by generate.py.

[camera]
look_from = [278, 278, -800]
look_at   = [278, 278, 0]
up        = [0, 1, 0]
vfov      = 40

[render]
width = 800
height = 800
samples_per_pixel = 64
max_depth = 7

[background]
color = [0, 0, 0]

[material.mirror]
type = "metal"
albedo = [1, 1, 1]
fuzz = 0

[material.glass]
type = "dielectric"
index = 1.5

[[mesh]]
obj = "cornell.obj"

[[sphere]]
center = [400, 82.5, 335]
radius = 82.5
material = "mirror"

[[sphere]]
center = [150, 82.5, 150]
radius = 82.5
material = "glass"
"""

MTL = """\
# Made by generate.py.
newmtl white
illum 2
Kd 0.73 0.73 0.73

newmtl red
illum 2
Kd 0.65 0.05 0.05

newmtl green
illum 2
Kd 0.12 0.45 0.15

newmtl light
illum 2
Kd 0 0 0
Ke 15 15 15
"""


def files():
    box = Obj("cornell.mtl", "The Cornell box, open towards the camera. Made by generate.py.")
    for material, walls in (
        ("white", [room.FLOOR, room.CEILING, room.BACK]),
        ("green", [room.LEFT]),
        ("red", [room.RIGHT]),
        ("light", [room.LIGHT]),
    ):
        box.use(material)
        for wall in walls:
            box.face(wall)
    return {"cornell.toml": TOML.encode(), "cornell.mtl": MTL.encode(), "cornell.obj": box.encode()}
