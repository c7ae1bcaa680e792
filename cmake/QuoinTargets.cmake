# One helper a verb: quoin_module (a folder of libcore), quoin_stage (a stage executable), quoin_test (the tests of a module).

# The instruction set is fixed, not "native": the same binary gives the same bytes on every machine that runs it.
set(QUOIN_ARCH "auto" CACHE STRING "x86-64 level of the build (x86-64-v3, x86-64-v2, or auto: v3 if this machine has it)")
if(QUOIN_ARCH STREQUAL "auto")
    set(quoin_arch x86-64-v2)
    if(EXISTS /proc/cpuinfo)
        file(STRINGS /proc/cpuinfo quoin_cpu_flags REGEX "^flags" LIMIT_COUNT 1)
        if(quoin_cpu_flags MATCHES " avx2 " AND quoin_cpu_flags MATCHES " bmi2 " AND quoin_cpu_flags MATCHES " fma ")
            set(quoin_arch x86-64-v3)
        endif()
    endif()
else()
    set(quoin_arch ${QUOIN_ARCH})
endif()

# Most of a file's compile time goes to headers that its neighbours include too, so neighbours are compiled together. Their
# names share one scope then: what two files of a folder call the same needs two names. Off for tools that go by file.
option(QUOIN_UNITY "compile the files of a folder together, up to 12 at a time" ON)
set(CMAKE_UNITY_BUILD ${QUOIN_UNITY})

# Units of about one size, or what is left over after a full one would still parse all headers.
function(quoin_unity target)
    get_target_property(sources ${target} SOURCES)
    list(LENGTH sources count)
    math(EXPR units "(${count} + 11) / 12")
    math(EXPR size "(${count} + ${units} - 1) / ${units}")
    set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE ${size})
endfunction()

# For code that runs once a command, not once a face or a pixel: it compiles in two thirds of the time.
function(quoin_compile_fast target)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

add_library(quoin_options INTERFACE)
target_include_directories(quoin_options INTERFACE ${CMAKE_CURRENT_SOURCE_DIR}/libcore)
# No contraction into fused multiply-adds: it depends on the compiler's mood and breaks equal bytes.
# Eigen's alignment is pinned to what Debian's libraries were built with, or its allocator differs between us and Ceres.
target_compile_options(quoin_options INTERFACE
    -march=${quoin_arch} -ffp-contract=off $<$<CXX_COMPILER_ID:GNU>:SHELL:--param ggc-min-heapsize=1000000> -Wall -Wextra -Wpedantic -Wshadow -Wno-psabi -Wno-restrict -fdiagnostics-color=auto)
target_compile_definitions(quoin_options INTERFACE EIGEN_MAX_ALIGN_BYTES=16 EIGEN_DONT_PARALLELIZE)
target_link_libraries(quoin_options INTERFACE Eigen3::Eigen Threads::Threads)

# quoin_module(NAME [DEPENDS module...] [LINK third-party-target...]): every .cpp of this folder.
# Third-party types stop at the .cpp, so third-party targets are private.
function(quoin_module name)
    cmake_parse_arguments(arg "" "" "DEPENDS;LINK" ${ARGN})
    file(GLOB sources CONFIGURE_DEPENDS *.cpp)
    list(TRANSFORM arg_DEPENDS PREPEND quoin_)
    if(sources)
        add_library(quoin_${name} STATIC ${sources})
        quoin_unity(quoin_${name})
        target_link_libraries(quoin_${name} PUBLIC quoin_options ${arg_DEPENDS} PRIVATE ${arg_LINK})
    else()
        add_library(quoin_${name} INTERFACE)
        target_link_libraries(quoin_${name} INTERFACE quoin_options ${arg_DEPENDS})
    endif()
endfunction()

# quoin_stage(NAME [DEPENDS module...]): the executable NAME from main.cpp of this folder.
function(quoin_stage name)
    cmake_parse_arguments(arg "" "" "DEPENDS" ${ARGN})
    list(TRANSFORM arg_DEPENDS PREPEND quoin_)
    add_executable(stage_${name} main.cpp)
    set_target_properties(stage_${name} PROPERTIES OUTPUT_NAME ${name})
    target_link_libraries(stage_${name} PRIVATE quoin_stage quoin_schema ${arg_DEPENDS})
endfunction()

# What every test executable is built with; what it tests is compiled at its own level.
function(quoin_test_options target)
    target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR}/tests ${CMAKE_BINARY_DIR}/tests)
    target_link_libraries(${target} PRIVATE GTest::gmock GTest::gtest_main)
    quoin_compile_fast(${target})
endfunction()

# quoin_test(MODULE [DEPENDS module...] [LINK third-party-target...]): every *_test.cpp of this folder in one executable.
function(quoin_test name)
    cmake_parse_arguments(arg "" "" "DEPENDS;LINK" ${ARGN})
    file(GLOB sources CONFIGURE_DEPENDS *_test.cpp)
    list(TRANSFORM arg_DEPENDS PREPEND quoin_)
    add_executable(test_${name} ${sources})
    quoin_unity(test_${name})
    target_link_libraries(test_${name} PRIVATE quoin_${name} ${arg_DEPENDS} ${arg_LINK})
    quoin_test_options(test_${name})
    gtest_discover_tests(test_${name} TEST_PREFIX ${name}/ DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 120
        PROPERTIES TIMEOUT 600 SKIP_REGULAR_EXPRESSION "\\[  SKIPPED \\]")
endfunction()
