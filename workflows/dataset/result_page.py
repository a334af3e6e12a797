"""The page of a data set: thesis Table 4.1 with the results, and plots over all clips."""

from html import escape
from typing import Any

from plots import plot
from records import number_of
from result_columns import STATISTICS, SWEEP_FIGURES

Row = dict[str, Any]
YES, NO = ("1", "x", "•", "yes", "true"), ("", "0", "no", "false")
MAX_CATEGORIES = 12
OVER_ALL = ("<h2>Over all clips</h2><p>A clip that does not support a result (exit 1) counts as a "
            "ratio of 0.</p>")

# Title, unit, and the columns below it with their keys.
GROUPS = (
    ("Images", (("used", "num_images_used"), ("with markers", "num_images"))),
    ("Markers", (("whole", "num_markers"), ("in layout", "num_layout_markers"),
                 ("ratio", "reconstruction_ratio"), ("sail's ratio", "sail_reconstruction_ratio"))),
    ("Area error, %", (("mean", "area_error_percent_mean"), ("dev.", "area_error_percent_std"))),
    ("Reprojection error, px", (("mean", "reprojection_error_px_mean"),
                                ("dev.", "reprojection_error_px_std"))),
    ("Scale", (("m per unit", "scale_m_per_unit"), ("sigma, %", "scale_sigma_percent"))),
)
NUM_FIGURES = sum(len(columns) for _, columns in GROUPS)
SECTION_TITLES = (("camber_percent", "camber, %"), ("draft_percent", "draft, %"),
                  ("twist_deg", "twist, deg"))
SWEEP_TITLES = dict(zip(SWEEP_FIGURES, (
    "Ratio", "Area error, mm², mean", "Area error, mm², max",
    "Reprojection error in the central frame, px", "Reprojection error, px")))

STYLE = """
body { font: 15px/1.4 system-ui, sans-serif; margin: 2em; color: #1d2329; background: #fff; }
table { border-collapse: collapse; margin: 1em 0; font-size: 13px; display: block;
  overflow-x: auto; }
th, td { border-bottom: 1px solid #d6dbe0; padding: 3px 8px; text-align: right;
  white-space: nowrap; }
thead th { border-bottom: 2px solid #8b949e; text-align: center; vertical-align: bottom; }
.text, tbody th { text-align: left; } .tag { text-align: center; }
.reason { text-align: left; white-space: normal; min-width: 22em; color: #a02314; }
.good { color: #1e7a34; } .check { color: #9a6200; } .bad, .failed { color: #a02314; }
.plot { margin: 0 1em 1em 0; } .plot text { font: 11px system-ui, sans-serif; fill: #3c444d; }
.plot .title { font-size: 13px; font-weight: 600; } .plot .x { text-anchor: middle; }
.plot .y { text-anchor: end; dominant-baseline: middle; } .grid { stroke: #e3e7eb; fill: none; }
@media (prefers-color-scheme: dark) {
  body { color: #dde3e9; background: #15191d; } a { color: #7db7ff; }
  th, td { border-color: #343b42; } .plot text { fill: #b6bec7; } .grid { stroke: #2b3238; }
  .good { color: #6ac47e; } .check { color: #e0ae4f; } .bad, .failed, .reason { color: #f08a7d; }
}
"""


