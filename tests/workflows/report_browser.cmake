# The report in headless Chromium; skipped where there is none.
velamap_test(NAME report_browser_test LABEL browser SHARDS 1
  SOURCES
    ../exporters/report/report_example.cc
    interop/report_browser_test.cc
    run_velamap.cc
  LIBRARIES ${OpenCV_LIBS}
)
# Pictures of the page stay here for whoever wants to look.
target_compile_definitions(report_browser_test PRIVATE
  VELAMAP_PROGRAM="$<TARGET_FILE:velamap>"
  VELAMAP_INTEROP_DIR="${CMAKE_CURRENT_SOURCE_DIR}/interop"
  VELAMAP_PICTURE_DIR="${CMAKE_CURRENT_BINARY_DIR}/pictures")
