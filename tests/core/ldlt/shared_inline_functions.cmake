# Fails when an object compiled for one instruction set defines a weak symbol (an inline function or
# a template instance, of which the linker keeps any one) outside of that set's own namespaces.
foreach(object IN LISTS OBJECTS)
  execute_process(COMMAND ${NM} --demangle --defined-only ${object}
    OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "[0-9a-f]+ [VvWwu] [^\n]+" weak "${symbols}")
  foreach(symbol IN LISTS weak)
    if(NOT symbol MATCHES "Eigen_${INSTRUCTIONS}|${INSTRUCTIONS}::|DW\\.ref\\.")
      message(SEND_ERROR "shared with code for other processors: ${symbol} (${object})")
    endif()
  endforeach()
endforeach()
