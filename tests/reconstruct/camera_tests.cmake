# Cameras that are found from the pictures.
velamap_test(NAME reconstruct_camera_test LABEL unit
  SOURCES
    calibration/board_flaws_test.cc
    calibration/board_views_test.cc
    calibration/residual_pattern_test.cc
    camera_calibration_test.cc
    camera_search_test.cc
    adjust/camera_adjustment_test.cc
    adjust/camera_cross_validation_test.cc
    adjust/found_cameras_test.cc
    camera/camera_steadiness_test.cc
    camera/focal_evidence_test.cc
    camera/lens_bend_correction_test.cc
    model/turned_model_test.cc
    scene_model.cc
)
