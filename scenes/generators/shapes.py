"""Solids that the scenes are made of. Faces are anticlockwise seen from outside."""

import math


def square(half, y):
    """Corners of a level square around the y axis, anticlockwise seen from above."""
    return [(-half, y, half), (half, y, half), (half, y, -half), (-half, y, -half)]


def loop(corners):
    """Neighbouring pairs, the last with the first."""
    return zip(corners, corners[1:] + corners[:1])


def prism(obj, bottom, top, **attributes):
    """The sides and ends between two polygons with equally many corners, anticlockwise seen from above."""
    for (a, b), (d, c) in zip(loop(bottom), loop(top)):
        obj.face([a, b, c, d], **attributes)
    obj.face(top, **attributes)
    obj.face(bottom[::-1], **attributes)


def circle(x, y, z, radius, sides, phase=0.0):
    """Corners of a level regular polygon, anticlockwise seen from above."""
    angles = [2 * math.pi * i / sides + phase for i in range(sides)]
    return [(x + radius * math.cos(a), y, z - radius * math.sin(a)) for a in angles]


def unit(v):
    length = math.hypot(*v)
    return tuple(c / length for c in v)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def turned(obj, profile, sides, origin=(0, 0, 0), rotate=lambda p: p):
    """A surface of revolution about the y axis with smooth normals, as from a lathe.

    `profile` lists (radius, y) from the bottom up; radius 0 closes an end.
    Edges sharper than 50 degrees stay sharp. The solid is rotated, then moved to `origin`.
    """
    slopes = [unit((y1 - y0, r0 - r1)) for (r0, y0), (r1, y1) in zip(profile, profile[1:])]

    def corner(i, end, angle):
        """The point and normal at one `end` (0 lower, 1 upper) of profile segment i."""
        r, y = profile[i + end]
        n = slopes[i]
        neighbour = i + (1 if end else -1)
        if 0 <= neighbour < len(slopes):
            m = slopes[neighbour]
            if n[0] * m[0] + n[1] * m[1] > math.cos(math.radians(50)):
                n = unit((n[0] + m[0], n[1] + m[1]))
        cos, sin = math.cos(angle), -math.sin(angle)
        point = rotate((r * cos, y, r * sin))
        return tuple(o + p for o, p in zip(origin, point)), rotate((n[0] * cos, n[1], n[0] * sin))

    for i, ((r0, _), (r1, _)) in enumerate(zip(profile, profile[1:])):
        for side in range(sides):
            a, b = 2 * math.pi * side / sides, 2 * math.pi * ((side + 1) % sides) / sides
            corners = [corner(i, 0, a), corner(i, 0, b), corner(i, 1, b), corner(i, 1, a)]
            if r0 == 0:
                del corners[1]
            if r1 == 0:
                del corners[-1]
            points, normals = zip(*corners)
            obj.face(points, normals=normals)
