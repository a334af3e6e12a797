"""Memory and time of a clip's jobs, for Snakemake and a cluster; README.md has the measurements."""

import functools
import math
import os
import re
import subprocess
from pathlib import Path

from records import DURATIONS, as_json, fail, read_json, write_whole

DEFAULT_SIZE_PX = (3840, 2160)  # where no camera file says it


@functools.lru_cache(maxsize=None)
def image_size_px(camera: Path | None) -> tuple[int, int]:
    """The image size that the camera file names (OpenCV or COLMAP), without a parser of either."""
    text = camera.read_text(encoding="utf-8", errors="replace") if camera else ""
    sides = [re.search(rf"image_{side}\W+(\d+)", text) for side in ("width", "height")]
    if sides[0] and sides[1]:
        return int(sides[0][1]), int(sides[1][1])
    colmap = re.search(r"^\d+ [A-Z_]+ (\d+) (\d+) ", text, re.M)
    return (int(colmap[1]), int(colmap[2])) if colmap else DEFAULT_SIZE_PX


def bytes_of(clip: Path) -> int:
    if clip.is_file():
        return clip.stat().st_size
    return sum(os.path.getsize(os.path.join(folder, name))
               for folder, _, names in os.walk(clip) for name in names)


def needs_of(clip: Path, camera: Path | None, num_parts: int) -> dict[str, int]:
    """mem_mb and runtime_min of the largest job of a clip, and the time of a part of its import,
    with room to spare."""
    width, height = image_size_px(camera)
    megapixels = width * height / 1e6
    megabytes = bytes_of(clip) / 1e6
    return {"mem_mb": round(600 + 100 * megapixels),
            "runtime_min": round(10 + 0.5 * megabytes),
            "part_runtime_min": round(10 + 0.5 * megabytes / num_parts)}


def ask_duration_s(clip: Path) -> float:
    """As the container states it, without decoding."""
    try:
        stated = subprocess.run(
            ["ffprobe", "-v", "error", "-show_entries", "format=duration", "-of", "csv=p=0",
             f"file:{clip}"], capture_output=True, text=True).stdout.strip()
    except OSError:
        fail("ffprobe, which says how long a clip is, is not installed; run: apt-get install "
             "ffmpeg, or give the number of parts")
    if not re.fullmatch(r"\d+(\.\d+)?", stated):
        fail(f"{clip}: states no duration; give the number of parts")
    return float(stated)


def num_parts_of(clip: Path, parts: int | float, output: Path) -> int:
    """Into how many jobs the import of a clip is split. Durations are asked for once."""
    if isinstance(parts, int):
        return parts
    durations = read_json(output / DURATIONS) if (output / DURATIONS).exists() else {}
    state = [clip.stat().st_size, clip.stat().st_mtime_ns]
    known = durations.get(str(clip))
    if not known or known[:2] != state:
        known = durations[str(clip)] = [*state, ask_duration_s(clip)]
        write_whole(output / DURATIONS, as_json(durations))
    return max(1, math.ceil(known[2] / parts))
