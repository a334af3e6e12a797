# install.tree installs into a temporary folder and looks at what is there. The package in a fresh Debian
# is tried by workflows/package.sh --try, which needs the network.
if(BASH_PROGRAM)
  add_test(NAME install.tree
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/install/install_test.sh
                   ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR})
  set_tests_properties(install.tree PROPERTIES LABELS cli TIMEOUT 120)
endif()
