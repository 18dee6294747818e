"""Les trois classes du tutoriel : vecteur, sphere, plan.

À garder dans le même dossier que le programme qui commence par « from vecteur import * ».
Rien n'est à installer : seul le module math de python est utilisé.
"""

from math import floor, sqrt

__all__ = ["vecteur", "sphere", "plan"]


class vecteur:
    """Un vecteur de l'espace, un point (celui que le vecteur atteint depuis O), ou une couleur."""

    def __init__(self, x, y, z):
        self.x = x
        self.y = y
        self.z = z

    def __repr__(self):
        return f"vecteur({self.x}, {self.y}, {self.z})"

    def __eq__(self, v):
        if not isinstance(v, vecteur):
            return NotImplemented
        return (self.x, self.y, self.z) == (v.x, v.y, v.z)

    def __add__(self, v):
        if not isinstance(v, vecteur):
            return NotImplemented
        return vecteur(self.x + v.x, self.y + v.y, self.z + v.z)

    def __sub__(self, v):
        if not isinstance(v, vecteur):
            return NotImplemented
        return vecteur(self.x - v.x, self.y - v.y, self.z - v.z)

    def __neg__(self):
        return vecteur(-self.x, -self.y, -self.z)

    def __mul__(self, k):
        # u * k, où k est un nombre : le produit de deux vecteurs aurait deux sens
        if isinstance(k, vecteur):
            return NotImplemented
        return vecteur(self.x * k, self.y * k, self.z * k)

    # k * u : python essaie d'abord k.__mul__(u), puis u.__rmul__(k)
    __rmul__ = __mul__

    def __truediv__(self, k):
        if isinstance(k, vecteur):
            return NotImplemented
        return vecteur(self.x / k, self.y / k, self.z / k)

    def scalaire(self, v):
        return self.x * v.x + self.y * v.y + self.z * v.z

    def norme(self):
        return sqrt(self.scalaire(self))

    def unitaire(self):
        return self / self.norme()

    def rgb(self):
        """Les trois octets d'un pixel : arrondis au plus proche, et ramenés entre 0 et 255."""
        return tuple(min(max(floor(c + 0.5), 0), 255) for c in (self.x, self.y, self.z))


class sphere:
    """La sphère de centre Omega et de rayon r."""

    def __init__(self, centre, rayon, couleur):
        self.centre = centre
        self.rayon = rayon
        self.couleur = couleur

    def intersection(self, A, u):
        """Le plus petit t > 0 tel que A + t u soit sur la sphère, ou None."""
        f = A - self.centre
        a = u.scalaire(u)
        milieu = -f.scalaire(u) / a
        # H est le point de la droite le plus proche du centre
        H = f + milieu * u
        reste = self.rayon**2 - H.scalaire(H)
        if reste < 0:
            return None
        demi_corde = sqrt(reste / a)
        for t in (milieu - demi_corde, milieu + demi_corde):
            if t > 0:
                return t
        return None

    def normale(self, M):
        return (M - self.centre) / self.rayon

    def couleur_en(self, M):
        return self.couleur


class plan:
    """Le plan qui passe par A et dont n est un vecteur normal ; à carreaux s'il a deux couleurs."""

    def __init__(self, A, n, couleur, autre_couleur=None):
        self.A = A
        self.n = n.unitaire()
        self.couleur = couleur
        self.autre_couleur = autre_couleur

    def intersection(self, B, u):
        """Le t > 0 tel que B + t u soit dans le plan, ou None."""
        pente = u.scalaire(self.n)
        if pente == 0:
            return None
        t = (self.A - B).scalaire(self.n) / pente
        return t if t > 0 else None

    def normale(self, M):
        return self.n

    def couleur_en(self, M):
        if self.autre_couleur is None:
            return self.couleur
        # un sol : les carreaux, de côté 1, se comptent selon x et z
        carreau = floor(M.x - self.A.x) + floor(M.z - self.A.z)
        return self.couleur if carreau % 2 == 0 else self.autre_couleur
