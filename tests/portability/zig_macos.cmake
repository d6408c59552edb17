# What macos_arm64.cmake and macos_x86_64.cmake share.
set(CMAKE_SYSTEM_NAME Darwin)
string(REGEX REPLACE "-.*" "" CMAKE_SYSTEM_PROCESSOR ${zig_target})
set(CMAKE_C_COMPILER zig cc -target ${zig_target})
set(CMAKE_CXX_COMPILER zig c++ -target ${zig_target})
set(CMAKE_AR /usr/bin/llvm-ar)
set(CMAKE_RANLIB /usr/bin/llvm-ranlib)
set(CMAKE_INSTALL_NAME_TOOL /usr/lib/llvm-14/bin/llvm-install-name-tool)
# Zig keeps a header compiled in advance where CMake does not look for it.
set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
set(CMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE PRE_TEST)
