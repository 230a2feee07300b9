"""Draws one tree with umbrage and with Blender's Freestyle in turn, and says how many times as long Freestyle takes.

    python scripts/freestyle.py PEER.py --blender-python FILE [--turns 3] [--sheet OUT.png]

PEER.py draws `MODEL.glb OUT.png WIDTH HEIGHT` with `bpy` (which `--blender-python` has, from PyPI). Both are whole
programs from start to picture; times are of the wall and of the processors, medians of the turns. Needs Pillow.
"""
import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

from PIL import Image, ImageOps


def timed(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    wall = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{words}: {done.stderr[-2000:]}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("peer")
    parser.add_argument("--blender-python", required=True)
    parser.add_argument("--umbrage", default="target/release/umbrage")
    parser.add_argument("--model", default="../shared/models/eztree/oak_medium.glb")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--sheet")
    args = parser.parse_args()
    umbrage = os.path.abspath(args.umbrage)
    with tempfile.TemporaryDirectory() as folder:
        ours = [umbrage, "render", args.model, "--camera", "17,9", "--size", "800x600"]
        programs = {
            "freestyle": [args.blender_python, args.peer, args.model, f"{folder}/freestyle.png", 800, 600],
            "leaves, PNG": ours + ["--style", "leaves", "-o", f"{folder}/leaves.png"],
            "ds00-fig4b, PNG": ours + ["--style", "ds00-fig4b", "-o", f"{folder}/paper.png"],
            "ds00-fig4b, SVG": ours[:-2] + ["--style", "ds00-fig4b", "-o", f"{folder}/paper.svg"],
        }
        times = {name: [] for name in programs}
        for _ in range(args.turns):
            for name, words in programs.items():
                times[name].append(timed(words))
        print(f"{'':<18} {'wall s':>8} {'cpu s':>8} {'freestyle / it, wall':>21} {'cpu':>6}")
        peer = [statistics.median(t[k] for t in times["freestyle"]) for k in (0, 1)]
        for name, all_of in times.items():
            wall, cpu = (statistics.median(t[k] for t in all_of) for k in (0, 1))
            print(f"{name:<18} {wall:8.2f} {cpu:8.2f} {peer[0] / wall:21.1f} {peer[1] / cpu:6.1f}")
        if args.sheet:
            pictures = [Image.open(f"{folder}/{n}.png").convert("L") for n in ("freestyle", "leaves", "paper")]
            # Freestyle's peer has no light: its lines are black on dark grey.
            pictures[0] = ImageOps.autocontrast(pictures[0], cutoff=(0, 30))
            page = Image.new("L", (3 * 560, 600), 252)
            for k, picture in enumerate(pictures):
                page.paste(picture.crop((120, 0, 680, 600)), (560 * k, 0))
            page.point(lambda v: round(v / 17) * 17).save(args.sheet, optimize=True)


main()
