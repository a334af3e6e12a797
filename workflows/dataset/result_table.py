#!/usr/bin/env python3
"""Writes dataset.csv and dataset.html from the results of the jobs, those that there are.

usage: result_table.py OUTPUT    exit code 1 if a clip has no whole result
"""

import csv
import io
import re
import sys
import urllib.parse
from pathlib import Path
from typing import Any

from records import (MARK, PLAN, as_json, fail, hash_of, job_file, read_json, result_file,
                     write_whole)
from result_columns import FIGURES, RESULT_COLUMNS, SECTION_FIGURES, STAGES
from result_page import page_of

NOT_RUN = {"exit_code": "", "error": "not finished; run again"}


def without_folders(text: str, known: set[Path]) -> str:
    """The table is sent around, as velamap's report is: files without the folders they lie in."""
    for folder in sorted((str(folder) for folder in known if folder.name), key=len, reverse=True):
        text = text.replace(f"{folder}/", "")
    return re.sub(r"(^|[\s'\"(=:,;])/[^/\s][^\s'\"),;]*/", r"\1", text)


def folders_of(clip: dict[str, Any], output: Path) -> set[Path]:
    """The folders of what a clip's jobs read, and those above them."""
    files = read_json(output / job_file(clip["key"], "import"))["files"]
    parents = {Path(file).parent for file in files}
    return parents | {folder.parent for folder in parents} | {output.resolve()}


def section_column(section: dict[str, Any], figure: str) -> str:
    return f"{section['part']}_{section['section']}_{figure}"


def with_parts(result: dict[str, Any], clip: dict[str, Any], output: Path) -> dict[str, Any]:
    """The result of an import with the time of its parts, and the memory of the largest."""
    paths = [output / result_file(clip["key"], part) for part in clip["parts"]]
    results = [result] + [read_json(path) for path in paths if path.exists()]
    if len(results) == 1:
        return result
    return {**result, "wall_s": round(sum(each.get("wall_s", 0) for each in results), 3),
            "peak_memory_mb": max(each.get("peak_memory_mb", 0) for each in results)}


def row_of(clip: dict[str, Any], output: Path) -> dict[str, Any]:
    """All cells of a clip that there are, by column; `sections` and `reasons` are the page's."""
    results = {}
    for stage in clip["stages"]:
        path = output / result_file(clip["key"], stage)
        results[stage] = read_json(path) if path.exists() else NOT_RUN
    results["import"] = with_parts(results["import"], clip, output)
    row: dict[str, Any] = {"name": clip["name"], "clip": clip["clip"], "tags": clip["tags"]}
    for stage, result in results.items():
        row.update(result.get("figures", {}))
        if "wall_s" in result:
            row[f"{stage}_wall_s"] = result["wall_s"]
    # The reconstruction repeats the reason of a failed import; a failed sweep says that it is one.
    failed = next((stage for stage in results if results[stage]["exit_code"] != 0), None)
    reason = results[failed]["error"] if failed else ""
    row["exit_code"] = results[failed]["exit_code"] if failed else 0
    if failed == "sweep":
        reason = f"sweep: {reason}"
    row["error"] = without_folders(reason, folders_of(clip, output)) if reason else ""
    row["wall_s"] = round(sum(row.get(f"{stage}_wall_s", 0) for stage in STAGES), 3)
    row["peak_memory_mb"] = max((result.get("peak_memory_mb", 0) for result in results.values()))
    # An older result may lie there.
    if "verdict" in row:
        row["report"] = urllib.parse.quote(f"clips/{clip['name']}/report.html")
    if "num_central_frames" in row:
        row["sweep"] = urllib.parse.quote(f"jobs/{clip['key']}/sweep.csv")
    for section in row.get("sections", []):
        for figure in SECTION_FIGURES:
            if figure in section:
                row[section_column(section, figure)] = section[figure]
    return row


def csv_of(tags: list[str], rows: list[dict[str, Any]]) -> str:
    """One figure per cell, with a decimal point; empty: there is none."""
    sections = dict.fromkeys(section_column(section, figure) for row in rows
                             for section in row.get("sections", []) for figure in SECTION_FIGURES)
    columns = list(RESULT_COLUMNS)
    after = columns.index(FIGURES[-1]) + 1
    columns[after:after] = sections
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns[:2] + tags + columns[2:])
    for row in rows:
        cells = [row.get(column, "") for column in columns]
        writer.writerow(cells[:2] + [row["tags"][tag] for tag in tags] + cells[2:])
    return out.getvalue()


def main() -> None:
    output = Path(sys.argv[1])
    plan = read_json(output / PLAN)
    rows = [row_of(clip, output) for clip in plan["rows"]]
    texts = {"dataset.csv": csv_of(plan["tags"], rows),
             "dataset.html": page_of(plan["version"], plan["tags"], rows)}
    hashes = read_json(output / MARK)
    for name, text in texts.items():
        # Known before it is there: a run may end in between.
        hashes[name] = hashes.get(name, [])[-1:] + [hash_of(text.encode())]
        write_whole(output / MARK, as_json(hashes))
        write_whole(output / name, text)
        print(f"{name}: {output / name}")
    failed = [row for row in rows if row["exit_code"] != 0]
    print(f"clips: {len(rows)}\nclips_with_result: {len(rows) - len(failed)}")
    for row in failed:
        print(f"== {row['name']}: exit {row['exit_code'] or 'none'}: {row['error']}",
              file=sys.stderr)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    try:
        main()
    except OSError as error:  # a full disk
        fail(f"{error.filename}: {error.strerror}")
