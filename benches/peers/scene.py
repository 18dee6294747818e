"""Reads what the reference scenes use of envers's scene file, for programs that read others."""

import array
import json
import math
import pathlib
import struct
import tomllib

KNOWN = {"film", "camera", "material", "sphere", "plane", "model", "light"}


class Scene:
    """A scene as plain values: colours linear, lengths as in the file, meshes in world space."""

    def __init__(self, path):
        path = pathlib.Path(path)
        table = tomllib.loads(path.read_text())
        if unknown := table.keys() - KNOWN:
            raise ValueError(f"{path}: {sorted(unknown)} is not handed to other renderers")
        film = table["film"]
        encoded = film.get("transfer", "srgb") == "srgb"
        self.background = color(film.get("background", 0), encoded)
        self.max_depth = film.get("max_depth", 8)
        self.camera = table["camera"]
        self.camera.setdefault("up", [0, 1, 0])
        self.materials = {m["name"]: material(m, encoded) for m in table["material"]}
        self.spheres = table.get("sphere", [])
        self.planes = table.get("plane", [])
        self.lights = table["light"]
        self.meshes = [mesh(path.parent, model) for model in table.get("model", [])]


def color(value, encoded):
    """Linear red, green and blue of one of the three ways to write a colour."""
    if isinstance(value, str):
        bytes_ = [int(value[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        return [linear(x) if encoded else x for x in bytes_]
    return [float(x) for x in value] if isinstance(value, list) else [float(value)] * 3


def linear(x):
    """The inverse of the sRGB curve."""
    return x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4


def material(table, encoded):
    defaults = {"diffuse": 0.8, "specular": 0, "reflect": 0, "transmit": 0}
    found = {key: color(table.get(key, d), encoded) for key, d in defaults.items()}
    kept = [1 - r - t for r, t in zip(found["reflect"], found["transmit"])]
    for key in ("diffuse", "specular"):
        found[key] = [k * x for k, x in zip(kept, found[key])]
    return found | {"shininess": table.get("shininess", 50), "ior": table.get("ior", 1.5)}


def mesh(folder, model):
    """The one mesh of a GLB in world space: coordinates and indices, flat, and its material."""
    data = (folder / model["file"]).read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    root = json.loads(data[20 : 20 + length])
    start = 20 + length + 8

    def values(index, code):
        accessor = root["accessors"][index]
        view = root["bufferViews"][accessor["bufferView"]]
        count = accessor["count"] * {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        offset = start + view.get("byteOffset", 0)
        return array.array(code, data[offset : offset + 4 * count])

    (primitive,) = root["meshes"][0]["primitives"]
    local = values(primitive["attributes"]["POSITION"], "f")
    (move, turn) = (model.get("translate", [0, 0, 0]), rotation(model.get("rotate", [0, 0, 0])))
    world = array.array("f")
    for i in range(0, len(local), 3):
        p = local[i : i + 3]
        world.extend(m + sum(a * x for a, x in zip(row, p)) for m, row in zip(move, turn))
    return {
        "positions": world,
        "indices": values(primitive["indices"], "I"),
        "material": model["material"],
    }


def rotation(degrees):
    """The matrix that turns about the fixed x axis, then y, then z."""
    (a, b, c) = (math.radians(x) for x in degrees)
    x = [[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]]
    y = [[math.cos(b), 0, math.sin(b)], [0, 1, 0], [-math.sin(b), 0, math.cos(b)]]
    z = [[math.cos(c), -math.sin(c), 0], [math.sin(c), math.cos(c), 0], [0, 0, 1]]
    return product(z, product(y, x))


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]
