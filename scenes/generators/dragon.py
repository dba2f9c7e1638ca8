"""The Stanford dragon on a glowing square; the dragon itself is fetched."""

from .obj import Obj
from .shapes import loop, square

TOML = """\
# The Stanford dragon, lit from the plinth it stands on. Made by generate.py.
# models/dragon.obj is not ours: the fetch script beside this file gets it.

[camera]
look_from = [-4, 4.6, 17.5]
look_at   = [0.3, 1.9, 0]
up        = [0, 1, 0]
vfov      = 29

[render]
width = 800
height = 800
samples_per_pixel = 64
max_depth = 5

[background]
color = [0, 0.048, 0]

[material.green]
type = "metal"
albedo = [0.178, 0.801, 0.086]
fuzz = 0.75

[[mesh]]
obj = "dragon-plinth.obj"

[[mesh]]
obj = "models/dragon.obj"
material = "green"
"""

MTL = """\
# Made by generate.py.
newmtl black
illum 2
Kd 0 0 0

newmtl glow
illum 2
Kd 0 0 0
Ke 7 10 7
"""

LIGHT = 4  # half the side of the glowing square
BOX = 4.4  # half the side of the box
HEIGHT = 6


def files():
    plinth = Obj("dragon-plinth.mtl", "A black box with a glowing square flush in its top. Made by generate.py.")
    light, top, bottom = square(LIGHT, 0), square(BOX, 0), square(BOX, -HEIGHT)
    plinth.use("black")
    for lower, upper in ((bottom, top), (top, light)):
        for (a, b), (d, c) in zip(loop(lower), loop(upper)):
            plinth.face([a, b, c, d])
    plinth.face(bottom[::-1])
    plinth.use("glow")
    plinth.face(light)
    return {"dragon.toml": TOML.encode(), "dragon-plinth.mtl": MTL.encode(), "dragon-plinth.obj": plinth.encode()}
