"""A street of a small town by day: houses of our own, and fetched models of trees, cars, people and furniture."""

import math
import random

from .obj import Obj

HEAD = """\
# A street and a square of a small town, in metres. Made by generate.py.
# What lies in ../models/town is not ours: ../fetch gets it.

[camera]
look_from = [6.2, 7.2, 37.5]
look_at   = [-1.3, 2.6, 6]
up        = [0, 1, 0]
vfov      = 40

[render]
width = 1200
height = 800
samples_per_pixel = 128
max_depth = 8

[background]
bottom = [0.92, 0.95, 1.00]
top    = [0.18, 0.38, 0.82]

[material.sun]
type = "diffuse_light"
radiance = [63, 55.5, 44]

[[sphere]]
center = [310, 260, 250]
radius = 55
material = "sun"

[[mesh]]
file = "town.obj"
"""

# Linear colours.
COLORS = {
    "grass": (0.13, 0.20, 0.045), "asphalt": (0.085, 0.085, 0.09), "paving": (0.36, 0.32, 0.27),
    "slab": (0.315, 0.275, 0.23), "hills": (0.11, 0.17, 0.085), "kerb": (0.42, 0.41, 0.39), "paint": (0.75, 0.75, 0.72),
    "cream": (0.74, 0.66, 0.48), "ochre": (0.66, 0.42, 0.16), "rose": (0.66, 0.36, 0.28),
    "sky": (0.36, 0.50, 0.60), "sage": (0.42, 0.50, 0.33), "white": (0.76, 0.75, 0.71),
    "brick": (0.36, 0.13, 0.085), "tiles": (0.42, 0.145, 0.07), "slate": (0.12, 0.13, 0.15),
    "plinth": (0.26, 0.25, 0.24), "pane": (0.035, 0.045, 0.055),
}
SEED = 3


