# Adds the report and its page, with the JavaScript libraries inside, to the exporters.
set(JAVASCRIPT_DIR /usr/share/javascript CACHE PATH
    "Folder of the files of the Debian packages libjs-three and libjs-chart.js")
set(REPORT_DIR ${CMAKE_CURRENT_SOURCE_DIR}/report/page)
set(REPORT_THREE ${JAVASCRIPT_DIR}/three/three.min.js
                 ${JAVASCRIPT_DIR}/three/examples/js/controls/OrbitControls.js)
set(REPORT_CHART ${JAVASCRIPT_DIR}/chart.js/chart.min.js)
set(REPORT_SCRIPT)
foreach(name elements colours tables charts labels picture scene view3d controls main)
  list(APPEND REPORT_SCRIPT ${REPORT_DIR}/${name}.js)
endforeach()
# The page of a comparison has parts of the report's script.
set(COMPARISON_SCRIPT)
foreach(name elements colours tables labels scene view3d controls profiles comparison)
  list(APPEND COMPARISON_SCRIPT ${REPORT_DIR}/${name}.js)
endforeach()
set(REPORT_FILES ${REPORT_DIR}/page.html ${REPORT_DIR}/comparison.html ${REPORT_DIR}/calibration.html
                 ${REPORT_DIR}/view.html ${REPORT_DIR}/style.css ${REPORT_DIR}/licences.txt
                 ${REPORT_SCRIPT} ${COMPARISON_SCRIPT} ${REPORT_THREE} ${REPORT_CHART})
foreach(file IN LISTS REPORT_THREE REPORT_CHART)
  if(NOT EXISTS ${file})
    message(FATAL_ERROR "${file} is missing: install libjs-three and libjs-chart.js "
                        "(workflows/setup.sh), or set JAVASCRIPT_DIR")
  endif()
endforeach()

string(REPLACE ";" "|" REPORT_SCRIPT "${REPORT_SCRIPT}")
string(REPLACE ";" "|" COMPARISON_SCRIPT "${COMPARISON_SCRIPT}")
string(REPLACE ";" "|" REPORT_THREE "${REPORT_THREE}")
set(REPORT_ASSETS ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cc)
add_custom_command(
  OUTPUT ${REPORT_ASSETS}
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${REPORT_ASSETS}
          -DkReportPage=${REPORT_DIR}/page.html -DkReportStyle=${REPORT_DIR}/style.css
          -DkCalibrationPage=${REPORT_DIR}/calibration.html
          -DkComparisonPage=${REPORT_DIR}/comparison.html -DkReportView=${REPORT_DIR}/view.html
          "-DkComparisonScript=${COMPARISON_SCRIPT}"
          "-DkReportScript=${REPORT_SCRIPT}" "-DkReportThree=${REPORT_THREE}"
          -DkReportChart=${REPORT_CHART} -DkReportLicences=${REPORT_DIR}/licences.txt
          -P ${CMAKE_CURRENT_SOURCE_DIR}/report/embed.cmake
  DEPENDS ${REPORT_FILES} ${CMAKE_CURRENT_SOURCE_DIR}/report/embed.cmake
  COMMENT "Building the report's page" VERBATIM)

target_sources(velamap_exporters PRIVATE
  report/camera_key_numbers.cc
  report/html_page.cc
  report/report_data.cc
  report/report_histogram.cc
  report/report_images.cc
  report/report_key_numbers.cc
  report/report_markers.cc
  report/report_picture.cc
  report/report_sail.cc
  report/report_writer.cc
  report/scale_key_numbers.cc
  report/verdict.cc
  ${REPORT_ASSETS}
)
target_link_libraries(velamap_exporters PRIVATE ${OpenCV_LIBS} Boost::headers)
target_include_directories(velamap_exporters PRIVATE ${OpenCV_INCLUDE_DIRS})
