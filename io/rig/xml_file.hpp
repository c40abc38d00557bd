#pragma once

#include <string>

#include "io/rig/yaml_module.hpp"

namespace motorcade {

/// The parts of an XML text as OpenCV writes it: a leaf of several words is a list, and so are elements named `_`.
/// The root element's own name counts for nothing.
YamlAnswer parsedXml(const std::string& text);

}  // namespace motorcade
