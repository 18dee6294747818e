"""envers itself: renders the scene file as it is, and compares pictures."""

import json
import pathlib

NAME = "envers"
RELEASE = pathlib.Path(__file__).resolve().parents[2] / "target/release"
PROGRAM = RELEASE / "envers"
GENERATOR = RELEASE / "xtask"
HOW = "cargo build --release && cargo build --release -p xtask"


def found():
    return PROGRAM.is_file() and GENERATOR.is_file()


def version(run):
    return run([str(PROGRAM), "--version"]).text.split()[1]


def write(scene, size, folder, name):
    return pathlib.Path(folder, f"{name}.toml")


def render(run, path, size, threads, picture, precision="fast"):
    statistics = picture.with_suffix(".json")
    done = run(
        [
            str(PROGRAM), "render", str(path), "-o", str(picture), "--stats", str(statistics),
            "--size", f"{size[0]}x{size[1]}", "--threads", str(threads), "--precision", precision,
            "--quiet",
        ]
    )  # fmt: skip
    done.notes = json.loads(statistics.read_text())["seconds"]
    done.render = done.notes["render"]
    return done


def diff(run, reference, picture, heatmap):
    """How far a picture is from the reference, in linear light; and a map of where."""
    done = run(
        [
            str(PROGRAM), "diff", str(reference), str(picture), "--tolerance", str(1 / 255),
            "--heatmap", str(heatmap), "--json", "-",
        ],
        allowed=(0, 1),
    )  # fmt: skip
    return json.loads(done.text)
