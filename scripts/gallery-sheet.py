"""Lays bitmaps and rasterised vectors of drawings on paper side by side: FOLDER_OF_DRAWINGS OUTPUT_FOLDER."""
import io
import sys

import resvg_py
from PIL import Image

work, out = sys.argv[1:]


def vectors(name, width=210):
    text = open(f"{work}/{name}.svg").read()
    picture = Image.open(io.BytesIO(bytes(resvg_py.svg_to_bytes(svg_string=text, background="#fdfbf6", dpi=96))))
    w, h = picture.size
    mm = w / width
    inside = [round(12 * mm), round(12 * mm), w - round(12 * mm), h - round(12 * mm)]
    return picture.convert("L").crop(inside)


def bitmap(name):
    return Image.open(f"{work}/{name}.png").convert("L")


def sheet(pictures, columns, file):
    size = pictures[0].size
    rows = -(-len(pictures) // columns)
    page = Image.new("L", (columns * size[0], rows * size[1]), 252)
    for k, picture in enumerate(pictures):
        picture = picture.resize(size, Image.LANCZOS)
        page.paste(picture, (k % columns * size[0], k // columns * size[1]))
    page.point(lambda v: round(v / 17) * 17).save(f"{out}/{file}", optimize=True)


figures = ["2", "3a", "3b", "4a", "4b", "4c", "6a", "6b", "6c", "6d", "6e", "6f"]
for file, names in [("paper-fig2-4", figures[:6]), ("paper-fig6", figures[6:])]:
    pairs = []
    for name in names:
        drawn = vectors(f"ds00-fig{name}")
        small = (300, round(300 * drawn.size[1] / drawn.size[0]))
        pairs.append(bitmap(f"ds00-fig{name}").resize(small, Image.LANCZOS))
        pairs.append(drawn.resize(small, Image.LANCZOS))
    sheet(pairs, 4, f"{file}.png")
far = []
for size in ["0.0", "1.0"]:
    for distance in ["1", "1.7", "2.9"]:
        name = f"distance-{size}-{distance}"
        far += [bitmap(name).resize((300, 300), Image.LANCZOS), vectors(name, 115).resize((300, 300), Image.LANCZOS)]
sheet(far, 6, "paper-fig5.png")
six = ["ds00-fig4b", "ds00-fig4c", "ds00-fig6a", "lenient-sketch", "ds00-fig6f", "plotter-a4"]
sheet([vectors(n).resize((420, 604), Image.LANCZOS) for n in six], 3, "paper-styles.png")
