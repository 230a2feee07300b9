"""Has other programs read what umbrage draws on paper: resvg, Inkscape and vpype.

    python scripts/paper-check.py [--umbrage target/release/umbrage] [--models ../shared/models] [STYLE ..]

Needs Pillow, numpy and resvg-py; uses `inkscape` and `vpype` where they are found (or --vpype FILE).
For each style a tree is drawn as bitmap and as vectors at the same scale; the table has

    resvg      share of inked pixels of the bitmap or of the rasterised file that have ink of the
               other within a pixel (measure M8; at least 0.97)
    inkscape   the same between Inkscape's and resvg's pictures of the file (at least 0.97)
    layers     layers as the file names them, as vpype reads them
    repeats    duplicate lines that vpype's `linemerge` and a search by 0.1 mm find (plotter profile; 0)

and the program ends with 1 where a limit is missed.
"""
import argparse
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile

import numpy
import resvg_py
from PIL import Image

RESOLUTION, MARGIN = 6.0, 12.0


def run(*words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
    return done.stdout


def near(mask):
    wide = mask.copy()
    for y in (-1, 0, 1):
        for x in (-1, 0, 1):
            wide |= numpy.roll(numpy.roll(mask, x, 1), y, 0)
    return wide


def agreement(a, b):
    return ((a & near(b)) | (b & near(a))).sum() / max(1, (a | b).sum())


def ink(picture, linear=False):
    """Pixels of which black ink covers two fifths or more. umbrage's bitmaps blend light, files of
    vectors are drawn by blending encoded values, so that the same coverage is darker there."""
    paper = 1 - 0.4
    grey = 1.055 * paper ** (1 / 2.4) - 0.055 if linear else paper
    return numpy.asarray(picture.convert("L")) < 255 * grey


def rasterised(text, size):
    """The part of an A4 sheet within the margins, by resvg."""
    box = f"{MARGIN} {MARGIN} {size[0] / RESOLUTION} {size[1] / RESOLUTION}"
    head = f'width="{size[0]}" height="{size[1]}" viewBox="{box}"'
    text = re.sub(r'width="[\d.]+mm" height="[\d.]+mm" viewBox="[^"]*"', head, text, count=1)
    data = resvg_py.svg_to_bytes(svg_string=text, background="white", dpi=96)
    return ink(Image.open(io.BytesIO(bytes(data))))[: size[1], : size[0]]


def inkscape(file, folder, size):
    if not shutil.which("inkscape"):
        return None
    out = f"{folder}/inkscape.png"
    area = ":".join(str(v * 96 / 25.4) for v in (MARGIN, 297 - MARGIN - size[1] / RESOLUTION,
                                                MARGIN + size[0] / RESOLUTION, 297 - MARGIN))
    subprocess.run(["inkscape", "--export-type=png", f"--export-filename={out}", f"--export-area={area}",
                    f"--export-width={size[0]}", "--export-background=white", file], capture_output=True, check=True)
    return ink(Image.open(out))[: size[1], : size[0]]


def segments(text):
    """Straight pieces of every path, curves as eight pieces, rounded to 0.01 mm."""
    number = r"-?[\d.]+"
    for d in re.findall(r' d="([^"]*)"', text):
        at = start = None
        for letter, rest in re.findall(r"([MLHVCZ])([^MLHVCZ]*)", d):
            v = [float(x) for x in re.findall(number, rest)]
            if letter == "M":
                at = start = tuple(v[:2])
                v, letter = v[2:], "L"
            if letter == "L":
                for p in zip(v[0::2], v[1::2]):
                    yield at, p
                    at = p
            elif letter in "HV":
                for x in v:
                    p = (x, at[1]) if letter == "H" else (at[0], x)
                    yield at, p
                    at = p
            elif letter == "C":
                for k in range(0, len(v), 6):
                    q = numpy.array([at, v[k:k + 2], v[k + 2:k + 4], v[k + 4:k + 6]])
                    for s in range(1, 9):
                        t = s / 8
                        w = numpy.array([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t ** 3])
                        p = tuple(w @ q)
                        yield at, p
                        at = p
            elif letter == "Z" and at != start:
                yield at, start
                at = start


def repeats(text):
    """Length of line, in parts, that lies within 0.1 mm along another piece of the same direction."""
    cells, found = {}, 0
    for k, (a, b) in enumerate(segments(text)):
        a, b = numpy.array(a), numpy.array(b)
        way = b - a
        length = numpy.hypot(*way)
        if length < 1.0:
            continue  # short pieces of curves cross and touch; overlap shows on long ones
        middle = (a + b) / 2
        key = tuple((middle / 0.1).astype(int))
        for x in (-1, 0, 1):
            for y in (-1, 0, 1):
                for other, unit, reach in cells.get((key[0] + x, key[1] + y), ()):
                    if abs(unit[0] * way[1] - unit[1] * way[0]) < 0.02 * length and numpy.hypot(*(other - middle)) < 0.1:
                        found += 1
        cells.setdefault(key, []).append((middle, way / length, length))
    return found


def layers(text):
    return re.findall(r'inkscape:label="([^"]*)"', text)


def read_layers(vpype, file):
    if not vpype:
        return None
    return re.findall(r"svg_inkscape_label: '([^']*)'", run(vpype, "read", file, "stat"))


def check(style, args, folder):
    model = f"{args.models}/eztree/oak_medium.glb"
    size = [round((210 - 2 * MARGIN) * RESOLUTION), round((297 - 2 * MARGIN) * RESOLUTION)]
    bitmap, svg, plot = f"{folder}/b.png", f"{folder}/v.svg", f"{folder}/p.svg"
    run(args.umbrage, "render", model, "-o", bitmap, "--style", style,
        "--paper", "a4", "--ink-supersample", 1)
    run(args.umbrage, "render", model, "-o", svg, "--style", style, "--paper", "a4", "--profile", "print")
    run(args.umbrage, "render", model, "-o", plot, "--style", style, "--paper", "a4", "--profile", "plotter")
    text, plotted = open(svg).read(), open(plot).read()
    drawn = rasterised(text, size)
    same = agreement(ink(Image.open(bitmap), linear=True), drawn)
    other = inkscape(svg, folder, size)
    opened = None if other is None else agreement(other, drawn)
    read, named = read_layers(args.vpype, plot), layers(plotted)
    double = repeats(plotted)
    if not repeats(plotted + plotted):
        sys.exit("the search for repeats finds none in a drawing twice")
    said = "-" if opened is None else f"{opened:.3f}"
    seen = "-" if read is None else f"{len(read)} of {len(named)}"
    print(f"{style:<18} {drawn.mean():6.3f} {same:8.3f} {said:>9} {seen:>8} {double:8}", flush=True)
    return same >= 0.97 and (opened is None or opened >= 0.97) and (read is None or read == named) and double == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--umbrage", default="target/release/umbrage")
    parser.add_argument("--models", default="../shared/models")
    parser.add_argument("--vpype", default=shutil.which("vpype"))
    parser.add_argument("styles", nargs="*", default=["ds00-fig3a", "ds00-fig4b", "ds00-fig6b", "lenient-sketch"])
    args = parser.parse_args()
    args.umbrage = os.path.abspath(args.umbrage)
    print(f"{'style':<18} {'ink':>6} {'resvg':>8} {'inkscape':>9} {'layers':>8} {'repeats':>8}")
    with tempfile.TemporaryDirectory() as folder:
        good = [check(style, args, folder) for style in args.styles]
    sys.exit(0 if all(good) else 1)


main()
