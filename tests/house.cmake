# The folders of the house in the order of the data: a file includes its own folder and those above
# it in this list, never one below. PUBLIC names the headers that other folders include; all other
# headers of a folder are its own. tests/house_test.cmake holds the code to this list.

house_folder(importer/base PUBLIC
  atomic_output bounded_queue error file_lock files ids log natural_order numbers option parallel
  progress_callback replacement stage_timer statistics)
house_folder(importer/process PUBLIC
  child_process)
house_folder(importer/text PUBLIC
  csv id_ranges json_text markup nearest_name number_text output_date shown_text text_file)
house_folder(importer/lanes PUBLIC
  blurred_cells float_lanes normal_lanes)
house_folder(importer/geometry PUBLIC
  alignment consensus_pose directions disjoint_sets least_squares look_at opencv_pose pose_refinement pose_step principal_axes
  quad ransac rigid3 symmetric_eigen unit_square_map units)
house_folder(importer/camera PUBLIC
  calibration calibration_writer camera camera_jacobian camera_projection storage_reader
  turned_camera)
house_folder(importer/layout PUBLIC
  code_search dictionary frame_choice known_point layout layout_writer prior_shape)
house_folder(importer/print PUBLIC
  drawing drawing_writer marker_sheets placement png_file print_options sheet_plan)
house_folder(importer/packets PUBLIC
  packet_damage video_seek)
house_folder(importer/photo PUBLIC
  heif_picture picture_metadata)
house_folder(importer/video PUBLIC
  frame_source image_file jpeg_codec source_file video_options written_frame)
house_folder(importer/detect PUBLIC
  cell_means chessboard corner_colors detection detection_options duplicates gray_levels interpolate marker_alignment
  marker_location marker_quad marker_search search_regions)
house_folder(importer/rotation PUBLIC
  rotation_ambiguity rotation_evidence)
house_folder(importer/lighting PUBLIC
  light_map lighting)
house_folder(importer/bend PUBLIC
  bent_square pattern_bend)
house_folder(importer/pattern PUBLIC
  clipped_pixels fit_equations formation_estimate image_formation known_marker
  lighting_fit pattern_fit pattern_picture pattern_problem refined_corners)
house_folder(importer/refine PUBLIC
  marker_detector read_again)
house_folder(importer/track PUBLIC
  frame_detector marker_tracking)
house_folder(importer/formation PUBLIC
  formation_sampling)
house_folder(importer/database PUBLIC
  colmap_database correspondence database_writer part_table source_table tracking_table)
house_folder(importer PUBLIC
  database_merger dictionary_hint marker_importer)
house_folder(reconstruct/geometry PUBLIC
  camera_conversion covariance_update frame_shape intrinsics_prior marker_pose point_covariance)
house_folder(reconstruct/model PUBLIC
  adjustment_uncertainty calibration_evidence gauge model model_io moved_views reprojection turned_model
  weak_geometry)
house_folder(reconstruct/camera PUBLIC
  camera_steadiness focal_evidence lens_bend_correction)
house_folder(reconstruct/solve PUBLIC
  schur_complement)
house_folder(reconstruct/registration PUBLIC
  corner_motions dictionary_doubt frame_order registration registration_options
  repeated_frames)
house_folder(reconstruct/evidence PUBLIC
  layout_evidence marker_rows unnamed_markers)
house_folder(reconstruct/thesis PUBLIC
  frame_selection posed_images thesis_registration)
house_folder(reconstruct/map PUBLIC
  map_adjustment map_growth map_intersection map_problem map_start map_verdict)
house_folder(reconstruct/global PUBLIC
  global_registration)
house_folder(reconstruct/colmap PUBLIC
  bundle_adjustment bundle_adjustment_options colmap_runner observation_filter warm_start)
house_folder(reconstruct/problem PUBLIC
  corner_errors corner_residuals corner_whitening marker_adjustment_options marker_chords
  marker_problem marker_state marker_uncertainty normal_equations prior_cost_functions
  rolling_shutter scale_bar)
house_folder(reconstruct/correlation PUBLIC
  corner_correlation error_correlation)
house_folder(reconstruct/sizes PUBLIC
  bend_evidence bent_corners marker_curvature marker_sizes moving_markers runaway_markers
  scale_bar_verdict size_deviations student_factor)
house_folder(reconstruct/adjust PUBLIC
  camera_adjustment camera_cross_validation marker_adjustment)
house_folder(reconstruct/calibration PUBLIC
  board_flaws board_views residual_pattern)
house_folder(reconstruct PUBLIC
  camera_calibration camera_search register_frames seed_model)
house_folder(exporters/shape PUBLIC
  adjacent_distances common_corners joint_covariance known_distances marker_shape part_planes
  sail_lines shape_frame shape_metrics shape_sigma shape_transform)
house_folder(exporters/formats PUBLIC
  ascii cad_library cad_writer float_step length_unit mesh_triangles mesh_writer metrics_report
  ply_writer shape_csv shape_ply surface_grid surface_spline)
house_folder(exporters/exchange PUBLIC
  alicevision_scene metashape_markers)
house_folder(exporters/datum PUBLIC
  known_points known_points_report)
house_folder(exporters/design PUBLIC
  marker_distance mesh_distance mesh_reader)
house_folder(exporters/scale PUBLIC
  metric_scale metric_shape model_metrics round_number scale_audit scale_audit_report scale_csv)
house_folder(exporters/surface PUBLIC
  surface surface_attempt surface_csv surface_input)
house_folder(exporters/cloth PUBLIC
  cloth_places surface_sigma)
house_folder(exporters/curve PUBLIC
  section_spline space_curve)
house_folder(exporters/sail PUBLIC
  sail_metrics sail_shape section section_writer)
house_folder(exporters/freeform PUBLIC
  freeform_shape)
house_folder(exporters/compare PUBLIC
  comparison comparison_sigma section_comparison shape_deviation shape_likeness surface_comparison)
house_folder(exporters/report PUBLIC
  camera_key_numbers html_page report_assets report_data report_sail report_writer verdict)
house_folder(exporters/comparison_page PUBLIC
  comparison_page comparison_ply)
house_folder(exporters/calibration PUBLIC
  calibration_page calibration_verdict)
house_folder(exporters PUBLIC
  shape_exporter shape_report)
house_folder(workflows/run PUBLIC
  adjustment camera_checks central_frame_sweep logging pipeline progress report_input run_summary stage_times summary
  version versions workspace)
house_folder(workflows/proposal PUBLIC
  clip_map layout_correction layout_proposal print_faults rare_ids)
house_folder(workflows/check PUBLIC
  clip_check clip_frames clip_limits clip_verdict dictionary_search)
house_folder(workflows/plan PUBLIC
  plan_drawing plan_writer)
house_folder(workflows/calibrate PUBLIC
  board_calibration)
house_folder(workflows/options PUBLIC
  help_text option_effects option_parser path_check sail_options shared_options)
house_folder(workflows/commands PUBLIC
  commands program)
house_folder(workflows/install)
house_folder(workflows)
