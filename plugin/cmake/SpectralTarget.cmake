# What depends on the compiler or the system; nothing else in the project does.
#
#   spectral_target(<target>)         what all of the project's own targets share
#   spectral_plugin_target(<target>)  the same for a plugin of MeshLab
#   spectral_compile_quickly(<target>)  for code that takes longer to compile than to run
#   SPECTRAL_AVX2_OPTIONS             compiles for AVX2 and FMA; empty where that cannot be
#   SPECTRAL_SYSTEM                   linux, macos, windows or web: the ending of system-specific sources
include(CheckCXXCompilerFlag)

option(SPECTRAL_AVX2 "Compile the kernels for AVX2, too, where the compiler can" ON)

if(WIN32)
  set(SPECTRAL_SYSTEM windows)
elseif(APPLE)
  set(SPECTRAL_SYSTEM macos)
elseif(EMSCRIPTEN)
  set(SPECTRAL_SYSTEM web)
else()
  set(SPECTRAL_SYSTEM linux)
endif()

if(EMSCRIPTEN)
  # Instructions and exceptions of WebAssembly itself, not those of JavaScript.
  add_compile_options(-msimd128 -fwasm-exceptions)
  add_link_options(-fwasm-exceptions)
endif()

set(SPECTRAL_AVX2_OPTIONS)
if(SPECTRAL_AVX2 AND NOT EMSCRIPTEN)
  if(MSVC)
    set(options /arch:AVX2)
  else()
    set(options -mavx2 -mfma)
    if(MINGW AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # On Windows, GCC moves data aligned on a stack that it does not align (its bug 54412).
      list(APPEND options -Wa,-muse-unaligned-vector-move)
    endif()
  endif()
  string(REPLACE ";" " " flags "${options}")
  check_cxx_compiler_flag("${flags}" SPECTRAL_HAS_AVX2)
  if(SPECTRAL_HAS_AVX2)
    set(SPECTRAL_AVX2_OPTIONS ${options})
  endif()
endif()

if(SPECTRAL_SANITIZE)
  if(MSVC)
    message(FATAL_ERROR "SPECTRAL_SANITIZE needs GCC or Clang")
  endif()
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all
                      -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=address,undefined)
endif()

# Symbols are hidden: the plugin and MeshLab both contain template instances of Eigen, built with
# different flags, and the dynamic linker would otherwise merge them.
function(spectral_target target)
  target_compile_features(${target} PUBLIC cxx_std_17)
  set_target_properties(${target} PROPERTIES
    CXX_EXTENSIONS OFF
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON
    POSITION_INDEPENDENT_CODE ON)
  if(MSVC)
    # Eigen's templates exceed the sections of a usual object; windows.h has macros min and max.
    target_compile_options(${target} PRIVATE /W4 /permissive- /utf-8 /bigobj
      $<$<BOOL:${SPECTRAL_WARNINGS_AS_ERRORS}>:/WX>)
    target_compile_definitions(${target} PRIVATE NOMINMAX)
  else()
    target_compile_options(${target} PRIVATE
      -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
      $<$<BOOL:${SPECTRAL_WARNINGS_AS_ERRORS}>:-Werror>)
  endif()
endfunction()

function(spectral_compile_quickly target)
  if(NOT MSVC)
    target_compile_options(${target} PRIVATE -O1)
  endif()
endfunction()

function(spectral_plugin_target target)
  spectral_target(${target})
  if(MSVC)
    # VCG uses M_PI.
    target_compile_definitions(${target} PRIVATE _USE_MATH_DEFINES)
  elseif(APPLE)
    # Functions hidden, types not: macOS compares types by address, and MeshLab catches what a
    # plugin throws.
    target_compile_options(${target} PRIVATE -fvisibility-ms-compat)
    # What MeshLab::float does not link is found in the host.
    target_link_options(${target} PRIVATE -undefined dynamic_lookup)
    # The host's own Qt and core library, by the paths by which it has loaded them: those next to this
    # package in Python, those of the application in MeshLab.
    set_target_properties(${target} PROPERTIES
      BUILD_WITH_INSTALL_RPATH ON
      INSTALL_RPATH "@loader_path/../../pymeshlab/Frameworks;@executable_path/../Frameworks")
    add_custom_command(TARGET ${target} POST_BUILD
      COMMAND ${CMAKE_COMMAND} -DPLUGIN=$<TARGET_FILE:${target}>
              -P ${PROJECT_SOURCE_DIR}/plugin/cmake/relocate_qt.cmake)
  else()
    # Link only the libraries that are used, to require no others of the host; functions of static ones
    # are not those of the host.
    target_link_options(${target} PRIVATE LINKER:--as-needed LINKER:--exclude-libs,libmuparser.a)
    # Resolved by the host at run time: MeshLab loads its core library and Qt before any plugin, and
    # their names depend on the MeshLab package.
    set_target_properties(${target} PROPERTIES SKIP_BUILD_RPATH ON)
  endif()
endfunction()
