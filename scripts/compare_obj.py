#!/usr/bin/env python3
"""Holds what envers reads of OBJ files against trimesh, a reader by other people.

usage: compare_obj.py ENVERS FOLDER, in an environment with `pip install trimesh charset_normalizer`.

For each .obj file under the folder: triangles, corners of the box around them, materials in use and
whether faces have normals. Prints the files that differ, and how many agree. trimesh cuts a
polygon into as many triangles as envers does, n - 2.
"""

import json
import logging
import subprocess
import sys
from pathlib import Path

import numpy
import trimesh

logging.disable(logging.CRITICAL)


def ours(envers, path):
    run = subprocess.run([envers, "info", path, "--json", "-"], capture_output=True, text=True)
    if run.returncode != 0:
        return run.stderr.strip().splitlines()[0].split(": ", 1)[-1][-100:]
    info = json.loads(run.stdout)
    return {
        "triangles": info["geometry"]["triangles"],
        "bounds": info["bounds"],
        "materials": info["materials"],
        "normals": "smooth-normals" in info["needed"],
        "warnings": [w.split(": ", 1)[1] for w in info["warnings"]],
    }


def theirs(path):
    try:
        scene = trimesh.load_scene(str(path), file_type="obj", process=False)
    except BaseException as error:
        return f"{type(error).__name__}: {error}"[:100]
    meshes = [m for m in scene.geometry.values() if isinstance(m, trimesh.Trimesh) and len(m.faces)]
    names = {getattr(getattr(m.visual, "material", None), "name", None) for m in meshes}
    used = [m.vertices[m.faces.ravel()] for m in meshes]
    corners = numpy.vstack(used) if used else None
    return {
        "triangles": sum(len(m.faces) for m in meshes),
        "bounds": [corners.min(0).tolist(), corners.max(0).tolist()] if used else None,
        "materials": len(names),
        "normals": any("vertex_normals" in m._cache.cache for m in meshes),
    }


def differences(a, b):
    if isinstance(a, str) or isinstance(b, str):
        show = lambda x: x if isinstance(x, str) else f"{x['triangles']} triangles"
        return [] if isinstance(a, str) and isinstance(b, str) else [f"envers: {show(a)}", f"trimesh: {show(b)}"]
    found = [
        f"{key} {a[key]} / {b[key]}" for key in ("triangles", "materials", "normals") if a[key] != b[key]
    ]
    if a["bounds"] and b["bounds"] and not numpy.allclose(a["bounds"], b["bounds"], rtol=1e-5):
        found.append(f"box {a['bounds']} / {b['bounds']}")
    return found


def main():
    envers, folder = sys.argv[1], Path(sys.argv[2])
    files = sorted(folder.rglob("*.obj"))
    agree = 0
    for path in files:
        a, b = ours(envers, path), theirs(path)
        found = differences(a, b)
        agree += not found
        if found:
            print(f"| {path.relative_to(folder)} | {'; '.join(found)} |")
            for warning in a["warnings"] if isinstance(a, dict) else []:
                print(f"    {warning[:160]}")
    print(f"{agree} of {len(files)} files agree")


if __name__ == "__main__":
    main()
