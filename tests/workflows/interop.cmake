# velamap's files in the hands of the installed COLMAP, and the samples from end to end.
velamap_test(NAME colmap_interop_test LABEL colmap
  SOURCES
    interop/colmap_gui_test.cc
    interop/colmap_pictures_test.cc
    interop/colmap_tools.cc
    interop/colmap_tracks_test.cc
    interop/colmap_truth_test.cc
    run_velamap.cc
  LIBRARIES SQLiteCpp sqlite3
)

velamap_test(NAME sample_test LABEL colmap
  SOURCES
    run_velamap.cc
    commands/sample_test.cc
)

foreach(test colmap_interop_test sample_test)
  target_compile_definitions(${test} PRIVATE
    VELAMAP_PROGRAM="$<TARGET_FILE:velamap>"
    VELAMAP_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_dependencies(${test} velamap)
endforeach()

# Pictures of COLMAP's window stay here for whoever wants to look.
target_compile_definitions(colmap_interop_test PRIVATE
  VELAMAP_GUI_SCRIPT="${CMAKE_CURRENT_SOURCE_DIR}/interop/gui_screenshot.sh"
  VELAMAP_PICTURE_DIR="${CMAKE_CURRENT_BINARY_DIR}/pictures")
