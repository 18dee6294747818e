"""Mitsuba 3: writes the scene as XML and PLY, and runs `mi_render.py` on it."""

import array
import json
import os
import pathlib
import subprocess
import sys

NAME = "Mitsuba 3"
HOW = (
    "python3 -m venv V && V/bin/pip install mitsuba, and LLVM (14 is too old, 19 works: apt install"
    " libllvm19); MITSUBA_PYTHON=V/bin/python and, where it is not found,"
    " DRJIT_LIBLLVM_PATH=…/libLLVM.so.19.1 say where"
)
PYTHON = os.environ.get("MITSUBA_PYTHON", sys.executable)
RENDER = pathlib.Path(__file__).with_name("mi_render.py")

# Mitsuba has no infinite plane: half the side of the square that stands for it.
GROUND = 1e4


# An LLVM that is too old ends the process: this asks it for something new.
TRIAL = """
import drjit, mitsuba
mitsuba.set_variant("llvm_ad_rgb")
drjit.eval(drjit.maximum(drjit.opaque(mitsuba.Float, 1, 16), 0))
drjit.sync_thread()
"""


def found():
    trial = subprocess.run([PYTHON, "-c", TRIAL], capture_output=True)
    return trial.returncode == 0


def version(run):
    return run([PYTHON, "-c", "import mitsuba; print(mitsuba.__version__)"]).text.strip()


def write(scene, size, folder, name):
    """The scene file, with the plugins of `mi_render.py`: Phong, light without falloff."""
    c = scene.camera
    out = [
        '<scene version="3.0.0">',
        # Of a path's edges the last one is the shadow ray, and the first one comes from the eye.
        f'<integrator type="path"><integer name="max_depth" value="{scene.max_depth + 2}"/>'
        '<integer name="rr_depth" value="1000"/></integrator>',
        f'<sensor type="perspective"><string name="fov_axis" value="x"/>'
        f'<float name="fov" value="{c["fov_x"]}"/><float name="near_clip" value="1e-3"/>'
        f'<transform name="to_world"><lookat origin="{text(c["position"])}"'
        f' target="{text(c["look_at"])}" up="{text(c["up"])}"/></transform>',
        # One sample in the middle of each pixel.
        '<sampler type="stratified"><integer name="sample_count" value="1"/>'
        '<boolean name="jitter" value="false"/></sampler>',
        f'<film type="hdrfilm"><integer name="width" value="{size[0]}"/>'
        f'<integer name="height" value="{size[1]}"/><rfilter type="box"/>'
        '<string name="pixel_format" value="rgb"/>'
        '<string name="component_format" value="float32"/></film></sensor>',
        # It is seen, and lights nothing.
        f'<emitter type="constant"><rgb name="radiance" value="{text(scene.background)}"/>'
        '<float name="sampling_weight" value="0"/></emitter>',
    ]
    for light in scene.lights:
        out.append(
            f'<emitter type="steady"><point name="position" value="{text(light["position"])}"/>'
            '<rgb name="intensity" value="1"/></emitter>'
        )
    out += [bsdf(key, m) for key, m in scene.materials.items()]
    for s in scene.spheres:
        (x, y, z) = s["center"]
        out.append(
            f'<shape type="sphere"><point name="center" x="{x}" y="{y}" z="{z}"/>'
            f'<float name="radius" value="{s["radius"]}"/>{uses(s)}</shape>'
        )
    for p in scene.planes:
        tip = [a + b for a, b in zip(p["point"], p["normal"])]
        out.append(
            f'<shape type="rectangle"><transform name="to_world"><scale value="{GROUND}"/>'
            f'<lookat origin="{text(p["point"])}" target="{text(tip)}" up="0 0 1"/></transform>'
            f"{uses(p)}</shape>"
        )
    for i, m in enumerate(scene.meshes):
        ply(m, pathlib.Path(folder, f"{name}-{i}.ply"))
        out.append(
            f'<shape type="ply"><string name="filename" value="{name}-{i}.ply"/>'
            f'<boolean name="face_normals" value="true"/>{uses(m)}</shape>'
        )
    path = pathlib.Path(folder, f"{name}.xml")
    path.write_text("\n".join([*out, "</scene>"]) + "\n")
    return path


def bsdf(key, m):
    if any(m["transmit"]):
        body = (
            f'type="dielectric" id="{key}"><float name="int_ior" value="{m["ior"]}"/>'
            '<float name="ext_ior" value="1"/>'
        )
    elif any(m["reflect"]):
        body = (
            f'type="conductor" id="{key}"><string name="material" value="none"/>'
            f'<rgb name="specular_reflectance" value="{text(m["reflect"])}"/>'
        )
    else:
        body = (
            f'type="phong" id="{key}"><rgb name="diffuse" value="{text(m["diffuse"])}"/>'
            f'<rgb name="specular" value="{text(m["specular"])}"/>'
            f'<float name="shininess" value="{m["shininess"]}"/>'
        )
    return f"<bsdf {body}</bsdf>"


def uses(thing):
    return f'<ref id="{thing["material"]}"/>'


def ply(m, path):
    (p, i) = (m["positions"], m["indices"])
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(p) // 3}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(i) // 3}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = b"".join(b"\3" + i[k : k + 3].tobytes() for k in range(0, len(i), 3))
    path.write_bytes(head.encode() + array.array("f", p).tobytes() + faces)


def text(v):
    return ", ".join(repr(float(x)) for x in v)


def render(run, path, size, threads, picture):
    """One process for a picture, and another for frames that follow a first one."""

    def frames(count):
        return run(
            [PYTHON, str(RENDER), path.name, picture.name, str(threads), str(count)],
            folder=path.parent,
        )

    done = frames(1)
    done.notes = json.loads(done.text.splitlines()[-1])
    done.render = json.loads(frames(6).text.splitlines()[-1])["render"]
    return done
