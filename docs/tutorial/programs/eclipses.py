"""Les images de 6-4-orbit.toml où tombe une éclipse, d'après la géométrie seule."""

from math import acos, asin, cos, pi, sin

from vecteur import *

images = 120
par_seconde = 24

soleil = vecteur(0, 0, 16)
planete = vecteur(6, 0, 16)
lune = vecteur(6, 0, 13.6)
R = 0.9
r = 0.25


def vectoriel(u, v):
    return vecteur(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x)


def tourner(v, axe, angle):
    """Le vecteur v, orthogonal à l'axe, tourné autour de lui."""
    return cos(angle) * v + sin(angle) * vectoriel(axe.unitaire(), v)


def positions(t):
    """La planète et la lune, vues du soleil, à l'instant t."""
    P = tourner(planete - soleil, vecteur(0, -1, 0), 2 * pi * t / 5)
    return P, P + tourner(lune - planete, vecteur(0.5, -1, 0), 2 * pi * t / 1.25)


def eclipse(t):
    """« de soleil », « de lune », ou None."""
    P, Q = positions(t)
    delta = acos(P.unitaire().scalaire(Q.unitaire()))
    if delta >= asin(R / P.norme()) + asin(r / Q.norme()):
        return None
    return "de soleil" if Q.norme() < P.norme() else "de lune"


if __name__ == "__main__":
    debut = None
    for n in range(1, images + 2):
        # au-delà de la dernière image, rien : cela termine l'éclipse en cours
        maintenant = eclipse((n - 1) / par_seconde) if n <= images else None
        if debut is not None and maintenant != debut[1]:
            print(f"éclipse {debut[1]} : images {debut[0]} à {n - 1}")
            debut = None
        if debut is None and maintenant is not None:
            debut = (n, maintenant)
