#include <motorcade/motorcade.h>

// Compiled as C11 with every warning an error: the header needs nothing before it, and structs are in C as in C++.
extern const size_t sizes_in_c[13];
const size_t sizes_in_c[13] = {sizeof(motorcade_lens),
                               sizeof(motorcade_rig),
                               sizeof(motorcade_camera),
                               sizeof(motorcade_image),
                               sizeof(motorcade_pair),
                               sizeof(motorcade_options),
                               sizeof(motorcade_push),
                               sizeof(motorcade_counts),
                               sizeof(motorcade_frame),
                               sizeof(motorcade_object),
                               sizeof(motorcade_mask),
                               sizeof(motorcade_code),
                               sizeof(bool)};
