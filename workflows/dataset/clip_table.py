"""Reads the table of clips and checks it before any work."""

import csv
import io
import os
import re
import shlex
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from records import MAX_BYTES, fail, key_of, read_start
from result_columns import RESULT_COLUMNS

COLUMNS = ("name", "clip", "camera", "layout", "options", "central_frames", "parts")
REQUIRED = ("name", "clip")
# What the workflow gives itself.
OWN_OPTIONS = {"image_path", "camera_path", "layout_path", "workspace_path", "database_path",
               "frame_output_path", "output_path", "models_path", "log_path", "central_frames",
               "database_paths", "video_part", "import_anew", "num_threads", "summary", "help",
               "help_all"}
# Those of them that a project file may give where the cell is empty.
OPTIONS_OF_CELLS = {"camera_path", "layout_path"}
MAX_NAME_BYTES = 200
MAX_NUM_PARTS = 100  # as velamap has it


class RowError(Exception):
    """What is wrong with a row, with the remedy; the reader adds file and line."""


@dataclass
class Clip:
    """A row of the table, or one of the clips of a row that names several."""
    name: str
    path: Path
    camera: Path | None = None
    layout: Path | None = None
    options: list[tuple[str, str]] = field(default_factory=list)
    project: list[tuple[str, str]] = field(default_factory=list)  # of the file of --project_path
    central_frames: str = ""  # as written; empty: no sweep
    num_parts: int = 1  # into how many jobs the import is split
    tags: dict[str, str] = field(default_factory=dict)

    def stages(self) -> list[str]:
        return ["import", "reconstruct"] + (["sweep"] if self.central_frames else [])

    def part_stages(self) -> list[str]:
        """The jobs that a split import begins with; `import` then merges what they have made."""
        numbers = range(1, self.num_parts + 1) if self.num_parts > 1 else []
        return [f"part_{number}" for number in numbers]


def read_records(path: Path) -> list[tuple[int, list[str]]]:
    """The records with their line numbers. The file may be UTF-8 or UTF-16, with , ; or tabs."""
    if os.path.exists(path) and not os.path.isfile(path):
        fail(f"{path}: is a folder, a pipe or a device; give a table of clips (CSV)")
    try:
        data = read_start(path)
        encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
        text = data.decode(encoding)
    except OSError as error:
        fail(f"{path}: {error.strerror}; give a table of clips (CSV)")
    except UnicodeDecodeError:
        fail(f"{path}: is not UTF-8; save it as \"CSV UTF-8\"")
    if len(data) > MAX_BYTES:
        fail(f"{path}: has more than {MAX_BYTES} bytes; is it a table of clips?")
    header = next((line for line in text.splitlines() if line.strip()), "")
    delimiter = max(",;\t", key=header.count)
    records = []
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    line = 1
    try:
        for record in reader:
            if any(cell.strip() for cell in record):
                records.append((line, [cell.strip() for cell in record]))
            line = reader.line_num + 1
    except csv.Error as error:
        fail(f"{path}, line {line}: {error}; close the quotes, and double those within")
    return records


def read_header(path: Path, record: list[str]) -> list[str]:
    while record and not record[-1]:
        record.pop()
    header = ["_".join(cell.lower().split()) if "_".join(cell.lower().split()) in COLUMNS else cell
              for cell in record]
    for name in REQUIRED:
        if name not in header:
            fail(f"{path}, line 1: has no column {name}; the columns are {', '.join(COLUMNS)}, "
                 "and any others are tags")
    for index, name in enumerate(header):
        if not name or name in header[:index]:
            fail(f"{path}, line 1: column {index + 1} " +
                 (f"is a second {name}" if name else "has no name") + "; rename it")
        if name in RESULT_COLUMNS and name not in COLUMNS:
            fail(f"{path}, line 1: {name} is a column of the result; rename the tag")
    return header


