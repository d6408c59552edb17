# macOS on ARM, by Zig's Clang, headers and linker: nothing here runs what is built.
set(zig_target aarch64-macos.11.0)
include(${CMAKE_CURRENT_LIST_DIR}/zig_macos.cmake)
