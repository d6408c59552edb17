# find_meshlab_library(<variable> <folder>): MeshLab's core library, in the folder itself or where
# the wheels of pymeshlab have it: lib on Linux, Frameworks on macOS, their top folder on Windows,
# where it is the import library of the DLL.
function(find_meshlab_library variable folder)
  find_library(${variable} meshlab-common
               PATHS "${folder}" PATH_SUFFIXES lib Frameworks NO_DEFAULT_PATH)
endfunction()
