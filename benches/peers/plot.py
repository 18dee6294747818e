"""The table as a picture: time against difference, both logarithmic, in SVG."""

import html
import math

COLORS = ["#1b6ac9", "#c9431b", "#2a8c4a", "#8a5fbf"]
(LEFT, TOP, WIDE, HIGH) = (70, 40, 330, 240)
# Differences below are drawn on the lowest line: an EXR of halves is no finer.
LEAST = 1e-5


def svg(report):
    scenes = report["scenes"]
    width = LEFT + (WIDE + LEFT) * len(scenes)
    names = list(report["versions"])
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {TOP + HIGH + 90}"'
        f' width="{width}" font-family="sans-serif" font-size="12" fill="#222">',
        '<rect width="100%" height="100%" fill="#fff"/>',
    ]
    rows = [t for found in scenes.values() for t in found.values()]
    x_range = decades([t[key] for t in rows for key in ("cpu", "render")])
    y_range = decades([LEAST] + [t["difference"]["rmse"] for t in rows])
    for i, (name, found) in enumerate(scenes.items()):
        out.append(f'<g transform="translate({LEFT + i * (WIDE + LEFT)} {TOP})">')
        title = html.escape(name.upper())
        out.append(f'<text x="{WIDE / 2}" y="-14" text-anchor="middle">{title}</text>')
        out += axes(x_range, y_range)
        for peer, t in found.items():
            color = COLORS[names.index(peer)]
            y = HIGH - along(max(t["difference"]["rmse"], LEAST), y_range) * HIGH
            (a, b) = (along(t[key], x_range) * WIDE for key in ("render", "cpu"))
            out.append(f'<path d="M{a:.1f} {y:.1f}H{b:.1f}" stroke="{color}"/>')
            out.append(f'<circle cx="{a:.1f}" cy="{y:.1f}" r="5" fill="{color}"/>')
            out.append(f'<circle cx="{b:.1f}" cy="{y:.1f}" r="5" fill="#fff" stroke="{color}"/>')
            label = html.escape(peer)
            out.append(f'<text x="{a:.1f}" y="{y - 9:.1f}" fill="{color}">{label}</text>')
        out.append("</g>")
    out.append(
        f'<text x="{LEFT}" y="{TOP + HIGH + 70}">filled: render phase; hollow: CPU time of the whole'
        " process. Down: RMSE from envers, certified.</text></svg>"
    )
    return "\n".join(out) + "\n"


def decades(values):
    """The whole powers of ten around what is above 0."""
    logs = [math.log10(v) for v in values if v > 0]
    return (math.floor(min(logs)), math.ceil(max(logs)))


def along(value, span):
    return (math.log10(value) - span[0]) / (span[1] - span[0])


def axes(x_range, y_range):
    out = [f'<path d="M0 0V{HIGH}H{WIDE}" fill="none" stroke="#222"/>']
    for power in range(x_range[0], x_range[1] + 1):
        x = along(10.0**power, x_range) * WIDE
        label = f"{10.0**power:g} s"
        out.append(f'<path d="M{x:.1f} 0V{HIGH}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{HIGH + 18}" text-anchor="middle">{label}</text>')
    for power in range(y_range[0], y_range[1] + 1):
        y = HIGH - along(10.0**power, y_range) * HIGH
        label = f"≤ {LEAST:g}" if 10.0**power <= LEAST else f"{10.0**power:g}"
        out.append(f'<path d="M0 {y:.1f}H{WIDE}" stroke="#ddd"/>')
        out.append(f'<text x="-8" y="{y + 4:.1f}" text-anchor="end">{label}</text>')
    return out
