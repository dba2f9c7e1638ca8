"""Draws earth.png, a map of the world in equirectangular projection: longitude -180 on the left, north on top.

Coasts are the rough outlines of `earth_outlines`, blurred and then cut again
at a level that noise moves up and down: corners vanish, bays and capes appear.
"""

import math
import random
from itertools import accumulate

from . import png
from .earth_outlines import DESERTS, LAND, MOUNTAINS, WATER

WIDTH, HEIGHT = 1024, 512
SEED = 4

# Linear colours.
DEEP, SHALLOW = (0.010, 0.045, 0.130), (0.050, 0.210, 0.300)
JUNGLE, STEPPE, TAIGA = (0.045, 0.130, 0.030), (0.230, 0.230, 0.080), (0.070, 0.140, 0.060)
SAND, ROCK, ICE = (0.560, 0.400, 0.200), (0.300, 0.230, 0.170), (0.820, 0.860, 0.900)
LINES = (0.550, 0.480, 0.330)


def mix(a, b, t):
    return a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t


def ramp(x, low, high):
    """0 up to `low`, 1 from `high`, straight between."""
    return min(max((x - low) / (high - low), 0.0), 1.0)


def longitude(column):
    return (column + 0.5) * 360 / WIDTH - 180


def latitude(row):
    return 90 - (row + 0.5) * 180 / HEIGHT


def fill(mask, outline, value):
    """Sets the pixels whose centres lie in the polygon, by the even-odd rule."""
    for row in range(HEIGHT):
        lat = latitude(row)
        crossings = sorted(
            x0 + (lat - y0) * (x1 - x0) / (y1 - y0)
            for (x0, y0), (x1, y1) in zip(outline, outline[1:] + outline[:1])
            if (y0 > lat) != (y1 > lat)
        )
        for west, east in zip(crossings[::2], crossings[1::2]):
            first = max(math.ceil((west + 180) * WIDTH / 360 - 0.5), 0)
            last = min(math.ceil((east + 180) * WIDTH / 360 - 0.5), WIDTH)
            mask[row][first:last] = [value] * (last - first)


def window_sums(line, radius, wrap):
    """Sums of 2 * radius + 1 neighbours; beyond its ends the line wraps or repeats its last entry."""
    left, right = (line[-radius:], line[:radius]) if wrap else (line[:1] * radius, line[-1:] * radius)
    totals = list(accumulate(left + line + right, initial=0))
    return [high - low for low, high in zip(totals, totals[2 * radius + 1 :])]


def blur(field, radius):
    """Twice a box blur on both axes, which is close to a Gaussian. Zero stays exactly zero in a field of integers."""
    for _ in range(2):
        field = [window_sums(row, radius, True) for row in field]
        columns = [window_sums(list(column), radius, False) for column in zip(*field)]
        field = [list(row) for row in zip(*columns)]
    scale = (2 * radius + 1) ** -4
    return [[value * scale for value in row] for row in field]


def noise(cells, octaves, xi):
    """Value noise around 0, mostly within ±0.5, periodic in longitude, from `cells` cells around the equator up."""
    field = [[-1.0] * WIDTH for _ in range(HEIGHT)]
    amplitude = 1 / (1 - 0.5**octaves)
    for _ in range(octaves):
        lattice = [[xi() for _ in range(cells)] for _ in range(cells // 2 + 2)]
        columns = []
        for column in range(WIDTH):
            x = column * cells / WIDTH
            t = x % 1
            columns.append((int(x), (int(x) + 1) % cells, t * t * (3 - 2 * t)))
        for row in range(HEIGHT):
            y = row * cells / WIDTH
            t = y % 1
            t = t * t * (3 - 2 * t)
            line = [a + (b - a) * t for a, b in zip(lattice[int(y)], lattice[int(y) + 1])]
            field[row] = [
                total + amplitude * (line[i] + (line[j] - line[i]) * s)
                for total, (i, j, s) in zip(field[row], columns)
            ]
        cells, amplitude = cells * 2, amplitude / 2
    return field


def spots(ellipses):
    """1 in the middle of each ellipse, falling to 0 a little outside its outline."""
    field = [[0.0] * WIDTH for _ in range(HEIGHT)]
    for lon, lat, rx, ry in ellipses:
        for row in range(HEIGHT):
            dy = (latitude(row) - lat) / ry
            if abs(dy) < 1:
                reach = rx * math.sqrt(1 - dy * dy)
                for column in range(WIDTH):
                    dx = longitude(column) - lon
                    if abs(dx) < reach:
                        field[row][column] = max(field[row][column], 1 - (dx / rx) ** 2 - dy**2)
    return blur(field, 3)


def land_color(lat, lon, desert, mountain, n):
    north = abs(lat) + 12 * n
    color = mix(JUNGLE, STEPPE, ramp(north, 12, 34))
    color = mix(color, TAIGA, ramp(north, 38, 54))
    color = mix(color, SAND, ramp(desert + 0.6 * n, 0.05, 0.5))
    color = mix(color, ROCK, ramp(mountain + 0.5 * n, 0.1, 0.5))
    color = mix(color, ICE, ramp(mountain + 0.8 * n, 0.55, 0.9))
    greenland = 1.2 - ((lon + 42) / 15) ** 2 - ((lat - 73) / 12) ** 2
    return mix(color, ICE, max(ramp(north, 72, 78), ramp(-lat, 58, 61), ramp(greenland + 0.3 * n, 0.1, 0.3)))


def on_graticule(row, column):
    """Whether the pixel holds a meridian or a parallel of the 15 degree grid; meridians stop short of the poles."""
    meridian = (column * 24) % WIDTH < 24 and abs(latitude(row)) < 75
    return meridian or (row * 12) % HEIGHT < 12


def draw():
    """The map as a PNG."""
    xi = random.Random(SEED).random
    mask = [[0] * WIDTH for _ in range(HEIGHT)]
    for outline in LAND.values():
        fill(mask, outline, 1)
    for outline in WATER.values():
        fill(mask, outline, 0)
    coast, shelf = blur(mask, 2), blur(mask, 9)
    coast_noise, cover_noise = noise(64, 4, xi), noise(32, 5, xi)
    desert, mountain = spots(DESERTS), spots(MOUNTAINS)

    lons = [longitude(column) for column in range(WIDTH)]
    rows = []
    for row in range(HEIGHT):
        lat = latitude(row)
        line = bytearray()
        for column in range(WIDTH):
            n = cover_noise[row][column]
            land = ramp(coast[row][column] + 0.5 * coast_noise[row][column], 0.36, 0.52)
            color = mix(DEEP, SHALLOW, ramp(shelf[row][column] + 0.2 * n, 0, 0.6))
            color = mix(color, ICE, max(ramp(lat + 5 * n, 80, 82), ramp(-lat + 5 * n, 67, 69)))
            if land > 0 and shelf[row][column] > 0:
                color = mix(color, land_color(lat, lons[column], desert[row][column], mountain[row][column], n), land)
            if on_graticule(row, column):
                color = mix(color, LINES, 0.3)
            shade = 1 + 0.2 * n
            line += bytes([png.srgb8(color[0] * shade), png.srgb8(color[1] * shade), png.srgb8(color[2] * shade)])
        rows.append(bytes(line))
    return png.encode(WIDTH, rows)