def shown(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1000 else f"{value:.0f}"
    return escape(str(value))


def cell(value: Any, css: str = "") -> str:
    return f'<td class="{css}">{shown(value)}</td>' if css else f"<td>{shown(value)}</td>"


def marks_of(rows: list[Row], tags: list[str]) -> set[str]:
    """The tags that only say yes or no, which are shown as the dots of Table 4.1."""
    return {tag for tag in tags if all(row["tags"][tag].lower() in YES + NO for row in rows)}


def tag_cell(value: str, is_mark: bool) -> str:
    if is_mark:
        value = "•" if value.lower() in YES else ""
    return cell(value, "tag")


def link(address: str, text: str) -> str:
    return f'<a href="{escape(address)}">{text}</a>'


def table(head: list[str], body: list[str]) -> str:
    return (f"<table><thead>{''.join(f'<tr>{line}</tr>' for line in head)}</thead><tbody>"
            f"{''.join(f'<tr>{line}</tr>' for line in body)}</tbody></table>")


def head_of(groups: list[tuple[str, list[str]]], before: list[str],
            after: list[str]) -> list[str]:
    """Two lines of titles: groups above their columns, and columns that stand alone."""
    first = "".join(f'<th rowspan="2">{escape(title)}</th>' for title in before)
    first += "".join(f'<th colspan="{len(columns)}">{escape(title)}</th>'
                     for title, columns in groups)
    first += "".join(f'<th rowspan="2">{escape(title)}</th>' for title in after)
    second = "".join(f"<th>{escape(title)}</th>" for _, titles in groups for title in titles)
    return [first, second]


def clip_line(row: Row, tags: list[str], marks: set[str]) -> str:
    name = escape(row["name"])
    line = f"<th>{link(row['report'], name) if 'report' in row else name}</th>"
    line += "".join(tag_cell(row["tags"][tag], tag in marks) for tag in tags)
    line += cell(row.get("duration_s", ""))
    if "verdict" in row:
        reasons = "\n".join(reason["reason"] for reason in row.get("verdict_reasons", []))
        line += (f'<td class="text {escape(row["verdict"])}" title="{escape(reasons)}">'
                 f'{escape(row["verdict"])}</td>')
        line += "".join(cell(row.get(key, "")) for _, columns in GROUPS for _, key in columns)
        fault = row["error"]
    else:
        exit_code = "none" if row["exit_code"] == "" else f"exit {row['exit_code']}"
        line += cell(exit_code, "text failed")
        line += f'<td class="reason" colspan="{NUM_FIGURES}">{escape(row["error"])}</td>'
        fault = ""
    line += cell(row["wall_s"]) + cell(row["peak_memory_mb"])
    return line + cell(fault, "reason" if fault else "")


def clip_table(tags: list[str], rows: list[Row]) -> str:
    groups = [(title, [name for name, _ in columns]) for title, columns in GROUPS]
    head = head_of(groups, ["Video", *tags, "Duration, s", "Verdict"],
                   ["Wall time, s", "Peak memory, MB", "Fault"])
    marks = marks_of(rows, tags)
    return table(head, [clip_line(row, tags, marks) for row in rows])


def section_names(rows: list[Row]) -> list[tuple[str, str]]:
    return list(dict.fromkeys((section["part"], section["section"]) for row in rows
                              for section in row.get("sections", [])))


def section_of(row: Row, name: tuple[str, str]) -> dict[str, Any]:
    return next((section for section in row.get("sections", [])
                 if (section["part"], section["section"]) == name), {})


def section_table(rows: list[Row]) -> str:
    names = section_names(rows)
    if not names:
        return ""
    groups = [(f"{part} {name}", [title for _, title in SECTION_TITLES]) for part, name in names]
    body = [f"<th>{escape(row['name'])}</th>" +
            "".join(cell(section_of(row, name).get(key, "")) for name in names
                    for key, _ in SECTION_TITLES)
            for row in rows if row.get("sections")]
    return "<h2>Sections</h2>" + table(head_of(groups, ["Video"], []), body)


def sweep_table(rows: list[Row]) -> str:
    swept = [row for row in rows if "num_central_frames" in row]
    if not swept:
        return ""
    groups = [(title, list(STATISTICS)) for title in SWEEP_TITLES.values()]
    head = head_of(groups, ["Video", "Central frames", "with result"], [])
    body = [f"<th>{link(row['sweep'], escape(row['name']))}</th>" +
            cell(row["num_central_frames"]) + cell(row["num_central_frames_with_result"]) +
            "".join(cell(row.get(f"sweep_{figure}_{statistic}", ""))
                    for figure in SWEEP_FIGURES for statistic in STATISTICS)
            for row in swept]
    return ("<h2>Over central frames</h2><p>One reconstruction around each central frame by the "
            "method of the thesis (its section 4.3.3), and statistics over them.</p>" +
            table(head, body))


def axis(rows: list[Row], tag: str) -> tuple[list[float], list[str] | None] | None:
    """The tag as numbers, else as categories; None if it says nothing to draw."""
    values = [row["tags"][tag] for row in rows]
    if len(set(values)) < 2:
        return None
    numbers = [number_of(value) for value in values]
    if all(number is not None for number in numbers) and len(set(numbers)) > 2:
        return [number for number in numbers if number is not None], None
    categories = list(dict.fromkeys(values))
    if len(categories) > MAX_CATEGORIES:
        return None
    return ([float(categories.index(value)) for value in values],
            [value or "–" for value in categories])


def trim_plots(rows: list[Row], tags: list[str]) -> list[str]:
    """Camber, draft and twist by the order of the table and by each tag with numbers."""
    cut = [row for row in rows if row.get("sections")]
    if len(cut) < 2:
        return []
    axes = [("order in the table", [float(rows.index(row) + 1) for row in cut])]
    for tag in tags:
        by_tag = axis(cut, tag)
        if by_tag and by_tag[1] is None:
            axes.append((tag, by_tag[0]))
    plots = []
    for x_label, xs in axes:
        for key, title in SECTION_TITLES:
            series = {}
            for name in section_names(cut):
                line = [(x, section_of(row, name)[key], f"{row['name']}, {' '.join(name)}")
                        for x, row in zip(xs, cut) if key in section_of(row, name)]
                if line:
                    series[" ".join(name)] = sorted(line)
            if series:
                plots.append(plot(f"{title} by {x_label}", x_label, title, series, join=True))
    return plots


def ratio_plots(rows: list[Row], tags: list[str]) -> list[str]:
    """The share of reconstructed markers by each tag; a clip without a result has none."""
    judged = [row for row in rows if "reconstruction_ratio" in row or row["exit_code"] == 1]
    plots = []
    for tag in tags:
        by_tag = axis(judged, tag)
        if by_tag:
            points = [(x, row.get("reconstruction_ratio", 0.0), row["name"])
                      for x, row in zip(by_tag[0], judged)]
            plots.append(plot(f"reconstruction ratio by {tag}", tag, "reconstruction ratio",
                              {"ratio": points}, by_tag[1]))
    return plots


def page_of(version: str, tags: list[str], rows: list[Row]) -> str:
    """One file without network access; every text of the table is escaped."""
    num_results = sum(row["exit_code"] == 0 for row in rows)
    plots = ratio_plots(rows, tags) + trim_plots(rows, tags)
    return ('<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Data set</title>'
            f"<style>{STYLE}</style></head><body><h1>Data set</h1>"
            f"<p>{len(rows)} clips, {num_results} with a whole result; {escape(version)}.</p>"
            f"{clip_table(tags, rows)}{section_table(rows)}{sweep_table(rows)}"
            f"{OVER_ALL if plots else ''}{''.join(plots)}</body></html>\n")
