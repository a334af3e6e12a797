# What the layout contradicts.
velamap_test(NAME reconstruct_evidence_test LABEL unit
  SOURCES
    evidence/layout_evidence_test.cc
    evidence/marker_rows_test.cc
    evidence/unnamed_markers_test.cc
    evidence/random_sail.cc
)

# The default registration: its parts, then the whole.
velamap_test(NAME reconstruct_global_test LABEL unit
  SOURCES
    global/false_detections_test.cc
    global/frame_cleanup_test.cc
    global/global_registration_test.cc
    map/map_adjustment_test.cc
    global/map_cleanup_test.cc
    map/map_growth_test.cc
    map/map_intersection_test.cc
    map/map_refinement_jacobian_test.cc
    map/map_refinement_test.cc
    map/map_resection_test.cc
    map/map_start_test.cc
    map/map_verdict_test.cc
    registration/camera_doubt_test.cc
    registration/dictionary_doubt_test.cc
    registration/corner_motions_test.cc
    registration/motion_field_test.cc
    registration/repeated_frames_test.cc
    registration/track_gaps_test.cc
    registration/track_smoothing_test.cc
    map/marker_rivals_test.cc
    map/scene_map.cc
  LIBRARIES Ceres::ceres
)
