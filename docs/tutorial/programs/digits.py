"""How many digits the formulas of chapter II keep, judged by exact whole numbers.

Every sphere and every ray below has whole coordinates, so that Python's integers, which never
round, give the right answer; what the formulas answer is held against it.
"""

from math import copysign, isqrt, sqrt


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def listing(OP, OC, r):
    """II.2: t² + bt + c = 0 for a unit vector u; the two distances, or None."""
    length, norm = sqrt(dot(OP, OP)), sqrt(dot(OC, OC))
    u = [x / length for x in OP]
    b = -2 * dot(u, OC)
    c = norm * norm - r * r
    delta = b * b - 4 * c
    if delta < 0:
        return None
    return (-b - sqrt(delta)) / 2, (-b + sqrt(delta)) / 2


def haines(OP, OC, r):
    """What envers does: the distance of the centre from the line, and the quotient c/q."""
    a = dot(OP, OP)
    middle = dot(OP, OC) / a
    h = [middle * d - x for d, x in zip(OP, OC)]
    delta = (r * r - dot(h, h)) / a
    if delta < 0:
        return None
    far = middle + copysign(sqrt(delta), middle)
    near = (dot(OC, OC) - r * r) / a / far
    norm = sqrt(a)
    return min(near, far) * norm, max(near, far) * norm


PLACES = 10**60


def exact(OP, OC, r):
    """The nearer distance times 10⁶⁰, cut to a whole number; None where the line misses."""
    a, b, c = dot(OP, OP), dot(OP, OC), dot(OC, OC) - r**2
    delta = b * b - a * c
    if delta < 0:
        return None
    # The distance is t·√a = (b − √delta) / √a, which is c·√a / (b + √delta).
    root = isqrt(delta * PLACES**2)
    return c * isqrt(a * PLACES**4) // (b * PLACES + root)


def judge(formula, rays, OC, r):
    """How many rays are called wrongly; of the others, the worst error of the distance over the
    distance itself, and over the radius."""
    wrong, share, radii = 0, 0, 0
    for OP in rays:
        true = exact(OP, OC, r)
        found = formula([float(x) for x in OP], [float(x) for x in OC], float(r))
        if (true is None) != (found is None):
            wrong += 1
        elif true is not None:
            above, below = found[0].as_integer_ratio()
            error = abs(above * PLACES - true * below)
            share = max(share, error / (true * below))
            radii = max(radii, error / (r * PLACES * below))
    return f"{wrong:6} {share:9.0e} {radii:9.0e}"


def tutorial():
    """The rays of the tutorial's own picture, about its sphere: 50 pixels in radius."""
    return [(x - 500, y - 250, 500) for x in range(440, 561) for y in range(190, 311)]


def telescope(k):
    """The same sphere as large in the picture, 10ᵏ radii away at (2, 3, 6)·10ᵏ."""
    e, f, g = (3, -6, 2), (6, 2, -3), (2, 3, 6)
    for x in range(-60, 61):
        for y in range(-60, 61):
            yield tuple(2 * x * e[i] + 2 * y * f[i] + 101 * 10**k * g[i] for i in range(3))


def walker():
    """Rays downward, to all sides."""
    return [(x, 100, z) for x in range(-300, 301, 5) for z in range(-300, 301, 5)]


def row(name, rays, OC, r):
    rays = list(rays)
    answers = "   ".join(judge(formula, rays, OC, r) for formula in (listing, haines))
    print(f"{name:>8} {len(rays):6}   {answers}")


print("                        II.2 (b² − 4ac)            envers")
print("     D/r   rays    wrong    of t      of r    wrong    of t      of r")
row("II.3", tutorial(), (0, 0, 10), 1)
for k in range(1, 11):
    row(f"1e{k}", telescope(k), (2 * 10**k, 3 * 10**k, 6 * 10**k), 7)
# An eye 1.75 m above a planet of 6371 km: in quarters of a metre, where the squares of the lengths
# have less than 53 bits and are exact; and in centimetres, where they are rounded.
row("m / 4", walker(), (0, 25484007, 0), 25484000)
row("cm", walker(), (0, 637100175, 0), 637100000)
