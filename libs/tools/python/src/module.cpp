// SPDX-License-Identifier: BSD-3-Clause
// The Python module.
#include <headway/core/error.h>
#include <headway/core/version.h>

#include "arrays.h"

PYBIND11_MODULE(_headway, module) {
  using namespace headway;
  namespace py = pybind11;
  module.attr("__version__") = kVersion;
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).doc() =
      "Unusable input: a file, a parameter or an argument. Its text names cause and remedy.";
  // A signature names the classes that are bound before it.
  python::bindTracks(module);
  python::bindFrames(module);
  python::bindRecordings(module);
  python::bindMap(module);
  python::bindPerception(module);
  python::bindResults(module);
  python::bindEvaluation(module);
}
