# Writes text files as string literals to a C++ source.
#   cmake -DOUTPUT=assets.cc -DkReportPage=page.html -DkReportScript="a.js|b.js" ... -P embed.cmake
# Joins the files of one variable in order.

set(ASSETS kReportPage kCalibrationPage kComparisonPage kReportView kReportStyle kReportScript
    kComparisonScript kReportThree kReportChart kReportLicences)

file(WRITE ${OUTPUT}.tmp "#include \"exporters/report/report_assets.h\"\n\nnamespace velamap {\n")
foreach(asset IN LISTS ASSETS)
  file(APPEND ${OUTPUT}.tmp "\nconst std::string_view ${asset} =")
  string(REPLACE "|" ";" files "${${asset}}")
  foreach(file IN LISTS files)
    file(READ "${file}" text)
    string(FIND "${text}" ")velamap\"" delimiter)
    if("${text}" STREQUAL "" OR NOT delimiter EQUAL -1)
      message(FATAL_ERROR "${file}: empty, or contains the delimiter of the string literals")
    endif()
    # The text would end the script element of the page.
    string(FIND "${text}" "</script" end_of_script)
    if("${file}" MATCHES "\\.js$" AND NOT end_of_script EQUAL -1)
      message(FATAL_ERROR "${file}: contains </script and cannot be part of a page")
    endif()
    file(APPEND ${OUTPUT}.tmp "\n    R\"velamap(${text}\n)velamap\"")
  endforeach()
  file(APPEND ${OUTPUT}.tmp ";\n")
endforeach()
file(APPEND ${OUTPUT}.tmp "\n}  // namespace velamap\n")
file(RENAME ${OUTPUT}.tmp ${OUTPUT})
