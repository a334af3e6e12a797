"""Where the workflow keeps what, and files that are whole or not there.

    OUTPUT/clips/NAME/           a workspace of velamap automatic_reconstructor
    OUTPUT/jobs/KEY/STAGE.job    JSON: the job, the files that it reads, the command
    OUTPUT/jobs/KEY/STAGE.ini    options of the job, where it has any that may be without effect in it
    OUTPUT/jobs/KEY/STAGE.json   its result: exit code, reason, figures
    OUTPUT/jobs/KEY/STAGE.log    the line to copy, and what the program said
    OUTPUT/jobs/KEY/part_K.db    what job part_K has imported, which `import` merges with the others
    OUTPUT/jobs/plan.json        the table of clips as it was read
    OUTPUT/.velamap_dataset      marks the folder; hashes of dataset.csv and dataset.html
"""

import hashlib
import json
import os
import re
import sys
import urllib.parse
from pathlib import Path
from typing import Any, NoReturn

MARK = ".velamap_dataset"
PLAN = Path("jobs/plan.json")
MAX_BYTES = 16 << 20  # of a table, a layout or a camera file, as velamap reads them
RESULT_FILES = ("dataset.csv", "dataset.html")


def fail(*messages: str) -> NoReturn:
    """Ends the program as velamap does for bad input, without commands to the terminal."""
    for message in messages:
        print("error:", re.sub(r"[\x00-\x1f\x7f-\x9f]", "?", message), file=sys.stderr)
    sys.exit(2)


def read_start(path: Path) -> bytes:
    """The first MAX_BYTES, and one more if there are more."""
    with path.open("rb") as file:
        return file.read(MAX_BYTES + 1)


def files_below(path: Path) -> list[Path]:
    """A file, or all files of a folder as velamap finds them: through links, each folder once."""
    if not path.is_dir():
        return [path] if path.is_file() else []
    files, seen = [], set()
    for folder, folders, names in os.walk(path, followlinks=True):
        if os.path.realpath(folder) in seen:
            folders.clear()
            continue
        seen.add(os.path.realpath(folder))
        files += [Path(folder, name) for name in names if Path(folder, name).exists()]
    return sorted(files)


def key_of(name: str) -> str:
    """The name of a row as a folder that neither Snakemake nor a shell reads anything into."""
    return urllib.parse.quote(name, safe="")


def job_file(key: str, stage: str) -> Path:
    return Path("jobs", key, f"{stage}.job")


def project_file(key: str, stage: str) -> Path:
    return Path("jobs", key, f"{stage}.ini")


def result_file(key: str, stage: str) -> Path:
    return Path("jobs", key, f"{stage}.json")


def read_json(path: Path) -> Any:
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        record = None
    if not isinstance(record, dict):
        fail(f"{path}: is damaged; move it away and run again, or give a new folder")
    return record


def as_json(value: Any) -> str:
    return json.dumps(value, indent=1, ensure_ascii=False) + "\n"


def hash_of(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def write_whole(path: Path, text: str) -> None:
    """Writes beside the place and renames; a file that has this text already keeps its time."""
    data = text.encode("utf-8", "surrogateescape")
    if path.is_file() and path.read_bytes() == data:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.name}.tmp-{os.getpid()}")
    try:
        beside.write_bytes(data)
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def number_of(text: str) -> float | None:
    """A number with a decimal point or, as a spreadsheet may have saved it, a comma."""
    if not re.fullmatch(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", text.strip()):
        return None
    return float(text.replace(",", "."))