def check_name(name: str) -> None:
    if not name:
        raise RowError("the name is empty; give each row a name")
    if name.startswith(".") or "/" in name or not name.isprintable():
        raise RowError(f"name {name!r}: becomes a folder, so it must not begin with . or "
                       "hold / or a control character; rename it")
    if len(key_of(name)) > MAX_NAME_BYTES:
        raise RowError(f"name {name[:20]}...: is too long for a folder; shorten it")


def find_clips(cell: str, folder: Path) -> list[Path]:
    """One clip whose name may hold anything, or several with ; or spaces between them."""
    if not cell:
        raise RowError("clip: is empty; give a video or a folder of photographs")
    if os.path.exists(folder / cell):
        return [folder / cell]
    try:
        names = ([part.strip() for part in cell.split(";")] if ";" in cell else shlex.split(cell))
    except ValueError:
        names = [cell]
    if any(len(name) > 0 and os.path.exists(folder / name) for name in names):
        for name in names:
            if not name or not os.path.exists(folder / name):
                raise RowError(f"clip {name or 'without a name'}: there is no such file or folder; "
                               "paths count from the table's folder")
        return [folder / name for name in names]
    raise RowError(f"clip {cell}: there is no such file or folder; paths count from the table's "
                   "folder")


def find_file(column: str, cell: str, folder: Path) -> Path | None:
    if not cell:
        return None
    if not os.path.isfile(folder / cell):
        raise RowError(f"{column} {cell}: there is no such file; paths count from the table's "
                       "folder")
    return folder / cell


def read_options(cell: str, folder: Path,
                 is_option: Callable[[str], bool]) -> list[tuple[str, str]]:
    try:
        words = shlex.split(cell)
    except ValueError:
        raise RowError(f"options {cell}: a quote is not closed; close it") from None
    options = []
    while words:
        word = words.pop(0)
        name, equals, value = word[2:].partition("=")
        if not word.startswith("--") or not name:
            raise RowError(f"options: {word} is not an option; write --name value")
        if name in OWN_OPTIONS:
            raise RowError(f"options: the workflow gives --{name} itself; leave it out")
        if not is_option(name):
            raise RowError(f"options: velamap has no --{name} for a reconstruction; see velamap "
                           "automatic_reconstructor --help_all")
        if not equals:
            if not words or words[0].startswith("--"):
                raise RowError(f"options: --{name} has no value; write --{name} value")
            value = words.pop(0)
        if (name.endswith("_path") or name == "dictionary") and os.path.exists(folder / value):
            value = str(folder / value)
        options.append((name, value))
    return options


def is_relative_path(name: str, value: str) -> bool:
    if name in ("dictionary", "colmap_path"):  # which may be a name
        return "/" in value and not os.path.isabs(value)
    return name.endswith("_path") and value != "" and not os.path.isabs(value)


def read_project(path: str, is_option: Callable[[str], bool]) -> list[tuple[str, str]]:
    """The options of the jobs in a project file, as velamap reads it."""
    try:
        lines = read_start(Path(path)).decode("utf-8", "replace").splitlines()
    except OSError as error:
        raise RowError(f"options: project_path {path}: {error.strerror}; give a file") from None
    options, section = [], ""
    for line in lines:
        line = line.partition("#")[0].strip()
        name, equals, value = line.partition("=")
        if line.startswith("[") and line.endswith("]"):
            section = line[1:-1].rstrip(".") + "."
        elif equals:
            options.append((section + name.strip(), value.strip()))
    options = [(name, value) for name, value in options
               if is_option(name) and name not in OWN_OPTIONS - OPTIONS_OF_CELLS]
    for name, value in options:
        if is_relative_path(name, value):
            raise RowError(f"options: project_path {path}: {name} {value} would count from the "
                           "folder of the results; write the whole path")
    return options


