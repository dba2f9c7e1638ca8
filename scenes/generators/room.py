"""The Cornell box, which two scenes share: 0 to 555 on each axis, normals pointing inwards."""

SIDE = 555

FLOOR = [(0, 0, 0), (0, 0, SIDE), (SIDE, 0, SIDE), (SIDE, 0, 0)]
CEILING = [(0, SIDE, 0), (SIDE, SIDE, 0), (SIDE, SIDE, SIDE), (0, SIDE, SIDE)]
BACK = [(0, 0, SIDE), (0, SIDE, SIDE), (SIDE, SIDE, SIDE), (SIDE, 0, SIDE)]
FRONT = [(SIDE, 0, 0), (SIDE, SIDE, 0), (0, SIDE, 0), (0, 0, 0)]
LEFT = [(SIDE, 0, SIDE), (SIDE, SIDE, SIDE), (SIDE, SIDE, 0), (SIDE, 0, 0)]
RIGHT = [(0, 0, 0), (0, SIDE, 0), (0, SIDE, SIDE), (0, 0, SIDE)]

LIGHT = [(213, 554, 227), (343, 554, 227), (343, 554, 332), (213, 554, 332)]
