# Makes a plugin look for Qt along its own run-time search path: -DPLUGIN=<file>. For macOS, where a
# plugin has the path of the Qt that it was linked to, and would load a second Qt into its host.
#
# OTOOL and INSTALL_NAME_TOOL may be set, to LLVM's for instance.
if(NOT OTOOL)
  set(OTOOL otool)
  set(INSTALL_NAME_TOOL install_name_tool)
endif()
execute_process(COMMAND ${OTOOL} -L ${PLUGIN}
  OUTPUT_VARIABLE libraries COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\t\n ]+/Qt[A-Za-z]+\\.framework/[^\t\n ]+" frameworks "${libraries}")
foreach(framework IN LISTS frameworks)
  string(REGEX REPLACE ".*/(Qt[A-Za-z]+\\.framework/)" "@rpath/\\1" relocated ${framework})
  execute_process(COMMAND ${INSTALL_NAME_TOOL} -change ${framework} ${relocated} ${PLUGIN}
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
