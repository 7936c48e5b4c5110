# Chooses the interpreter for the package for Python, and checks that it has what is needed before anything is built.

# emberfold_probe_python(<interpreter> <packages> <out path> <out lacks>): sets the interpreter's own path (behind the
# stand-ins of pyenv), empty where it does not run, and the list of what it lacks of the packages, of the headers and
# of the version that pyproject.toml asks for. The first package is imported, the others are looked for.
function(emberfold_probe_python interpreter packages out_path out_lacks)
  string(CONCAT probe
    "import importlib.util, os, sys, sysconfig\n"
    "names = sys.argv[1].split(',')\n"
    "lacks = [] if sys.version_info >= (3, 9) else ['Python 3.9']\n"
    "try:\n"
    "    __import__(names[0])\n"
    "except Exception:\n"
    "    lacks.append(names[0])\n"
    "lacks += [name for name in names[1:] if importlib.util.find_spec(name) is None]\n"
    "if not os.path.exists(os.path.join(sysconfig.get_paths()['include'], 'Python.h')):\n"
    "    lacks.append('Python.h')\n"
    "print(sys.executable + '\\n' + ';'.join(lacks))\n")
  string(REPLACE ";" "," names "${packages}")
  execute_process(COMMAND "${interpreter}" -c "${probe}" ${names}
    RESULT_VARIABLE failed OUTPUT_VARIABLE told ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  set(path "")
  set(lacks "")
  if(NOT failed AND told MATCHES "^([^\n]+)\n?([^\n]*)$")
    set(path "${CMAKE_MATCH_1}")
    set(lacks "${CMAKE_MATCH_2}")
  endif()
  set(${out_path} "${path}" PARENT_SCOPE)
  set(${out_lacks} "${lacks}" PARENT_SCOPE)
endfunction()

# emberfold_find_python(<packages> <out>): sets the first python3 of PATH that lacks nothing; empty where there is none.
function(emberfold_find_python packages out)
  string(REPLACE ":" ";" folders "$ENV{PATH}")
  set(${out} "" PARENT_SCOPE)
  foreach(folder IN LISTS folders)
    if(NOT EXISTS "${folder}/python3")
      continue()
    endif()
    emberfold_probe_python("${folder}/python3" "${packages}" path lacks)
    if(path AND NOT lacks)
      set(${out} "${path}" PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()

# emberfold_choose_python(<build packages> <test packages> <out>): sets the interpreter: Python3_EXECUTABLE where it is
# given, else the first of PATH that has both, else the first that has what building needs. Stops the configuration
# with the interpreter, what it lacks and what to do where building would fail; warns where only the tests would.
function(emberfold_choose_python build test out)
  set(chosen "${Python3_EXECUTABLE}")
  if(NOT chosen)
    emberfold_find_python("${build};${test}" chosen)
  endif()
  if(NOT chosen)
    emberfold_find_python("${build}" chosen)
  endif()
  if(NOT chosen)
    set(chosen python3)
  endif()
  emberfold_probe_python("${chosen}" "${build}" path lacks)
  if(NOT path)
    message(FATAL_ERROR "EMBERFOLD_PYTHON: the interpreter ${chosen} does not run; give one that has ${build} with "
      "-DPython3_EXECUTABLE=/path/to/python3")
  endif()
  if(lacks)
    emberfold_find_python("${build}" better)
    if(NOT better)
      set(better /path/to/python3)
    endif()
    list(JOIN lacks ", " lacks)
    message(FATAL_ERROR "EMBERFOLD_PYTHON: the interpreter ${path} lacks ${lacks}; install what is missing, or give "
      "another interpreter with -DPython3_EXECUTABLE=${better}")
  endif()
  emberfold_probe_python("${chosen}" "${build};${test}" path lacks)
  if(lacks)
    list(JOIN lacks ", " lacks)
    message(WARNING "EMBERFOLD_PYTHON: the interpreter ${path} lacks ${lacks}, which the test \"python: package\" needs; "
      "install what is missing, or give another interpreter with -DPython3_EXECUTABLE=/path/to/python3")
  endif()
  set(${out} "${path}" PARENT_SCOPE)
endfunction()
