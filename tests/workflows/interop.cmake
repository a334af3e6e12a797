# velamap's files in the hands of the installed COLMAP, and the samples from end to end.
velamap_test(NAME colmap_interop_test LABEL colmap
  SOURCES
    interop/colmap_gui_test.cc
    interop/colmap_pictures_test.cc
    interop/colmap_tools.cc
    interop/colmap_tracks_test.cc
    interop/colmap_truth_test.cc
    run_velamap.cc
    stylus_workspace.cc
  LIBRARIES SQLiteCpp sqlite3
  PROPERTIES ${needs_stylus}
)

velamap_test(NAME sample_test LABEL colmap
  SOURCES
    run_velamap.cc
    stylus_workspace.cc
    commands/sample_test.cc
  PROPERTIES ${needs_stylus}
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

# interop.colmap_lines runs the lines of COLMAP that workflows/colmap.md gives.
if(BASH_PROGRAM)
  add_test(NAME interop.colmap_lines
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/interop/colmap_lines_test.sh
                   ${PROJECT_SOURCE_DIR})
  set_tests_properties(interop.colmap_lines PROPERTIES
    LABELS colmap SKIP_RETURN_CODE 77 TIMEOUT 400 ${needs_stylus})
  set_property(TEST interop.colmap_lines APPEND PROPERTY ENVIRONMENT "VELAMAP=$<TARGET_FILE:velamap>")
endif()
