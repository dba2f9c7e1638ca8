"""The cover of Ray Tracing in One Weekend, from the book's loop and a fixed seed."""

import math
import random

from .obj import number

SEED = 1

TOML = """\
# The cover of Ray Tracing in One Weekend. Made by generate.py.

[camera]
look_from = [13, 2, 3]
look_at   = [0, 0, 0]
up        = [0, 1, 0]
vfov      = 20
defocus_angle  = 0.6
focus_distance = 10

[render]
width = 1920
height = 1080
samples_per_pixel = 64
max_depth = 50

[background]
color = [0.70, 0.80, 1.00]

[material]
ground = { type = "lambertian", albedo = [0.5, 0.5, 0.5] }
glass = { type = "dielectric", index = 1.5 }
brown = { type = "lambertian", albedo = [0.4, 0.2, 0.1] }
steel = { type = "metal", albedo = [0.7, 0.6, 0.5], fuzz = 0 }
"""

LARGE = [
    ((0, -1000, 0), 1000, "ground"),
    ((0, 1, 0), 1, "glass"),
    ((-4, 1, 0), 1, "brown"),
    ((4, 1, 0), 1, "steel"),
]


def vector(values):
    return "[" + ", ".join(number(value, 4) for value in values) + "]"


def small_spheres(xi):
    """Spheres as (centre, radius, material name), and the line of each material that only one of them has."""
    spheres, materials = [], []
    for a in range(-11, 11):
        for b in range(-11, 11):
            choice = xi()
            center = (a + 0.9 * xi(), 0.2, b + 0.9 * xi())
            if math.dist(center, (4, 0.2, 0)) <= 0.9:
                continue
            if choice < 0.8:
                name = f"matte_{len(materials)}"
                albedo = [xi() * xi() for _ in range(3)]
                materials.append(f'{name} = {{ type = "lambertian", albedo = {vector(albedo)} }}')
            elif choice < 0.95:
                name = f"metal_{len(materials)}"
                albedo = [0.5 + 0.5 * xi() for _ in range(3)]
                fuzz = number(0.5 * xi(), 4)
                materials.append(f'{name} = {{ type = "metal", albedo = {vector(albedo)}, fuzz = {fuzz} }}')
            else:
                name = "glass"
            spheres.append((center, 0.2, name))
    return spheres, materials


def files():
    small, materials = small_spheres(random.Random(SEED).random)
    spheres = [
        f'\n[[sphere]]\ncenter = {vector(center)}\nradius = {number(radius, 1)}\nmaterial = "{material}"\n'
        for center, radius, material in LARGE + small
    ]
    return {"one-weekend.toml": (TOML + "\n".join(materials) + "\n" + "".join(spheres)).encode()}
