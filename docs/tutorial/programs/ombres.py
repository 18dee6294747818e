"""Deux sphères, un sol à carreaux, leurs ombres : python3 ombres.py -o image.png

Il ne faut que vecteur.py et image.py à côté de ce fichier.
"""

import sys

from image import ecrire_png
from vecteur import *

longueur = 400
hauteur = 200
D = 200

fond = vecteur(50, 50, 50)
noir = vecteur(0, 0, 0)
lumiere = vecteur(-20, -25, -15)
O = vecteur(0, 0, 0)

bleue = sphere(vecteur(0, 0, 5), 1, vecteur(52, 84, 216))
orange = sphere(vecteur(-1.06, -0.8, 3.94), 0.4, vecteur(216, 116, 52))
# le coin des carreaux est décalé : aucun rayon ne tombe juste entre deux carreaux
sol = plan(vecteur(0.37, 1, 0.37), vecteur(0, -1, 0), vecteur(230, 230, 230), vecteur(90, 90, 90))
objets = [bleue, orange, sol]


def direction(x, y):
    return vecteur(x - longueur / 2, y - hauteur / 2, D)


def premier(A, u, quitte=None):
    """L'objet que la demi-droite rencontre d'abord, avec le t de la rencontre."""
    rencontres = [(objet.intersection(A, u), objet) for objet in objets if objet is not quitte]
    rencontres = [(t, objet) for t, objet in rencontres if t is not None]
    return min(rencontres, key=lambda rencontre: rencontre[0], default=None)


def a_l_ombre(M, ML, quitte):
    """Y a-t-il un objet entre M et L ? L'objet que le rayon quitte n'est pas interrogé."""
    for objet in objets:
        if objet is not quitte:
            t = objet.intersection(M, ML)
            if t is not None and t < 1:
                return True
    return False


def eclairage(objet, M):
    """La couleur que la source donne au point M de l'objet."""
    ML = lumiere - M
    cosinus = objet.normale(M).scalaire(ML.unitaire())
    if cosinus <= 0 or a_l_ombre(M, ML, objet):
        return noir
    return objet.couleur_en(M) * cosinus


def couleur(u):
    rencontre = premier(O, u)
    if rencontre is None:
        return fond
    t, objet = rencontre
    return eclairage(objet, O + t * u)


def dessiner(couleur):
    """Demande sa couleur à chaque pixel, et écrit l'image sous le nom qui suit -o."""
    image = [
        [couleur(direction(x, y)).rgb() for x in range(longueur)] for y in range(hauteur)
    ]
    if len(sys.argv) != 3 or sys.argv[1] != "-o":
        sys.exit(f"python3 {sys.argv[0]} -o image.png")
    ecrire_png(sys.argv[2], image)


if __name__ == "__main__":
    dessiner(couleur)
