"""The columns of dataset.csv beside the tags, in their order; the sections' columns follow."""

# Keys of `velamap automatic_reconstructor --summary json`.
FIGURES = (
    "verdict", "num_images_used", "num_images", "num_markers", "num_layout_markers",
    "reconstruction_ratio", "sail_reconstruction_ratio",
    "area_error_mm2_mean", "area_error_mm2_std", "area_error_percent_mean",
    "area_error_percent_std", "side_error_mm_mean", "side_error_mm_std",
    "central_reprojection_error_px_mean", "central_reprojection_error_px_std",
    "reprojection_error_px_mean", "reprojection_error_px_std",
    "scale_m_per_unit", "scale_sigma_percent", "marker_scale_deviation_percent",
    "num_outliers_removed", "length_m", "width_m", "depth_m")
SECTION_FIGURES = ("camber_percent", "draft_percent", "twist_deg")
# Columns of the sweep's table whose statistics over the central frames are taken.
SWEEP_FIGURES = ("reconstruction_ratio", "area_error_mm2_mean", "area_error_mm2_max",
                 "central_reprojection_error_px_mean", "reprojection_error_px_mean")
STATISTICS = ("min", "max", "mean", "std")
SWEEP_COLUMNS = ("num_central_frames", "num_central_frames_with_result") + tuple(
    f"sweep_{figure}_{statistic}" for figure in SWEEP_FIGURES for statistic in STATISTICS)
STAGES = ("import", "reconstruct", "sweep")
TIMES = tuple(f"{stage}_wall_s" for stage in STAGES) + ("wall_s", "peak_memory_mb")

RESULT_COLUMNS = ("name", "clip", "duration_s", "exit_code", "error", *FIGURES, *SWEEP_COLUMNS,
                  *TIMES, "report", "sweep")
