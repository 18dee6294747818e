"""La sphère des parties I à III : python3 phong.py -o image.png

Il ne faut que vecteur.py et image.py à côté de ce fichier.
"""

import sys

from image import ecrire_png
from vecteur import *

longueur = 500
hauteur = 250
D = 250

O = vecteur(0, 0, 0)
fond = vecteur(50, 50, 50)
noir = vecteur(0, 0, 0)

boule = sphere(vecteur(0, 0, 10), 1, vecteur(52, 84, 216))
alpha = 50

lumiere = vecteur(-20, -25, -15)
couleur_lumiere = vecteur(255, 255, 255)


# I et II : le vecteur qui mène de l'observateur au pixel (x ; y)
def direction(x, y):
    return vecteur(x - longueur / 2, y - hauteur / 2, D)


# III : la couleur de ce que l'on voit dans une direction
def couleur(d):
    t = boule.intersection(O, d)
    if t is None:
        return fond
    M = O + t * d
    n = boule.normale(M)
    l = (lumiere - M).unitaire()
    cosinus = n.scalaire(l)
    if cosinus <= 0:
        return noir
    u = d.unitaire()
    r = u - 2 * u.scalaire(n) * n
    return boule.couleur * cosinus + couleur_lumiere * max(r.scalaire(l), 0) ** alpha


if len(sys.argv) != 3 or sys.argv[1] != "-o":
    sys.exit(__doc__)
image = [[couleur(direction(x, y)).rgb() for x in range(longueur)] for y in range(hauteur)]
ecrire_png(sys.argv[2], image)
