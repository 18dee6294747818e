"""La scène d'ombres.py, où tout reflète un peu : python3 reflets.py -o image.png"""

from ombres import *

part = {bleue: 0.4, orange: 0.2, sol: 0.3}


def couleur(A, u, quitte, profondeur):
    rencontre = premier(A, u, quitte)
    if rencontre is None:
        return fond
    t, objet = rencontre
    M = A + t * u
    rho = part[objet]
    propre = eclairage(objet, M) * (1 - rho)
    if profondeur == 0:
        return propre
    n = objet.normale(M)
    r = u - 2 * u.scalaire(n) * n
    return propre + couleur(M, r, objet, profondeur - 1) * rho


if __name__ == "__main__":
    dessiner(lambda u: couleur(O, u, None, 8))
