"""Écrit une image au format PNG, sans numpy ni matplotlib."""

from struct import pack
from zlib import compress, crc32


def ecrire_png(nom, lignes):
    """Écrit l'image dont les lignes sont des listes de pixels, triplets d'octets."""

    def bloc(genre, contenu):
        somme = crc32(genre + contenu)
        return pack(">I", len(contenu)) + genre + contenu + pack(">I", somme)

    # un octet 0 devant chaque ligne : pas de filtre
    brut = b"".join(b"\0" + bytes(o for pixel in ligne for o in pixel) for ligne in lignes)
    entete = pack(">IIBBBBB", len(lignes[0]), len(lignes), 8, 2, 0, 0, 0)
    with open(nom, "wb") as fichier:
        fichier.write(b"\x89PNG\r\n\x1a\n")
        fichier.write(bloc(b"IHDR", entete))
        fichier.write(bloc(b"IDAT", compress(brut)))
        fichier.write(bloc(b"IEND", b""))
