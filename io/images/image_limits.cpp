#include "io/images/image_limits.hpp"

namespace motorcade {

std::vector<Parameter> parametersOf(ImageLimits& limits) {
  return {numberParameter("max_pixels", limits.max_pixels, {256, kMaxImage_pixels},
                          "larger images are refused: fewer bound the memory that files from strangers may ask for"),
          numberParameter("max_file_mb", limits.max_file_mb, {1, kMaxImageFile_mb},
                          "larger files are refused before they are read")};
}

}  // namespace motorcade
