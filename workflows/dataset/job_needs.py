"""Memory and time of a clip's jobs, for Snakemake and a cluster; README.md has the measurements."""

import functools
import os
import re
from pathlib import Path

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


def needs_of(clip: Path, camera: Path | None) -> dict[str, int]:
    """mem_mb and runtime_min of the largest job of a clip, with room to spare."""
    width, height = image_size_px(camera)
    megapixels = width * height / 1e6
    megabytes = bytes_of(clip) / 1e6
    return {"mem_mb": round(600 + 100 * megapixels),
            "runtime_min": round(10 + 0.5 * megabytes)}