class Town:
    """The mesh of what is ours, and the places of what is fetched."""

    def __init__(self):
        self.obj = Obj("town.mtl", "Streets and houses of a town. Made by generate.py.")
        self.rng = random.Random(SEED)
        self.meshes = []

    def place(self, model, x, z, turn=0, y=0.0, scale=1):
        """A fetched model, CATALOGUE/NAME or CATALOGUE/FOLDER/NAME, its front at `turn` degrees from +z towards +x."""
        catalogue, _, name = model.partition("/")
        folder, _, name = name.rpartition("/")
        file = f"../models/town/{catalogue}/{catalogue.lower()}/{folder or name}/{name}.obj"
        self.meshes.append(f'\n[[mesh]]\nfile = "{file}"\n'
                           + (f"scale = {scale:g}\n" if scale != 1 else "")
                           + (f"rotate_y = {turn:g}\n" if turn else "")
                           + f"translate = [{x:.3g}, {y:.3g}, {z:.3g}]\n")

    def box(self, color, low, high):
        """A box but for its bottom, which is never seen."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        self.obj.use(color)
        self.obj.face([(x0, y1, z0), (x0, y1, z1), (x1, y1, z1), (x1, y1, z0)])
        for a, b in (((x0, z1), (x1, z1)), ((x1, z1), (x1, z0)), ((x1, z0), (x0, z0)), ((x0, z0), (x0, z1))):
            self.obj.face([(a[0], y0, a[1]), (b[0], y0, b[1]), (b[0], y1, b[1]), (a[0], y1, a[1])])


class House:
    """A house whose own axes are x along its front, y up and z out of its front."""

    def __init__(self, town, x, z, turn):
        self.town, self.x, self.z, self.turn = town, x, z, turn
        self.cos, self.sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))

    def at(self, x, z):
        return self.x + x * self.cos + z * self.sin, self.z - x * self.sin + z * self.cos

    def face(self, color, points):
        self.town.obj.use(color)
        placed = [(self.at(x, z), y) for x, y, z in points]
        self.town.obj.face([(x, y, z) for (x, z), y in placed])

    def place(self, model, x, z, y=0.0, turn=0, scale=1):
        self.town.place(model, *self.at(x, z), (self.turn + turn) % 360, y, scale)

    def wall(self, color, x0, x1, z, y0, y1):
        """A rectangle that looks to the front."""
        self.face(color, [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)])

    def body(self, width, depth, eaves, ridge, wall, roof):
        w, d = width / 2, depth / 2
        for color, low, high in (("plinth", 0, 0.5), (wall, 0.5, eaves)):
            for (ax, az), (bx, bz) in (((-w, d), (w, d)), ((w, d), (w, -d)), ((w, -d), (-w, -d)), ((-w, -d), (-w, d))):
                self.face(color, [(ax, low, az), (bx, low, bz), (bx, high, bz), (ax, high, az)])
        for x, side in ((w, 1), (-w, -1)):  # gables
            self.face(wall, [(x, eaves, side * d), (x, eaves, -side * d), (x, ridge, 0)])
        out, thick = 0.45, 0.18
        slope = (ridge - eaves) / d
        for side in (1, -1):  # the roof's two slabs
            low, edge, end = eaves - out * slope, side * (d + out), side * (w + out)
            top = [(-end, low, edge), (end, low, edge), (end, ridge, 0), (-end, ridge, 0)]
            raised = [(x, y + thick, z) for x, y, z in top]
            self.face(roof, raised)
            self.face(roof, top[::-1])
            for (a, b), (c, e) in zip(zip(top, top[1:] + top[:1]), zip(raised, raised[1:] + raised[:1])):
                self.face(roof, [a, b, e, c])

    def window(self, x, y, z, shutters, flowers):
        self.wall("pane", x - 0.36, x + 0.36, z + 0.01, y + 0.08, y + 1.52)
        self.place("KatorLegaz/window-08", x, z + 0.1, y, scale=1.25)
        if shutters:
            for side in (-1, 1):
                self.place("KatorLegaz/window-shutter", x + side * 0.6, z + 0.03, y, scale=1.28)
        if flowers:
            self.place("BlendSwap-CC-0/flowerBox", x, z + 0.16, y - 0.17, scale=1.4)


def house(town, x, z, turn, wall, roof, door, width, storeys=2, shutters=True, flowers=False):
    """`z` and `x` are the middle of its front."""
    rng = town.rng
    depth, eaves = 8.0, 2.9 * storeys + 0.3
    made = House(town, x, z, turn)
    made.x, made.z = made.at(0, -depth / 2)
    made.body(width, depth, eaves, eaves + rng.uniform(2.3, 2.9), wall, roof)
    front = depth / 2
    columns = [(i - (round(width / 2.6) - 1) / 2) * 2.55 for i in range(round(width / 2.6))]
    entrance = rng.choice(range(len(columns)))
    for storey in range(storeys):
        for i, column in enumerate(columns):
            y = 0.95 + 2.9 * storey
            if storey == 0 and i == entrance:
                made.place(f"KatorLegaz/exterior-door-0{door}", column, front + 0.06, 0.12, scale=1.06)
                made.place("KatorLegaz/porch-light", column + 0.75, front + 0.09, 1.75)
                made.place("Scopia/letters_box", column - 0.95, front + 0.06, 1.1)
                made.place("Scopia/doormat", column, front + 0.5, 0.13)
            else:
                made.window(column, y, front, shutters, flowers and storey > 0)
    gable = House(town, made.x, made.z, turn - math.copysign(90, turn))  # the end towards the square
    for storey in range(storeys):
        for column in (-1.9, 1.9):
            gable.window(column, 0.95 + 2.9 * storey, width / 2, shutters, flowers and storey > 0)
    chimney = "Scopia/chimney" if rng.random() < 0.6 else "Scopia/round-chimney"
    made.place(chimney, rng.choice((-1, 1)) * width * 0.3, 0, eaves + 1.9, scale=1.35)
    return made


def ground(town):
    road, walk, far = 3.5, 6.0, 75
    obj = town.obj
    obj.use("grass")
    obj.face([(-400, 0, 400), (400, 0, 400), (400, 0, -400), (-400, 0, -400)])
    obj.use("hills")
    heights = [10 + 7 * math.sin(0.9 * i) + 6 * math.sin(0.37 * i + 2) for i in range(33)]
    for i, (left, right) in enumerate(zip(heights, heights[1:])):
        x0, x1 = -400 + 25 * i, -375 + 25 * i
        obj.face([(x0, 0, -190), (x1, 0, -190), (x1, right, -290), (x0, left, -290)])
    obj.use("asphalt")
    obj.face([(-road, 0.02, 12), (road, 0.02, 12), (road, 0.02, -far), (-road, 0.02, -far)])
    obj.face([(-60, 0.03, 13), (60, 0.03, 13), (60, 0.03, 6), (-60, 0.03, 6)])
    for side in (-1, 1):  # pavements along the street, each with its kerb
        x0, x1 = sorted((side * road, side * (road + 0.2)))
        town.box("kerb", (x0, 0, -far), (x1, 0.13, 5.8))
        x0, x1 = sorted((side * (road + 0.2), side * walk))
        town.box("paving", (x0, 0, -far), (x1, 0.12, 5.8))
        x0, x1 = sorted((side * (road + 0.2), side * 60))
        town.box("paving", (x0, 0, 3.6), (x1, 0.12, 5.8))
        town.box("kerb", (x0, 0, 5.8), (x1, 0.13, 6))
    town.box("kerb", (-60, 0, 13), (60, 0.13, 13.2))
    # The square is laid in slabs of two shades.
    town.box("paving", (-60, 0, 13.2), (60, 0.12, 60))
    obj.use("slab")
    for i in range(-16, 17):
        for j in range(24):
            if (i + j) % 2:
                x, z = 1.2 * i, 13.8 + 1.2 * j
                obj.face([(x, 0.125, z + 1.2), (x + 1.2, 0.125, z + 1.2), (x + 1.2, 0.125, z), (x, 0.125, z)])
    obj.use("paint")
    for k in range(12):  # the middle of the street
        z = 1.5 - 6 * k
        obj.face([(-0.07, 0.03, z), (0.07, 0.03, z), (0.07, 0.03, z - 3), (-0.07, 0.03, z - 3)])
    for i in range(8):  # zebra crossings
        x = -3.1 + 0.8 * i
        obj.face([(x, 0.03, 5.4), (x + 0.45, 0.03, 5.4), (x + 0.45, 0.03, 2.6), (x, 0.03, 2.6)])


def street(town):
    place, rng = town.place, town.rng
    row = [("cream", "tiles", 5, 7.8), ("sky", "slate", 3, 7.8), ("ochre", "tiles", 7, 10.4),
           ("white", "slate", 2, 7.8), ("rose", "tiles", 1, 10.4), ("sage", "slate", 5, 7.8), ("brick", "slate", 7, 10.4)]
    for side in (-1, 1):
        z = 3.0
        for i, (wall, roof, door, width) in enumerate(row if side < 0 else row[3:] + row[:3]):
            z -= width / 2
            house(town, side * 8.2, z, -90 * side, wall, roof, door, width, storeys=3 if i in (2, 4) else 2,
                  shutters=i % 2 == 0, flowers=i < 4)
            z -= width / 2 + (0.0 if i % 2 else 3.2)
    trees = ["Scopia/acacia", "Scopia/peachBlossom", "Scopia/poplar", "Scopia/japaneseMaple"]
    for i in range(6):
        for side in (-1, 1):
            place(trees[(i + (side > 0)) % 4], side * 5.1, -3.5 - 11.5 * i, rng.randrange(360),
                  scale=0.62 if trees[(i + (side > 0)) % 4] == "Scopia/poplar" else 0.7)
    parked = ["KatorLegaz/VW-new-beetle", "KatorLegaz/concept-sedan-02", "BlendSwap-CC-BY/fordFocus",
              "KatorLegaz/concept-sedan-01v1", "Scopia/suv", "KatorLegaz/concept-sedan-02-sport", "Scopia/smart-car",
              "Scopia/van"]
    for i, car in enumerate(parked):
        place(car, -2.45, -2.6 - 6.6 * i, 0 if i % 3 else 180, 0.02)
        if i % 3 != 1:
            place(parked[(i + 3) % len(parked)], 2.45, -6.2 - 7.2 * i, 180, 0.02)
    place("Scopia/cityBus", -8.5, 9.4, 90, 0.03)
    place("KatorLegaz/concept-sedan-01v2", 9.5, 8.0, -90, 0.03)
    place("KatorLegaz/scooter", 4.6, 4.4, 160, 0.12)
    for i in range(5):
        for side in (-1, 1):
            place("KatorLegaz/classic-lamppost", side * 4.0, -9.3 - 11.5 * i, 0, 0.12, 1.5)
    place("KatorLegaz/fire-hydrant", 4.1, 0.6, 0, 0.12)
    place("KatorLegaz/residential-trashcan", -5.6, -13, 90, 0.12)
    place("BlendSwap-CC-0/mofx_mailbox", -4.1, 3.2, 0, 0.12, 1.3)
    for i, person in enumerate(("Reallusion/male01", "Reallusion/female02", "KatorLegaz/male-01-suit",
                                "Reallusion/girlStanding", "KatorLegaz/female-01-casual-clothing")):
        place(person, (-4.6, 4.7)[i % 2], 1.5 - 4.4 * i, (20, 170, 200, 340, 10)[i], 0.12)
    # The end of the street, and what stands behind the houses.
    for i in range(15):
        tree = ("Scopia/sycamoreMaple", "Scopia/poplar", "Scopia/copperBeech", "Scopia/pine")[i % 4]
        place(tree, -56 + 8 * i + rng.uniform(-2, 2), -84 + rng.uniform(-4, 4), rng.randrange(360), scale=1.3)
    for i in range(4):
        place("Scopia/sycamoreMaple", -22 - rng.uniform(0, 3), -6 - 17 * i, rng.randrange(360))
        place("Scopia/copperBeech", 22 + rng.uniform(0, 3), -10 - 17 * i, rng.randrange(360))
    for x in (-17, -24.5, 17.5):
        place("Scopia/pine", x, -1.5, rng.randrange(360), scale=1.3)
    for i in range(10):
        for side in (-1, 1):
            if i > 0:
                place("Scopia/hedgeTextured", side * (10.2 + 1.5 * i), 2.7, 0, 0.1)


def square(town):
    place, rng = town.place, town.rng
    floor = 0.125
    place("BlendSwap-CC-BY/fountain", -3.2, 22.5, 0, floor, 2.2)
    for turn in range(0, 360, 90):
        x, z = -3.2 + 4.4 * math.sin(math.radians(turn + 45)), 22.5 + 4.4 * math.cos(math.radians(turn + 45))
        place("Scopia/wood_bank", x, z, (turn + 45) % 360, floor, 0.9)
    # A cafe.
    for i, (x, z) in enumerate(((6.6, 17.2), (10.2, 18.6), (6.2, 21.6), (9.9, 23.0), (13.3, 16.8), (13.6, 21.2))):
        place("KatorLegaz/cafe-table", x, z, 0, floor)
        if i % 2 == 0:
            place("BlendSwap-CC-0/umbrella", x, z, 0, floor, 1.25)
        place("Scopia/bowlWithFruits" if i % 3 == 0 else "BlendSwap-CC-0/caffe_final", x, z, 0, floor + 0.7)
        start = rng.randrange(360)
        for k in range(3):
            angle = start + 120 * k
            sx, sz = x + 0.75 * math.sin(math.radians(angle)), z + 0.75 * math.cos(math.radians(angle))
            place("KatorLegaz/cafe-chair", sx, sz, (angle + 180) % 360, floor)
    for x, z, turn, person in ((3.2, 18.9, 250, "Reallusion/female01"), (0.9, 27.4, 190, "Reallusion/boyStanding"),
                               (1.7, 27.8, 215, "Reallusion/female03"), (-8.6, 18.0, 60, "Reallusion/male03"),
                               (-7.8, 18.6, 230, "Reallusion/male02"), (4.4, 24.9, 80, "Reallusion/holdingFemale01")):
        place(person, x, z, turn, floor)
    place("BlendSwap-CC-BY/bulldog", 2.6, 27.1, 200, floor)
    place("Scopia/dog", -8.8, 19.2, 100, floor)
    for i in range(4):
        place("BlendSwap-CC-BY/bike", -11.6 + 0.62 * i, 14.8, 6 * i, floor, 1.4)
    for i, tree in enumerate(("Scopia/ficusTree", "Scopia/peachBlossom", "Scopia/ficusTree", "Scopia/japaneseMaple")):
        place(tree, -12.5 + 0.4 * i, 18.5 + 4.8 * i, 70 * i, floor, 1.0 if i % 2 == 0 else 0.75)
        place("BlendSwap-CC-0/bench", -10.6 + 0.3 * i, 20.5 + 4.8 * i, 90, floor)
    for x in (-1.6, 1.4, 4.4):
        place("BlendSwap-CC-0/plantie", x, 14.2, 0, floor, 1.6)
    place("KatorLegaz/park-trashcan", 4.3, 14.6, 0, floor)
    for x in (-6.5, 15.5):
        place("KatorLegaz/park-light", x, 14.4, 180, floor, 1.4)


def files():
    town = Town()
    ground(town)
    street(town)
    square(town)
    mtl = "# Made by generate.py.\n" + "\n".join(
        f"newmtl {name}\nillum 2\nKd {r:g} {g:g} {b:g}\n" for name, (r, g, b) in COLORS.items())
    scene = HEAD + "".join(town.meshes)
    return {"town/town.toml": scene.encode(), "town/town.mtl": mtl.encode(), "town/town.obj": town.obj.encode()}
