"""POV-Ray: writes the scene, runs the program, reads what it says of its time."""

import math
import pathlib
import re
import shutil

from scene import cross, minus, unit

NAME = "POV-Ray"
HOW = "apt install povray"


def found():
    return shutil.which("povray")


def version(run):
    text = run(["povray", "--version"]).text
    return re.search(r"POV-Ray (\d+[\d.]*\d)", text)[1]


def write(scene, size, folder, name):
    """The scene file: no gamma, no falloff, no ambient light, Phong and Fresnel as in envers."""
    out = [
        "#version 3.7;",
        "global_settings { assumed_gamma 1 ambient_light 0 adc_bailout 0"
        f" max_trace_level {scene.max_depth + 1} }}",
        f"background {{ rgb {vector(scene.background)} }}",
        camera(scene.camera, size),
    ]
    for light in scene.lights:
        out.append(f"light_source {{ {vector(light['position'])}, rgb 1 }}")
    for key, m in scene.materials.items():
        out.append(f"#declare M_{ident(key)} = {texture(m)}")
    for s in scene.spheres:
        out.append(f"sphere {{ {vector(s['center'])}, {s['radius']!r} {uses(scene, s)} }}")
    for p in scene.planes:
        (n, q) = (unit(p["normal"]), p["point"])
        distance = sum(a * b for a, b in zip(n, q))
        out.append(f"plane {{ {vector(n)}, {distance!r} {uses(scene, p)} }}")
    for m in scene.meshes:
        out.append(mesh(m) + uses(scene, m) + " }")
    path = pathlib.Path(folder, f"{name}.pov")
    path.write_text("\n".join(out) + "\n")
    return path


def camera(c, size):
    """A camera by its three vectors: these also say that the picture is not mirrored."""
    forward = unit(minus(c["look_at"], c["position"]))
    right = unit(cross(forward, c["up"]))
    up = cross(right, forward)
    half = math.tan(math.radians(c["fov_x"]) / 2)
    width = [2 * half * x for x in right]
    height = [2 * half * size[1] / size[0] * x for x in up]
    return (
        f"camera {{ perspective location {vector(c['position'])} direction {vector(forward)}"
        f" right {vector(width)} up {vector(height)} }}"
    )


def texture(m):
    grey = lambda c: c[0]  # Phong's highlight has the light's colour, times one number.
    finish = f"ambient 0 diffuse 1 phong {grey(m['specular'])} phong_size {m['shininess']}"
    pigment = f"rgb {vector(m['diffuse'])}"
    if any(m["reflect"]):
        finish += f" reflection {{ rgb {vector(m['reflect'])} }}"
    if any(m["transmit"]):
        finish += " reflection { 0, 1 fresnel on } conserve_energy"
        (r, g, b) = m["transmit"]
        pigment = f"rgbf <{r}, {g}, {b}, 1>"
    return f"texture {{ pigment {{ {pigment} }} finish {{ {finish} }} }}"


def uses(scene, thing):
    m = scene.materials[thing["material"]]
    inside = f" interior {{ ior {m['ior']} }}" if any(m["transmit"]) else ""
    return f"texture {{ M_{ident(thing['material'])} }}{inside}"


def mesh(m):
    (p, i) = (m["positions"], m["indices"])
    points = (f"<{p[k]:.9g},{p[k + 1]:.9g},{p[k + 2]:.9g}>" for k in range(0, len(p), 3))
    faces = (f"<{i[k]},{i[k + 1]},{i[k + 2]}>" for k in range(0, len(i), 3))
    return (
        f"mesh2 {{ vertex_vectors {{ {len(p) // 3}, {', '.join(points)} }}\n"
        f"face_indices {{ {len(i) // 3}, {', '.join(faces)} }}\n"
    )


def ident(name):
    return re.sub(r"\W", "_", name)


def vector(v):
    return "<" + ", ".join(repr(float(x)) for x in v) + ">"


def render(run, path, size, threads, picture):
    """Without anti-aliasing; an EXR is linear whatever the gamma."""
    done = run(
        [
            "povray", f"+I{path.name}", f"+O{picture.name}", "+FE", f"+W{size[0]}", f"+H{size[1]}",
            f"+WT{threads}", "-A", "-D", "-P", "+Q9",
        ],
        folder=path.parent,
    )  # fmt: skip
    times = dict(re.findall(r"(Parse|Bounding|Trace) Time:.*?\(([\d.]+) seconds\)", done.text))
    done.render = float(times["Trace"])
    done.notes = {key.lower(): float(x) for key, x in times.items()}
    return done
