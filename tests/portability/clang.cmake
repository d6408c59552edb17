# Clang with its own standard library, libc++: that of macOS.
set(CMAKE_CXX_COMPILER clang++)
set(CMAKE_C_COMPILER clang)
set(CMAKE_CXX_FLAGS_INIT -stdlib=libc++)
