"""Small plots as SVG, for a page without scripts."""

import math
from html import escape

WIDTH, HEIGHT = 460, 300
LEFT, RIGHT, TOP, BOTTOM = 58, 12, 30, 66
LEGEND_COLUMNS, LEGEND_ROW, LEGEND_ROWS = 4, 14, 2  # for which there is room in HEIGHT
COLORS = ("#1f6fb4", "#d1571f", "#2b8a3e", "#8a4fb0", "#b3862b", "#3a9aa8", "#c23b6a", "#5c6670")

Point = tuple[float, float, str]  # x, y, what the mouse shows


def ticks(low: float, high: float) -> list[float]:
    """Round numbers that cover the range."""
    span = (high - low) or abs(high) or 1.0
    step = 10.0 ** math.floor(math.log10(span / 4))
    step *= next(factor for factor in (1, 2, 5, 10) if span / (step * factor) <= 5)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [index * step for index in range(first, max(last, first + 1) + 1)]


def plot(title: str, x_label: str, y_label: str, series: dict[str, list[Point]],
         categories: list[str] | None = None, join: bool = False) -> str:
    """One curve or cloud for each series; `categories` names x = 0, 1, 2 ..."""
    points = [point for line in series.values() for point in line]
    x_ticks = ([float(index) for index in range(len(categories))] if categories else
               ticks(min(x for x, _, _ in points), max(x for x, _, _ in points)))
    y_ticks = ticks(min(y for _, y, _ in points), max(y for _, y, _ in points))
    margin = 0.5 if categories else 0.0
    x_low, x_high = x_ticks[0] - margin, x_ticks[-1] + margin
    bottom, right = HEIGHT - BOTTOM, WIDTH - RIGHT
    num_rows = math.ceil(len(series) / LEGEND_COLUMNS)
    height = HEIGHT + LEGEND_ROW * max(0, num_rows - LEGEND_ROWS)

    def at(x: float, y: float) -> tuple[str, str]:
        return (f"{LEFT + (x - x_low) / (x_high - x_low) * (right - LEFT):.1f}",
                f"{bottom - (y - y_ticks[0]) / (y_ticks[-1] - y_ticks[0]) * (bottom - TOP):.1f}")

    out = [f'<svg class="plot" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" '
           'xmlns="http://www.w3.org/2000/svg" role="img">',
           f'<text x="{LEFT}" y="18" class="title">{escape(title)}</text>']
    for y in y_ticks:
        _, py = at(x_low, y)
        out.append(f'<path class="grid" d="M{LEFT} {py}H{right}"/>'
                   f'<text x="{LEFT - 6}" y="{py}" class="y">{y:.4g}</text>')
    for index, x in enumerate(x_ticks):
        px, _ = at(x, y_ticks[0])
        name = categories[index] if categories else f"{x:.4g}"
        shown = name if len(name) <= 14 else name[:13] + "…"
        out.append(f'<path class="grid" d="M{px} {TOP}V{bottom}"/>'
                   f'<text x="{px}" y="{bottom + 16}" class="x">{escape(shown)}</text>')
    out.append(f'<text x="{(LEFT + right) / 2}" y="{bottom + 34}" class="x">'
               f'{escape(x_label)}</text><text x="14" y="{(TOP + bottom) / 2}" class="x" '
               f'transform="rotate(-90 14 {(TOP + bottom) / 2})">{escape(y_label)}</text>')
    for index, (name, line) in enumerate(series.items()):
        color = COLORS[index % len(COLORS)]
        # From the second round of colours on, lines are dashed and points are hollow.
        is_again = index >= len(COLORS)
        dashes = ' stroke-dasharray="6 3"' if is_again else ""
        fill = f'fill="white" stroke="{color}"' if is_again else f'fill="{color}"'
        places = [at(x, y) for x, y, _ in line]
        if join and len(line) > 1:
            way = "L".join(f"{px} {py}" for px, py in places)
            out.append(f'<path d="M{way}" fill="none" stroke="{color}" stroke-width="1.5"'
                       f'{dashes}/>')
        for (px, py), (_, _, text) in zip(places, line):
            out.append(f'<circle cx="{px}" cy="{py}" r="3.5" {fill}>'
                       f'<title>{escape(text)}</title></circle>')
        if len(series) > 1:
            row, place = divmod(index, LEGEND_COLUMNS)
            key_x, key_y = LEFT + place * 100, bottom + 48 + row * LEGEND_ROW
            out.append(f'<circle cx="{key_x}" cy="{key_y}" r="3.5" {fill}/>'
                       f'<text x="{key_x + 7}" y="{key_y + 4}">{escape(name)}</text>')
    return "".join(out) + "</svg>"
