"""De combien faut-il sauter pour qu'une sphère ne se fasse pas d'ombre à elle-même ?

Pour chaque ε : la part des points éclairés que leur propre sphère cache, près de l'origine puis
très loin d'elle, et la part de ceux qu'une coque opaque, un millionième de rayon plus grande, laisse
voir la source. Il faudrait trois fois 0 %.
"""

from vecteur import *


def points_eclaires(oeil, boule, L):
    """Les points de la boule que l'œil voit et qui sont tournés vers la source."""
    for x in range(-60, 61):
        for y in range(-60, 61):
            u = vecteur(x + 0.25, y + 0.25, 180).unitaire()
            t = boule.intersection(oeil, u)
            if t is not None:
                M = oeil + t * u
                if boule.normale(M).scalaire(L - M) > 0:
                    yield M


def arrete(objet, M, L, epsilon):
    """Le rayon d'ombre rencontre-t-il l'objet, si l'on saute ce qui est avant epsilon ?"""
    ML = L - M
    t = objet.intersection(M + epsilon * ML, ML)
    return t is not None and t < 1 - epsilon


def scene(distance):
    """L'œil, la boule, la coque, la source et les points, à cette distance de l'origine."""
    oeil = vecteur(0, 0, distance)
    centre = oeil + vecteur(0, 0, 3)
    boule = sphere(centre, 1, None)
    coque = sphere(centre, 1 + 1e-6, None)
    L = oeil + vecteur(-20, -25, -15)
    return boule, coque, L, list(points_eclaires(oeil, boule, L))


def pourcentage(reponses):
    return f"{100 * sum(reponses) / len(reponses):5.1f} %"


pres = scene(0)
loin = scene(1e9)
print("     ε   elle-même   elle-même, au loin   à travers la coque")
for epsilon in (0, 1e-12, 1e-9, 1e-6):
    colonnes = []
    for boule, coque, L, points in (pres, loin):
        colonnes.append(pourcentage([arrete(boule, M, L, epsilon) for M in points]))
    boule, coque, L, points = pres
    colonnes.append(pourcentage([not arrete(coque, M, L, epsilon) for M in points]))
    print(f"{epsilon:6g} {colonnes[0]:>11} {colonnes[1]:>20} {colonnes[2]:>20}")
