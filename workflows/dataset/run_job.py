#!/usr/bin/env python3
"""Runs one job in the folder OUTPUT and writes its result, whether or not the program fails.

usage: run_job.py JOB RESULT THREADS IS_LAST    (VELAMAP: the program)

A program that a signal has ended (no memory, a node that goes away) is no result: the job fails, so
that Snakemake tries it again. The last attempt (IS_LAST 1) is recorded.
"""

import contextlib
import csv
import json
import os
import resource
import shlex
import signal
import sqlite3
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, TextIO

from records import as_json, read_json, write_whole
from result_columns import SWEEP_FIGURES


def query(database: Path, statement: str) -> list[tuple[Any, ...]]:
    uri = f"{database.resolve().as_uri()}?mode=ro"
    with contextlib.closing(sqlite3.connect(uri, uri=True)) as connection:
        return connection.execute(statement).fetchall()


def numbers_with_markers(database: Path) -> list[int]:
    return [number for number, in query(
        database, "SELECT DISTINCT frame_number FROM marker_detections "
        "WHERE frame_number IS NOT NULL AND rejected_because IS NULL ORDER BY 1")]


def duration_s(database: Path) -> float | None:
    """From the first to the last frame with markers, the last one's own time included."""
    (first, last, first_s, last_s), = query(
        database, "SELECT MIN(frame_number), MAX(frame_number), MIN(time_s), MAX(time_s) "
        "FROM marker_detections WHERE rejected_because IS NULL")
    if first_s is None or last is None or last == first:
        return None
    return float((last_s - first_s) * (last - first + 1) / (last - first))


def with_frames_of_range(command: list[str]) -> list[str]:
    """Replaces FIRST:LAST:STEP by those of these frames that hold markers."""
    index = command.index("--central_frames") + 1
    if command[index].count(":") != 2:
        return command
    first, last, step = map(int, command[index].split(":"))
    database = Path(command[command.index("--database_path") + 1])
    frames = [number for number in numbers_with_markers(database)
              if first <= number <= last and (number - first) % step == 0]
    if not frames:
        raise ValueError(f"central_frames {command[index]}: none of these frames holds markers")
    return command[:index] + [",".join(map(str, frames))] + command[index + 1:]


def figures_of_sweep(path: Path) -> dict[str, float]:
    """The statistics over the central frames with a result (thesis section 4.3.3)."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    figures: dict[str, float] = {
        "num_central_frames": len(rows),
        "num_central_frames_with_result": sum(not row["reason"] for row in rows)}
    for figure in SWEEP_FIGURES:
        values = [float(row[figure]) for row in rows if row[figure]]
        if values:
            figures[f"sweep_{figure}_min"] = min(values)
            figures[f"sweep_{figure}_max"] = max(values)
            figures[f"sweep_{figure}_mean"] = statistics.fmean(values)
        if len(values) > 1:
            figures[f"sweep_{figure}_std"] = statistics.stdev(values)
    return figures


def database_of(command: list[str]) -> Path:
    """The database that an import or the merge of its parts writes."""
    option = "--output_path" if command[0] == "database_merger" else "--database_path"
    return Path(command[command.index(option) + 1])


def figures_of(stage: str, command: list[str], printed: str) -> dict[str, Any]:
    if stage == "import":
        database = database_of(command)
        duration = duration_s(database) if database.exists() else None
        return {} if duration is None else {"duration_s": duration}
    if stage.startswith("part_"):
        return {}
    if stage == "sweep":
        table = Path(command[command.index("--output_path") + 1])
        return figures_of_sweep(table) if table.exists() else {}
    # Tables by marker and image stay in shape/metrics.json.
    return {key: value for key, value in (json.loads(printed) if printed.strip() else {}).items()
            if not isinstance(value, list) or key in ("sections", "verdict_reasons")}


def error_line(log: Path, start: int, exit_code: int) -> str:
    """The program's one line that says why."""
    with log.open("rb") as file:
        file.seek(start)
        lines = file.read().decode("utf-8", "replace").splitlines()
    errors = [line[len("error: "):] for line in lines if line.startswith("error: ")]
    if errors:
        return errors[-1]
    if exit_code > 128:
        return f"ended by {signal.Signals(exit_code - 128).name}; was there enough memory?"
    return f"no reason given; see {log.name}"


def run(command: list[str], log: TextIO) -> tuple[int, str]:
    """The exit code as a shell gives it, and stdout. stderr goes to the log."""
    log.write(f"cd {shlex.quote(os.getcwd())}\n{shlex.join(command)}\n")
    log.flush()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True) as process:
        def stop(*_: object) -> None:
            process.terminate()
            os._exit(143)
        signal.signal(signal.SIGTERM, stop)
        printed = process.communicate()[0]
    code = process.returncode
    return (code if code >= 0 else 128 - code), printed


def run_job(job: dict[str, Any], log_path: Path, threads: str) -> dict[str, Any]:
    stage, command = job["stage"], job["command"]
    for earlier_stage in job["after"]:
        earlier = read_json(log_path.with_name(f"{earlier_stage}.json"))
        if earlier["exit_code"]:
            return {"exit_code": earlier["exit_code"], "error": earlier["error"]}
    if command[0] in ("marker_importer", "database_merger"):
        database_of(command).parent.mkdir(parents=True, exist_ok=True)
    begin = time.monotonic()
    with log_path.open("a", encoding="utf-8") as log:
        start = log.tell()
        if stage == "sweep":
            try:
                command = with_frames_of_range(command)
            except ValueError as error:
                return {"exit_code": 1, "error": str(error)}
        exit_code, printed = run([os.environ["VELAMAP"], *command, "--num_threads", threads], log)
    peak_memory_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    return {"exit_code": exit_code,
            "error": error_line(log_path, start, exit_code) if exit_code else "",
            "wall_s": round(time.monotonic() - begin, 3),
            "peak_memory_mb": round(peak_memory_mb, 1),
            "figures": figures_of(stage, command, printed)}


def main() -> None:
    job_path, result_path = Path(sys.argv[1]), Path(sys.argv[2])
    threads, is_last = sys.argv[3], sys.argv[4] == "1"
    result = run_job(read_json(job_path), job_path.with_suffix(".log"), threads)
    if result["exit_code"] > 128 and not is_last:
        sys.exit(result["exit_code"])
    write_whole(result_path, as_json(result))


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)
    except OSError as error:  # a full disk
        sys.exit(f"error: {error.filename}: {error.strerror}")
