#!/usr/bin/env python3
"""Renders the reference scenes with envers and, where they are installed, POV-Ray and Mitsuba 3.

    cargo build --release && python3 benches/peers/run.py

writes scenes, pictures, maps of their differences from envers in precision certified, `peers.json`,
`peers.md` and `peers.svg` into `out/peers`. Every round runs each renderer once, in turn, on as many
threads as the others; times are medians. Python's standard library (3.11) is enough.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time

import envers
import mi
import plot
import pov
from scene import Scene

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Done:
    """A process that has ended well: what it printed, and its time in seconds."""

    def __init__(self, command, folder):
        begin = time.perf_counter()
        child = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.text = child.stdout.read()
        (_, status, usage) = os.wait4(child.pid, 0)
        self.wall = time.perf_counter() - begin
        self.cpu = usage.ru_utime + usage.ru_stime
        child.returncode = os.waitstatus_to_exitcode(status)
        self.code = child.returncode


def run(command, folder=None, allowed=(0,)):
    done = Done(command, folder)
    if done.code not in allowed:
        sys.exit(f"{' '.join(command)}\nended with {done.code}:\n{done.text}")
    return done


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/peers")
    parser.add_argument("--size", default="1000x500", help="width and height of the pictures")
    parser.add_argument("--rounds", type=int, default=5, help="runs of each renderer (5)")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of each renderer")
    parser.add_argument("--scenes", default="s,m", help="which ones (s,m)")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    size = [int(n) for n in arguments.size.split("x")]
    out = arguments.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    if not envers.found():
        sys.exit(f"there is no {envers.PROGRAM}: {envers.HOW}")
    peers = [envers]
    for peer in (pov, mi):
        if peer.found():
            peers.append(peer)
        else:
            print(f"{peer.NAME} is left out, it is not installed: {peer.HOW}", file=sys.stderr)
    run([str(envers.GENERATOR), "make-reference", str(out)])
    report = {
        "size": size,
        "threads": arguments.threads,
        "rounds": arguments.rounds,
        "versions": {peer.NAME: peer.version(run) for peer in peers},
        "scenes": {
            name: compare(name, peers, size, arguments, out)
            for name in arguments.scenes.split(",")
        },
    }
    (out / "peers.json").write_text(json.dumps(report, indent=2) + "\n")
    table = markdown(report)
    (out / "peers.md").write_text(table)
    (out / "peers.svg").write_text(plot.svg(report))
    print(table)


def compare(name, peers, size, arguments, out):
    """Times of every peer on one scene, and how far its picture is from that of envers."""
    scene = Scene(out / f"{name}.toml")
    files = {peer: peer.write(scene, size, out, name) for peer in peers}
    picture = {peer: out / f"{name}-{peer.__name__}.exr" for peer in peers}
    runs = {peer: [] for peer in peers}
    for _ in range(arguments.rounds):
        for peer in peers:
            done = peer.render(run, files[peer], size, arguments.threads, picture[peer])
            runs[peer].append(done)
    reference = out / f"{name}-certified.exr"
    envers.render(run, files[envers], size, arguments.threads, reference, "certified")
    found = {}
    for peer in peers:
        median = lambda of: statistics.median(of(done) for done in runs[peer])
        found[peer.NAME] = {
            "wall": median(lambda done: done.wall),
            "cpu": median(lambda done: done.cpu),
            "render": median(lambda done: done.render),
            "notes": {k: median(lambda done: done.notes[k]) for k in runs[peer][0].notes},
        }
        heatmap = out / f"{name}-{peer.__name__}-difference.png"
        found[peer.NAME]["difference"] = envers.diff(run, reference, picture[peer], heatmap)
    return found


def markdown(report):
    (width, height) = report["size"]
    rows = [
        f"{width}×{height}, {report['threads']} threads, medians of {report['rounds']} in turn; "
        + ", ".join(f"{name} {version}" for name, version in report["versions"].items()),
        "",
        "| scene | renderer | process, s | its CPU time, s | render phase, s | RMSE | largest"
        " difference | pixels that differ by over 1/255 |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for scene, found in report["scenes"].items():
        for name, t in found.items():
            row = [scene.upper(), name] + [f"{t[key]:.3f}" for key in ("wall", "cpu", "render")]
            d = t["difference"]
            share = d["pixels_differing"] / (width * height)
            row += [f"{d['rmse']:.1e}", f"{d['max']:.1e}", f"{100 * share:.3f}%"]
            rows.append(f"| {' | '.join(row)} |")
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    main()
