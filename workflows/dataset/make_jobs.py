#!/usr/bin/env python3
"""Writes the jobs that Snakemake runs from the table of clips.

usage: make_jobs.py TABLE OUTPUT CORES    (VELAMAP: the program; RETRY_FAILED=1)

A job file is written only if its content changes, so that its time says whether the job has to be
computed again: it holds the command and, for each file that the command reads, size and time.
"""

import functools
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from clip_table import Clip, read_table
from job_needs import needs_of
from records import (MARK, PLAN, RESULT_FILES, as_json, fail, files_below, hash_of, job_file, key_of,
                     project_file, read_json, read_start, result_file, write_whole)

Options = list[tuple[str, str]]

COMMANDS = {"import": "marker_importer", "merge": "database_merger",
            "reconstruct": "automatic_reconstructor", "sweep": "central_frame_sweeper"}


def ask_velamap(*arguments: str) -> str:
    program = os.environ["VELAMAP"]
    try:
        return subprocess.run([program, *arguments], check=True, capture_output=True,
                              text=True).stdout
    except (OSError, subprocess.CalledProcessError):
        fail(f"{program} {' '.join(arguments)}: fails; set VELAMAP to the program velamap")


@functools.lru_cache(maxsize=None)
def options_of(stage: str) -> frozenset[str]:
    """The names of all options of a stage's command."""
    text = ask_velamap(COMMANDS[stage], "--help_all")
    return frozenset(re.findall(r"^  --([\w.]+)", text, re.M))


def is_option(name: str) -> bool:
    return any(name in options_of(stage) for stage in COMMANDS)


@functools.lru_cache(maxsize=None)
def states_below(path: Path) -> dict[str, list[int]]:
    """Size and time of a file, or of all files of a folder, because one may change in place."""
    return {str(file): [file.stat().st_size, file.stat().st_mtime_ns]
            for file in files_below(path)}


@functools.lru_cache(maxsize=None)
def dictionary_files(layout: Path) -> list[Path]:
    text = read_start(layout).decode("utf-8", "replace")
    names = re.findall(r"^dictionary:\s*[\"']?([^\"'#\n]*?)[\"']?\s*(?:#.*)?$", text, re.M)
    return [layout.parent / name for name in names if name]


def files_read(clip: Clip, options: Options) -> dict[str, list[int]]:
    """Everything that a job reads."""
    paths = [clip.path, clip.camera, clip.layout]
    paths += [Path(value) for name, value in options if os.path.isabs(value)]
    paths += dictionary_files(clip.layout) if clip.layout else []
    return {file: state for path in paths if path for file, state in states_below(path).items()}


def options_of_job(clip: Clip, stage: str) -> tuple[Options, Options]:
    """The options for the command line of a job and for its project file, where one without effect
    is ignored. The reconstruction and the sweep have other defaults of method and backend, so an
    option of both may have an effect in one of them only. It then has to be accepted in the other."""
    typed = [(name, value) for name, value in clip.options
             if name in options_of(command_key(stage, clip))]
    if not clip.central_frames or stage not in ("reconstruct", "sweep"):
        return typed, []
    given = {name for name, _ in clip.options + clip.project}
    chooses_method = bool(given & {"Registration.method", "preset"})

    def may_be_unused(option: tuple[str, str]) -> bool:
        name, value = option
        if name == "project_path" or "#" in value:  # which begins a comment in the file
            return False
        if stage == "sweep":  # the reconstruction refuses what is without effect in both
            return name in options_of("reconstruct")
        return (name in options_of("sweep") and name.startswith("Registration.") and
                not chooses_method)

    in_file = [option for option in typed if may_be_unused(option)]
    if not in_file:
        return typed, []
    # A command reads one project file, so that of the row goes into the job's.
    typed = [option for option in typed if option not in in_file and option[0] != "project_path"]
    names = {name for name, _ in in_file}
    return typed, in_file + [option for option in clip.project if option[0] not in names]


def command_of(clip: Clip, stage: str, options: Options) -> list[str]:
    """The command without the program and the number of threads; run in the folder OUTPUT."""
    workspace = f"clips/{clip.name}"
    jobs = f"jobs/{key_of(clip.name)}"
    part = stage.partition("_")[2]
    words = [COMMANDS[command_key(stage, clip)]]
    if words[0] in ("marker_importer", "automatic_reconstructor"):
        words += ["--image_path", str(clip.path)]
        words += ["--camera_path", str(clip.camera)] if clip.camera else []
    words += ["--layout_path", str(clip.layout)] if clip.layout else []
    if words[0] == "database_merger":
        parts = ",".join(f"{jobs}/{each}.db" for each in clip.part_stages())
        words += ["--database_paths", parts, "--output_path", f"{workspace}/database.db"]
    elif words[0] == "marker_importer":
        words += ["--video_part", f"{part}/{clip.num_parts}"] if part else []
        database = f"{jobs}/{stage}.db" if part else f"{workspace}/database.db"
        words += ["--database_path", database, "--import_anew", "1"]
        if not clip.path.is_dir():
            words += ["--frame_output_path", f"{workspace}/images"]
    elif stage == "reconstruct":
        words += ["--workspace_path", workspace, "--summary", "json"]
    else:
        words += ["--database_path", f"{workspace}/database.db", "--central_frames",
                  clip.central_frames, "--output_path", f"{jobs}/sweep.csv"]
    for name, value in options:
        words += [f"--{name}", value]
    return words