def read_central_frames(cell: str) -> str:
    """`all`, `every:N`, `FIRST:LAST:STEP` (LAST belongs to it), or frames with ; between them."""
    text = cell.replace(" ", "")
    number = r"\d{1,9}"
    if not text or text == "all" or re.fullmatch(r"every:0*[1-9]\d{0,8}", text):
        return text
    frames = re.fullmatch(rf"({number}):({number})(?::({number}))?", text)
    if frames:
        first, last, step = (int(part or 1) for part in frames.groups())
        if first <= last and step > 0:
            return f"{first}:{last}:{step}"
    frames_list = [part for part in re.split("[;,]", cell) if part.strip()]
    # Photographs are named; a number, or a name with its extension.
    if frames_list and all(re.fullmatch(rf"{number}|[^:]+\.\w+", part.strip())
                           for part in frames_list):
        return ",".join(part.strip() for part in frames_list)
    raise RowError(f"central_frames {cell}: is none of all, every:10, 0:100:10 (first:last:step), "
                   "or 12;40 (frames, or names of photographs)")


def read_num_parts(cell: str, path: Path) -> int:
    if not cell:
        return 1
    if path.is_dir():
        raise RowError("parts: photographs have no parts; leave it empty")
    if not re.fullmatch(r"[0-9]{1,3}", cell) or not 1 <= int(cell) <= MAX_NUM_PARTS:
        raise RowError(f"parts {cell}: is not a number of parts from 1 to {MAX_NUM_PARTS}")
    return int(cell)


def read_row(row: dict[str, str], folder: Path, is_option: Callable[[str], bool]) -> list[Clip]:
    check_name(row["name"])
    paths = find_clips(row["clip"], folder)
    clips = []
    for path in paths:
        clip = Clip(row["name"] if len(paths) == 1 else f"{row['name']} {path.stem}", path)
        check_name(clip.name)
        clip.camera = find_file("camera", row.get("camera", ""), folder)
        clip.layout = find_file("layout", row.get("layout", ""), folder)
        clip.options = read_options(row.get("options", ""), folder, is_option)
        for name, value in clip.options:
            clip.project += read_project(value, is_option) if name == "project_path" else []
        clip.central_frames = read_central_frames(row.get("central_frames", ""))
        clip.num_parts = read_num_parts(row.get("parts", ""), path)
        clip.tags = {name: value for name, value in row.items() if name not in COLUMNS}
        clips.append(clip)
    names = {name for name, _ in clips[0].options + clips[0].project}
    if not clips[0].layout and not names & {"marker_length", "layout_path"}:
        raise RowError("layout: is empty; give a layout file, or --marker_length in options")
    if clips[0].central_frames and not clips[0].camera and "camera_path" not in names:
        raise RowError("camera: is empty, and a sweep over central frames needs a calibration; give "
                       "one, such as the camera.yml that a run without central_frames finds")
    return clips


def read_table(path: Path, is_option: Callable[[str], bool]) -> tuple[list[str], list[Clip]]:
    """The tags' names and the clips. Ends with a line for each bad row. `is_option` says whether a
    command of the jobs has an option of this name."""
    records = read_records(path)
    if not records:
        fail(f"{path}: is empty; give a table with the columns {', '.join(COLUMNS)}")
    header = read_header(path, records[0][1])
    if len(records) == 1:
        fail(f"{path}: has no row below its header; give one for each clip")
    folder = Path(os.path.abspath(path)).parent
    clips: list[Clip] = []
    lines: dict[str, int] = {}
    errors = []
    for line, cells in records[1:]:
        while len(cells) > len(header) and not cells[-1]:
            cells.pop()
        try:
            if len(cells) != len(header):
                raise RowError(f"has {len(cells)} cells instead of {len(header)}; quote a cell "
                               "that holds the separator")
            for clip in read_row(dict(zip(header, cells)), folder, is_option):
                if clip.name in lines:
                    raise RowError(f"has the name {clip.name} of line {lines[clip.name]}; rename "
                                   "one")
                lines[clip.name] = line
                clips.append(clip)
        except RowError as error:
            errors.append(f"{path}, line {line}: {error}")
    if errors:
        fail(*errors)
    return [name for name in header if name not in COLUMNS], clips
