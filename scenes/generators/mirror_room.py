"""The Cornell box closed, with mirrors front and back and a checkered floor."""

from . import room
from .obj import Obj

TOML = """\
# A closed room with mirrors front and back; the camera stands inside. Made by generate.py.

[camera]
look_from = [100, 300, 550]
look_at   = [305, 300, 75]
up        = [0, 1, 0]
vfov      = 45

[render]
width = 1000
height = 1000
samples_per_pixel = 128
max_depth = 40

[background]
color = [0, 0, 0]

[material.earth]
type = "lambertian"
albedo = { image = "earth.png" }

[[mesh]]
obj = "mirror-room.obj"

[[sphere]]
center = [278, 278, 278]
radius = 40
material = "earth"
"""

MTL = """\
# Made by generate.py.
newmtl white
illum 2
Kd 0.88 0.88 0.88

newmtl black
illum 2
Kd 0 0 0

newmtl mirror
illum 3
Ks 0.93 0.93 0.93
Ns 1000

newmtl light
illum 2
Kd 0 0 0
Ke 25 25 25
"""

CELL = 50


def checkered_floor(obj):
    """One quad a cell, cut off at the walls; cells count from (0, 0), which is white.

    A 3D checker texture would be evaluated exactly on its boundary y = 0, where
    rounding decides the colour.
    """
    edges = [*range(0, room.SIDE, CELL), room.SIDE]
    for parity, material in enumerate(("white", "black")):
        obj.use(material)
        for i, (x0, x1) in enumerate(zip(edges, edges[1:])):
            for k, (z0, z1) in enumerate(zip(edges, edges[1:])):
                if (i + k) % 2 == parity:
                    obj.face([(x0, 0, z0), (x0, 0, z1), (x1, 0, z1), (x1, 0, z0)])
    return edges


def wall(obj, corners, steps):
    """A wall that shares every vertex of the floor's edge, so that no ray can slip out between them.

    `corners` start at the floor: floor, ceiling, ceiling, floor.
    """
    start, above_start, above_end, end = corners
    if start > end:
        steps = steps[::-1]
    foot = [tuple(a if a == b else step for a, b in zip(start, end)) for step in steps]
    for near, far in zip(foot, foot[1:]):
        obj.face([near, above_start, far])
    obj.face([foot[-1], above_start, above_end])


def files():
    box = Obj("mirror-room.mtl", "A closed room, 0 to 555 on each axis. Made by generate.py.")
    steps = checkered_floor(box)
    box.use("white")
    box.face(room.CEILING)
    for material, walls in (("white", (room.LEFT, room.RIGHT)), ("mirror", (room.BACK, room.FRONT))):
        box.use(material)
        for corners in walls:
            wall(box, corners, steps)
    box.use("light")
    box.face(room.LIGHT)
    return {"mirror-room.toml": TOML.encode(), "mirror-room.mtl": MTL.encode(), "mirror-room.obj": box.encode()}