def command_key(stage: str, clip: Clip) -> str:
    if stage == "import" and clip.num_parts > 1:
        return "merge"
    return "import" if stage.startswith("part_") else stage


def check_output(output: Path) -> None:
    """Takes a new or empty folder, or one of this workflow whose results nobody has edited."""
    if output.exists() and not output.is_dir():
        fail(f"{output}: is a file; give a folder for the results")
    entries = sorted(entry.name for entry in output.iterdir()) if output.exists() else []
    if entries and MARK not in entries:
        fail(f"{output}: holds {entries[0]} and is not a data set of this workflow; give a new or "
             "empty folder")
    hashes = read_json(output / MARK) if entries else {}
    for name in RESULT_FILES:
        file = output / name
        if file.exists() and hash_of(file.read_bytes()) not in hashes.get(name, []):
            fail(f"{file}: was changed since the workflow wrote it, or is none of its files; move "
                 "it away")


def check_folders(output: Path, clips: list[Clip]) -> None:
    for clip in clips:
        place = output / "clips" / clip.name
        known = output / job_file(key_of(clip.name), "import")
        if place.exists() and not known.exists():
            fail(f"{place}: is there and was not made by this workflow; move it away")
        if clip.path.is_dir() and clip.path.resolve() in (output.resolve() / "x").parents:
            fail(f"{output}: lies in the photographs of {clip.name}, {clip.path}; give another "
                 "folder")


def forget_lost_results(output: Path, clip: Clip, parts: list[str], retry_failed: bool) -> None:
    """Removes the records of results that have been deleted, or that failed and shall be tried."""
    workspace = output / "clips" / clip.name
    key = key_of(clip.name)
    made = {"import": workspace / "database.db", "reconstruct": workspace / "report.html",
            "sweep": output / "jobs" / key / "sweep.csv",
            **{part: output / "jobs" / key / f"{part}.db" for part in parts}}
    for stage, file in made.items():
        result = output / result_file(key, stage)
        if not result.exists():
            continue
        failed = read_json(result)["exit_code"] != 0
        if (failed and retry_failed) or (not failed and not file.exists()):
            result.unlink()


def write_jobs(output: Path, tags: list[str], clips: list[Clip], cores: int,
               version: str) -> None:
    retry_failed = os.environ.get("RETRY_FAILED") == "1"
    threads = max(1, cores // len(clips))
    rows: list[dict[str, Any]] = []
    for clip in clips:
        key = key_of(clip.name)
        parts = clip.part_stages()
        for stage in parts + clip.stages():
            typed, in_file = options_of_job(clip, stage)
            job = {"stage": stage, "version": version,
                   "command": command_of(clip, stage, typed),
                   "after": parts if stage == "import" else [] if stage in parts else ["import"],
                   "files": files_read(clip, typed + in_file + clip.project)}
            if in_file:
                project = project_file(key, stage)
                text = "".join(f"{name}={value}\n" for name, value in in_file)
                write_whole(output / project, text)
                job["command"] += ["--project_path", str(project)]
                job["project"] = text
            write_whole(output / job_file(key, stage), as_json(job))
        forget_lost_results(output, clip, parts, retry_failed)
        rows.append({"name": clip.name, "key": key, "clip": clip.path.name, "tags": clip.tags,
                     "central_frames": clip.central_frames, "parts": parts,
                     "stages": clip.stages(), "part_threads": max(1, threads // clip.num_parts),
                     **needs_of(clip.path, clip.camera, clip.num_parts)})
    write_whole(output / PLAN, as_json({"version": version, "tags": tags, "threads": threads,
                                        "rows": rows}))


def main() -> None:
    table, output, cores = Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
    tags, clips = read_table(table, is_option)
    try:
        check_output(output)
        check_folders(output, clips)
        version = ask_velamap("version").splitlines()[0]
        if not (output / MARK).exists():
            write_whole(output / MARK, as_json({}))
        write_jobs(output, tags, clips, cores, version)
    except OSError as error:  # permissions, a full disk
        fail(f"{error.filename}: {error.strerror}")


if __name__ == "__main__":
    main()
