"""Memory and time of a clip's jobs, for Snakemake and a cluster; README.md has the measurements."""

import functools
import re
from pathlib import Path

from records import files_below, read_start

DEFAULT_SIZE_PX = (3840, 2160)  # where no camera file says it


@functools.lru_cache(maxsize=None)
def image_size_px(camera: Path | None) -> tuple[int, int]:
    """The image size that the camera file names (OpenCV or COLMAP), without a parser of either."""
    text = read_start(camera).decode("utf-8", "replace") if camera else ""
    sides = [re.search(rf"image_{side}\W+(\d{{1,9}})", text) for side in ("width", "height")]
    if sides[0] and sides[1]:
        return int(sides[0][1]), int(sides[1][1])
    colmap = re.search(r"^\d+ [A-Z_]+ (\d{1,9}) (\d{1,9}) ", text, re.M)
    return (int(colmap[1]), int(colmap[2])) if colmap else DEFAULT_SIZE_PX


def needs_of(clip: Path, camera: Path | None, num_parts: int) -> dict[str, int]:
    """mem_mb and runtime_min of the largest job of a clip, and the time of a part of its import,
    with room to spare."""
    width, height = image_size_px(camera)
    megapixels = width * height / 1e6
    megabytes = sum(file.stat().st_size for file in files_below(clip)) / 1e6
    return {"mem_mb": round(600 + 100 * megapixels),
            "runtime_min": round(10 + 0.5 * megabytes),
            "part_runtime_min": round(10 + 0.5 * megabytes / num_parts)}
