"""The sphere of part III through a telescope, by II.2's formula: 10⁶, 10⁷ and 10⁸ radii away.

python3 far.py -o far.png
"""

import sys
from math import sqrt

from image import ecrire_png

SIDE = 240  # of each of the three pictures, in pixels
BACKGROUND, COLOR = (50, 50, 50), (58, 84, 216)

# The observer's axes, to the right, downward and ahead, each 7 long.
E, F, G = (3, -6, 2), (6, 2, -3), (2, 3, 6)
RADIUS = 7


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def unit(u):
    norm = sqrt(dot(u, u))
    return [x / norm for x in u]


def minus(u, v):
    return [x - y for x, y in zip(u, v)]


def combination(x, y, z):
    return [x * e + y * f + z * g for e, f, g in zip(E, F, G)]


def intersection(u, OC, r):
    """II.2, for a sphere in front of the observer."""
    norm = sqrt(dot(OC, OC))
    b = -2 * dot(u, OC)
    c = norm * norm - r * r
    delta = b * b - 4 * c
    return max((-b - sqrt(delta)) / 2, 0) if delta >= 0 else 0


def pixel(x, y, distance):
    center = combination(0, 0, distance)
    light = combination(-20, -25, distance - 25)
    u = unit(combination(x - SIDE / 2, y - SIDE / 2, 80.5 * distance))
    t = intersection(u, center, RADIUS)
    if t == 0:
        return BACKGROUND
    M = [t * x for x in u]
    cosine = max(dot(unit(minus(M, center)), unit(minus(light, M))), 0)
    return [round(channel * cosine) for channel in COLOR]


def row(y):
    distances = (10**6, 10**7, 10**8)
    return [pixel(x, y, d) for d in distances for x in range(SIDE)]


if len(sys.argv) != 3 or sys.argv[1] != "-o":
    sys.exit(__doc__)
ecrire_png(sys.argv[2], [row(y) for y in range(SIDE)])
