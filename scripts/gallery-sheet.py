"""Lays bitmaps and rasterised vectors of drawings on paper side by side: FOLDER_OF_DRAWINGS OUTPUT_FOLDER."""
import io
import sys

import resvg_py
from PIL import Image, ImageDraw, ImageFont

work, out = sys.argv[1:]
PAPER = 252
FONT = ImageFont.load_default(15)


def vectors(name):
    text = open(f"{work}/{name}.svg").read()
    data = resvg_py.svg_to_bytes(svg_string=text, background="#fdfbf6", dpi=200)
    return Image.open(io.BytesIO(bytes(data))).convert("L")


def bitmap(name):
    return Image.open(f"{work}/{name}.png").convert("L")


def inked(picture):
    """The part of a picture where there is ink, and a little about it."""
    box = picture.point(lambda v: 255 if v < 200 else 0).getbbox()
    edge = picture.size[0] // 100
    left, top, right, bottom = box
    page = Image.new("L", (right - left + 2 * edge, bottom - top + 2 * edge), PAPER)
    page.paste(picture.crop(box), (edge, edge))
    return page


def inside(picture, margin):
    """The part within a margin, a share of the width."""
    edge = round(margin * picture.size[0])
    return picture.crop((edge, edge, picture.size[0] - edge, picture.size[1] - edge))


def cell(picture, size):
    """A picture in the middle of the bottom of a cell."""
    scale = min(size[0] / picture.size[0], size[1] / picture.size[1])
    small = picture.resize([max(1, round(s * scale)) for s in picture.size], Image.LANCZOS)
    page = Image.new("L", size, PAPER)
    page.paste(small, ((size[0] - small.size[0]) // 2, size[1] - small.size[1]))
    return page


def sheet(rows, file, gap=10):
    """Rows of cells, each row of one height; cells are (picture, label)."""
    line = 24 if any(label for row in rows for _, label in row) else 0
    width = max(sum(p.size[0] + gap for p, _ in row) for row in rows)
    height = sum(row[0][0].size[1] + gap + line for row in rows)
    page = Image.new("L", (width, height), PAPER)
    draw = ImageDraw.Draw(page)
    top = gap
    for row in rows:
        left = gap // 2
        for picture, label in row:
            page.paste(picture, (left, top))
            if label:
                middle = left + picture.size[0] // 2
                draw.text((middle, top + picture.size[1] + 4), label, fill=70, font=FONT, anchor="ma")
            left += picture.size[0] + gap
        top += row[0][0].size[1] + gap + line
    # Sixteen greys: half the file.
    grey = page.point(lambda v: round(v / 17))
    small = Image.frombytes("P", page.size, grey.tobytes())
    small.putpalette([v for k in range(16) for v in [min(17 * k, PAPER)] * 3])
    small.save(f"{out}/{file}", optimize=True, bits=4)


def pair(figure, size):
    name = f"ds00-fig{figure}"
    both = [(inked(bitmap(name)), "bitmap"), (inked(vectors(name)), "vectors")]
    return [(cell(picture, size), f"{figure}, {kind}") for picture, kind in both]


def pairs(figures, size):
    return [c for figure in figures for c in pair(figure, size)]


broad, high = (320, 350), (320, 470)
sheet([pairs(["2", "3a"], broad), pairs(["3b"], broad) + pairs(["4a"], broad), pairs(["4b", "4c"], high)], "paper-fig2-4.png")
sheet([pairs(["6a", "6b"], high), pairs(["6c", "6d"], broad), pairs(["6e", "6f"], broad)], "paper-fig6.png")
far = []
for style, label in [("ds00-fig5", "5a"), ("ds00-fig5b", "5b")]:
    row = []
    for distance, width in [("1", 220), ("1.7", 170), ("2.9", 150)]:
        name = f"{style}-{distance}"
        for picture, kind in [(bitmap(name), "bitmap"), (inside(vectors(name), 12 / 124), "vectors")]:
            whole = cell(picture, (230, 230))
            row.append((whole.crop(((230 - width) // 2, 0, (230 + width) // 2, 230)), f"{label}, {distance}, {kind}"))
    far.append(row)
sheet(far, "paper-fig5.png", 4)
six = ["ds00-fig4b", "ds00-fig4c", "ds00-fig6a", "lenient-sketch", "ds00-fig6f", "plotter-a4"]
oaks = [(cell(inked(vectors(f"oak-{n}")), (420, 520)), n) for n in six]
sheet([oaks[:3], oaks[3:]], "paper-styles.png")
